#pragma once
#include <array>
#include <vector>

#include <HYPRE_struct_ls.h>
#include <mpi.h>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::test {

/// Message passing while it lives, which hypre asks for even on one process.
struct MpiSession {
  MpiSession() { MPI_Init(nullptr, nullptr); }
  ~MpiSession() { MPI_Finalize(); }
  MpiSession(const MpiSession&) = delete;
  MpiSession& operator=(const MpiSession&) = delete;
};

/// Gradient vector flow at rest by hypre: conjugate gradients with its multigrid (PFMG) as preconditioner, in double
/// precision. Equations as in `SteadyGvf`, written down here once more.
class HypreGvf {
 public:
  /// `rate`: diffusion along each axis, mu / spacing^2. `tolerance` is that of hypre: the relative residual.
  HypreGvf(const Image& map, const Vec3& rate, double tolerance) : grid_(map.grid), b_(grid_.size()) {
    for (auto& g : gradient_) g.resize(grid_.size());
    std::vector<double> stencil(7 * grid_.size());
    for (int k = 0; k < grid_.dims[2]; ++k)
      for (int j = 0; j < grid_.dims[1]; ++j)
        for (int i = 0; i < grid_.dims[0]; ++i) set_up_voxel(map, rate, {i, j, k}, stencil);
    make_system(stencil);
    HYPRE_StructPFMGCreate(MPI_COMM_WORLD, &multigrid_);
    HYPRE_StructPFMGSetMaxIter(multigrid_, 1);
    HYPRE_StructPFMGSetTol(multigrid_, 0);
    HYPRE_StructPFMGSetZeroGuess(multigrid_);
    HYPRE_StructPFMGSetRelaxType(multigrid_, 2);  // red-black, symmetric
    HYPRE_StructPCGCreate(MPI_COMM_WORLD, &solver_);
    HYPRE_StructPCGSetTol(solver_, tolerance);
    HYPRE_StructPCGSetTwoNorm(solver_, 1);
    HYPRE_StructPCGSetMaxIter(solver_, 200);
    HYPRE_StructPCGSetPrecond(solver_, HYPRE_StructPFMGSolve, HYPRE_StructPFMGSetup, multigrid_);
    HYPRE_StructPCGSetup(solver_, matrix_, rhs_, u_);
  }
  ~HypreGvf() {
    HYPRE_StructPCGDestroy(solver_);
    HYPRE_StructPFMGDestroy(multigrid_);
    HYPRE_StructVectorDestroy(u_);
    HYPRE_StructVectorDestroy(rhs_);
    HYPRE_StructMatrixDestroy(matrix_);
    HYPRE_StructStencilDestroy(stencil_);
    HYPRE_StructGridDestroy(struct_grid_);
  }
  HypreGvf(const HypreGvf&) = delete;
  HypreGvf& operator=(const HypreGvf&) = delete;

  /// One component, in the order of voxels.
  std::vector<double> component(std::size_t axis) {
    std::vector<double> values(grid_.size());
    set(u_, values);
    for (std::size_t v = 0; v < values.size(); ++v) values[v] = b_[v] * gradient_[axis][v];
    set(rhs_, values);
    HYPRE_StructPCGSolve(solver_, matrix_, rhs_, u_);
    HYPRE_StructPCGGetNumIterations(solver_, &iterations);
    HYPRE_StructVectorGetBoxValues(u_, first_.data(), last_.data(), values.data());
    return values;
  }

  HYPRE_Int iterations = 0;  // of the last component

 private:
  void set_up_voxel(const Image& map, const Vec3& rate, const Index3& voxel, std::vector<double>& stencil) {
    const std::size_t at = grid_.index(voxel[0], voxel[1], voxel[2]);
    double* row = stencil.data() + 7 * at;
    for (std::size_t a = 0; a < 3; ++a) {
      Index3 low = voxel, high = voxel;
      if (voxel[a] > 0) --low[a];
      if (voxel[a] + 1 < grid_.dims[a]) ++high[a];
      const int axis = static_cast<int>(a);
      row[1 + 2 * a] = low == voxel ? 0 : -rate[axis];
      row[2 + 2 * a] = high == voxel ? 0 : -rate[axis];
      row[0] -= row[1 + 2 * a] + row[2 + 2 * a];
      if (high == low) continue;
      const double slope = (double(map(high[0], high[1], high[2])) - double(map(low[0], low[1], low[2]))) /
                           ((high[a] - low[a]) * grid_.spacing[axis]);
      gradient_[a][at] = slope;
      b_[at] += slope * slope;
    }
    row[0] += b_[at];
  }

  void make_system(std::vector<double>& stencil) {
    for (std::size_t a = 0; a < 3; ++a) last_[a] = grid_.dims[a] - 1;
    HYPRE_StructGridCreate(MPI_COMM_WORLD, 3, &struct_grid_);
    HYPRE_StructGridSetExtents(struct_grid_, first_.data(), last_.data());
    HYPRE_StructGridAssemble(struct_grid_);
    HYPRE_StructStencilCreate(3, 7, &stencil_);
    std::array<HYPRE_Int, 7> entries{0, 1, 2, 3, 4, 5, 6};
    for (int e = 0; e < 7; ++e) {
      std::array<HYPRE_Int, 3> offset{};
      if (e > 0) offset[static_cast<std::size_t>((e - 1) / 2)] = e % 2 == 1 ? -1 : 1;
      HYPRE_StructStencilSetElement(stencil_, e, offset.data());
    }
    HYPRE_StructMatrixCreate(MPI_COMM_WORLD, struct_grid_, stencil_, &matrix_);
    HYPRE_StructMatrixInitialize(matrix_);
    HYPRE_StructMatrixSetBoxValues(matrix_, first_.data(), last_.data(), 7, entries.data(), stencil.data());
    HYPRE_StructMatrixAssemble(matrix_);
    for (HYPRE_StructVector* v : {&rhs_, &u_}) {
      HYPRE_StructVectorCreate(MPI_COMM_WORLD, struct_grid_, v);
      HYPRE_StructVectorInitialize(*v);
      std::vector<double> zero(grid_.size());
      set(*v, zero);
    }
  }

  void set(HYPRE_StructVector v, std::vector<double>& values) {
    HYPRE_StructVectorSetBoxValues(v, first_.data(), last_.data(), values.data());
    HYPRE_StructVectorAssemble(v);
  }

  Grid grid_;
  std::vector<double> b_;
  std::array<std::vector<double>, 3> gradient_;
  std::array<HYPRE_Int, 3> first_{}, last_{};
  HYPRE_StructGrid struct_grid_ = nullptr;
  HYPRE_StructStencil stencil_ = nullptr;
  HYPRE_StructMatrix matrix_ = nullptr;
  HYPRE_StructVector rhs_ = nullptr, u_ = nullptr;
  HYPRE_StructSolver solver_ = nullptr, multigrid_ = nullptr;
};

}  // namespace dynasurf::test
