#pragma once
#include <array>
#include <span>
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf::psf_fit {

/// A box of voxels of a study, several of them joined to one where they are finer than the blur needs. Grid frame, mm.
struct Pixels {
  Index3 first{0, 0, 0};   // voxel of the study at the corner
  Index3 joined{1, 1, 1};  // voxels of the study that make one
  Index3 count{0, 0, 0};
  Vec3 spacing{1, 1, 1};  // of the study's voxels, mm

  std::size_t size() const { return size_of(count); }
  double centre(int axis, int n) const {
    return spacing[axis] * (first[axis] + n * joined[axis] + 0.5 * (joined[axis] - 1));
  }
};
/// Means of the joined voxels, i fastest.
std::vector<float> join(const Image& image, const Pixels& pixels);

/// The lattice on which activity is laid out before the camera sees it. Grid frame, mm.
struct CellLattice {
  Index3 count{0, 0, 0};
  Vec3 start{0, 0, 0};  // centre of the first cell
  Vec3 step{1, 1, 1};
  double edge_mm = 0;  // activity has edges of this standard deviation already

  std::size_t size() const { return size_of(count); }
  double cell_mm3() const { return step.prod(); }
};

/// What each pixel collects of the cells along one axis.
struct AxisKernel {
  std::vector<int> from, to;             // per pixel: cells [from, to)
  std::vector<int> at;                   // per pixel: where its weights begin
  std::vector<float> weights, by_width;  // and their derivative by the log of the point spread's deviation
};

/// From cells to pixels: a Gaussian point spread of standard deviation `sigma_mm` along each axis (the edges of the
/// cells included), at least the mean over a voxel. Separable. `filtered` of its variance comes from a filter on the
/// voxels, after they were sampled: where voxels are coarse that leaves images sharper than one Gaussian of the same
/// width.
struct PsfProjector {
  CellLattice cells;
  Pixels pixels;
  std::array<AxisKernel, 3> axes;
};
/// The camera of a point spread over the pixels and cells of a study.
PsfProjector make_camera(const CellLattice& cells, const Pixels& pixels, const Vec3& sigma_mm, double filtered = 0);

/// What the camera sees.
std::vector<float> project(const PsfProjector& camera, std::span<const float> cells);
/// Its derivatives by the log of the point spread's deviation along each axis.
std::array<std::vector<float>, 3> project_by_widths(const PsfProjector& camera, std::span<const float> cells);
/// The transpose of `project`.
std::vector<float> backproject(const PsfProjector& camera, std::span<const float> pixels);

}  // namespace dynasurf::psf_fit
