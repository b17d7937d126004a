#include "dynasurf/psf_fit/detail/activity.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/lane_math.hpp"

namespace dynasurf::psf_fit {
namespace {

using detail::AlignedMatrix, detail::Step, detail::normal_cdf;

/// Inside of a wall at q_wall seen from q. A step of width e in q, moved in by e^2 / q_wall, holds the volume of the
/// sharp one: the integral of 3 q^2 over it is q_wall^3.
struct Inside {
  float share, by_wall;  // and its derivative by q_wall
};
DYNASURF_INLINE Inside inside_of(float wall, float q, float edge) {
  const float s = (wall - edge * edge / wall - q) / edge;
  const Step step = normal_cdf(s);
  return {step.share, step.slope * (1 / edge + edge / (wall * wall))};
}

constexpr std::size_t cells_at_once = 4096;
constexpr float least_log_uptake = -5, most_log_uptake = 2;

/// Numbers of the gates that are blended at the cells into one field.
struct Blending {
  std::size_t harmonics;
  std::vector<float> numbers;  // [harmonic][gate]
};
Blending blending_of(const std::vector<Eigen::VectorXd>& gates, int first, int degree, const HeartCells& cells,
                     AlignedMatrix& field) {
  const std::size_t count = harmonics_up_to(degree);
  // What all gates have in common is summed once.
  const bool is_common = std::all_of(gates.begin(), gates.end(), [&](const Eigen::VectorXd& gate) {
    return gate.segment(first, count) == gates.front().segment(first, count);
  });
  field = AlignedMatrix(is_common ? 1 : gates.size(), cells.cell.size());
  Blending blending{count, {}};
  for (std::size_t k = 0; k < count; ++k)
    for (std::size_t g = 0; g < field.count; ++g) blending.numbers.push_back(gates[g][first + k]);
  return blending;
}

const float* line_of(const AlignedMatrix& fields, std::size_t g) { return fields.line(fields.count == 1 ? 0 : g); }

struct Plane {
  float height, along_x, along_y;
};
Plane plane_of(const GateLayout& layout, const Eigen::VectorXd& gate) {
  const float height = gate[layout.plane], along_x = gate[layout.plane + 1], along_y = gate[layout.plane + 2];
  return {height, along_x, along_y};
}

/// What the loops over cells read of the cells and of one gate.
struct GateCells {
  const float *q, *edge_q, *x, *y, *z;
  std::size_t count;
  Plane plane;
  float edge_mm, cavity, background;
};
GateCells gate_cells(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate) {
  const float edge_mm = cells.lattice.edge_mm, cavity = gate[layout.cavity], background = gate[layout.background];
  return {cells.q.data(),    cells.edge_q.data(),    cells.x.data(), cells.y.data(), cells.z.data(),
          cells.cell.size(), plane_of(layout, gate), edge_mm,        cavity,         background};
}

DYNASURF_CLONES
void rasterise_walls(const GateCells& cells, const float* __restrict log_endo, const float* __restrict log_wall,
                     float* __restrict endo, float* __restrict epi, float* __restrict by_endo, float* __restrict by_epi,
                     float* __restrict epi_by_endo, float* __restrict epi_by_wall) {
  for (std::size_t c = 0; c < cells.count; ++c) {
    const float q_endo = detail::exp_of(std::min(std::max(log_endo[c], -4.0F), 2.0F));
    const float muscle = detail::exp_of(std::min(std::max(log_wall[c], -9.0F), 4.0F));
    const float endo_cubed = q_endo * q_endo * q_endo;
    // Volumes add where q^3 does: the outer wall lies outside the inner one whatever the numbers are.
    const float q_epi = detail::cube_root(endo_cubed + muscle);
    const Inside inner = inside_of(q_endo, cells.q[c], cells.edge_q[c]);
    const Inside outer = inside_of(q_epi, cells.q[c], cells.edge_q[c]);
    endo[c] = inner.share, epi[c] = outer.share;
    by_endo[c] = inner.by_wall * q_endo;
    by_epi[c] = outer.by_wall;
    epi_by_endo[c] = endo_cubed / (q_epi * q_epi);
    epi_by_wall[c] = muscle / (3 * q_epi * q_epi);
  }
}

/// `active`: the activity of each cell.
DYNASURF_CLONES
void lay_activity(const GateCells& cells, const float* __restrict log_uptake, const float* __restrict endo,
                  const float* __restrict epi, float* __restrict below, float* __restrict by_plane,
                  float* __restrict uptake, float* __restrict active) {
  for (std::size_t c = 0; c < cells.count; ++c) {
    const float height =
        cells.plane.height + cells.plane.along_x * cells.x[c] + cells.plane.along_y * cells.y[c] - cells.z[c];
    const Step step = normal_cdf(height / cells.edge_mm);
    below[c] = step.share;
    by_plane[c] = step.slope / cells.edge_mm;
    uptake[c] = detail::exp_of(std::min(std::max(log_uptake[c], least_log_uptake), most_log_uptake));
    active[c] = step.share * ((uptake[c] - cells.background) * epi[c] + (cells.cavity - uptake[c]) * endo[c]);
  }
}

/// Derivatives of a quantity by the fields at each cell and by what is below the base, from those by the activity of
/// the cell and by the two volumes.
struct ByVolume {
  float endo, epi;
};
DYNASURF_CLONES
void trace_walls(const GateCells& cells, const Activity& a, ByVolume volume, const float* __restrict by_active,
                 float* __restrict endo, float* __restrict wall, float* __restrict uptake,
                 float* __restrict by_height) {
  const float *__restrict in_endo = a.endo.data(), *__restrict in_epi = a.epi.data(), *__restrict below = a.below.data(),
              *__restrict by_endo = a.by_endo.data(), *__restrict by_epi = a.by_epi.data(),
              *__restrict by_plane = a.by_plane.data(), *__restrict epi_by_endo = a.epi_by_endo.data(),
              *__restrict epi_by_wall = a.epi_by_wall.data(), *__restrict level = a.uptake.data();
  for (std::size_t c = 0; c < cells.count; ++c) {
    const float l = by_active[c], lb = l * below[c];
    const float inner = cells.cavity - level[c], outer = level[c] - cells.background;
    const float by_q_epi = (lb * outer + volume.epi * below[c]) * by_epi[c];
    endo[c] = (lb * inner + volume.endo * below[c]) * by_endo[c] + by_q_epi * epi_by_endo[c];
    wall[c] = by_q_epi * epi_by_wall[c];
    uptake[c] = lb * (in_epi[c] - in_endo[c]) * level[c];
    by_height[c] = (l * (outer * in_epi[c] + inner * in_endo[c]) + volume.endo * in_endo[c] + volume.epi * in_epi[c]) *
                   by_plane[c];
  }
}

}  // namespace

HeartCells select_cells(const CellLattice& lattice, const HeartFrame& frame, int degree, double highest_mm,
                        const Eigen::VectorXd& surface, int surface_degree, double margin_mm) {
  HeartCells cells;
  cells.lattice = lattice;
  cells.frame = frame;
  const auto place_of = [&](int i, int j, int k) {
    return frame.to_heart(lattice.start + Vec3(i, j, k).cwiseProduct(lattice.step));
  };
  const auto direction_of = [&](const Vec3& scaled) {
    return scaled.norm() > 1e-9 ? Vec3(scaled.normalized()) : Vec3(0, 0, -1);
  };
  std::vector<std::vector<std::size_t>> of_slice(lattice.count[2]);
  parallel_for(of_slice.size(), 1, [&](std::size_t k, std::size_t) {
    std::vector<double> values(harmonics_up_to(surface_degree));
    const Eigen::Map<const Eigen::VectorXd> harmonics(values.data(), values.size());
    std::size_t cell = k * lattice.count[0] * lattice.count[1];
    for (int j = 0; j < lattice.count[1]; ++j)
      for (int i = 0; i < lattice.count[0]; ++i, ++cell) {
        const Vec3 heart = place_of(i, j, k);
        if (heart[2] > highest_mm) continue;
        const Vec3 scaled = heart.cwiseQuotient(frame.scale), direction = direction_of(scaled);
        real_spherical_harmonics(direction, surface_degree, values);
        const double room = margin_mm * direction.cwiseQuotient(frame.scale).norm();
        if (scaled.norm() <= own::exp(surface.head(harmonics.size()).dot(harmonics)) + room)
          of_slice[k].push_back(cell);
      }
  });
  for (const auto& slice : of_slice) cells.cell.insert(cells.cell.end(), slice.begin(), slice.end());
  for (auto* values : {&cells.q, &cells.edge_q, &cells.x, &cells.y, &cells.z}) values->resize(cells.cell.size());
  const std::size_t lines = harmonics_up_to(degree);
  cells.harmonics = {lines, cells.cell.size()};
  parallel_for(cells.cell.size(), cells_at_once, [&](std::size_t begin, std::size_t end) {
    std::vector<double> values(cells.harmonics.count);
    const std::size_t row = lattice.count[0], plane = row * lattice.count[1];
    for (std::size_t c = begin; c < end; ++c) {
      const std::size_t cell = cells.cell[c];
      const Vec3 heart = place_of(cell % row, cell % plane / row, cell / plane);
      const Vec3 scaled = heart.cwiseQuotient(frame.scale), direction = direction_of(scaled);
      cells.q[c] = scaled.norm();
      // The slope of q, per mm, turns the width of an edge.
      cells.edge_q[c] = lattice.edge_mm * direction.cwiseQuotient(frame.scale).norm();
      cells.x[c] = heart[0];
      cells.y[c] = heart[1];
      cells.z[c] = heart[2];
      real_spherical_harmonics(direction, degree, values);
      for (std::size_t h = 0; h < values.size(); ++h) cells.harmonics.line(h)[c] = values[h];
    }
  });
  return cells;
}

CellFields fields_of(const HeartCells& cells, const GateLayout& layout, const std::vector<Eigen::VectorXd>& gates) {
  CellFields fields;
  const Blending endo = blending_of(gates, layout.endo, layout.endo_degree, cells, fields.endo),
                 wall = blending_of(gates, layout.wall, layout.wall_degree, cells, fields.wall),
                 uptake = blending_of(gates, layout.uptake, layout.uptake_degree, cells, fields.uptake);
  parallel_for(cells.harmonics.pitch(), cells_at_once / 4, [&](std::size_t begin, std::size_t end) {
    gemm(cells.harmonics, endo.harmonics, endo.numbers.data(), begin, end, fields.endo);
    gemm(cells.harmonics, wall.harmonics, wall.numbers.data(), begin, end, fields.wall);
    gemm(cells.harmonics, uptake.harmonics, uptake.numbers.data(), begin, end, fields.uptake);
  });
  return fields;
}

Activity rasterise(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate) {
  return rasterise(cells, layout, gate, fields_of(cells, layout, {gate}), 0);
}

Activity rasterise(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                   const CellFields& fields, std::size_t g) {
  const std::size_t n = cells.cell.size();
  Activity a;
  for (auto* v :
       {&a.endo, &a.epi, &a.below, &a.by_endo, &a.by_epi, &a.by_plane, &a.epi_by_endo, &a.epi_by_wall, &a.uptake})
    v->resize(n);
  std::vector<float> active(n);
  const GateCells of_gate = gate_cells(cells, layout, gate);
  rasterise_walls(of_gate, line_of(fields.endo, g), line_of(fields.wall, g), a.endo.data(), a.epi.data(),
                  a.by_endo.data(), a.by_epi.data(), a.epi_by_endo.data(), a.epi_by_wall.data());
  lay_activity(of_gate, line_of(fields.uptake, g), a.endo.data(), a.epi.data(), a.below.data(), a.by_plane.data(),
               a.uptake.data(), active.data());
  a.cells.assign(cells.lattice.size(), 0.0F);
  double cavity_cells = 0, wall_cells = 0;
  for (std::size_t c = 0; c < n; ++c) {
    a.cells[cells.cell[c]] = active[c];
    cavity_cells += a.below[c] * a.endo[c];
    wall_cells += a.below[c] * (a.epi[c] - a.endo[c]);
  }
  a.cavity_mm3 = cavity_cells * cells.lattice.cell_mm3();
  a.wall_mm3 = wall_cells * cells.lattice.cell_mm3();
  return a;
}

CellGradients no_gradients(const HeartCells& cells, const GateLayout& layout, std::size_t gates) {
  const std::size_t count = cells.cell.size();
  return {AlignedMatrix(gates, count), AlignedMatrix(gates, count), AlignedMatrix(gates, count),
          std::vector<Eigen::VectorXd>(gates, Eigen::VectorXd::Zero(layout.count()))};
}

void backpropagate_to_cells(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                            const Activity& a, std::span<const float> by_cell, double by_cavity, double by_wall,
                            CellGradients& to, std::size_t g) {
  const std::size_t n = cells.cell.size();
  const float of_cavity = (by_cavity - by_wall) * cells.lattice.cell_mm3(),
              of_wall = by_wall * cells.lattice.cell_mm3();
  const ByVolume volume{of_cavity, of_wall};
  std::vector<float> by_active(n, 0.0F), by_height(n);
  if (!by_cell.empty())
    for (std::size_t c = 0; c < n; ++c) by_active[c] = by_cell[cells.cell[c]];
  trace_walls(gate_cells(cells, layout, gate), a, volume, by_active.data(), to.endo.line(g), to.wall.line(g),
              to.uptake.line(g), by_height.data());
  double height = 0, along_x = 0, along_y = 0, to_cavity = 0, to_background = 0;
  for (std::size_t c = 0; c < n; ++c) {
    const double of_height = by_height[c];
    height += of_height;
    along_x += of_height * cells.x[c];
    along_y += of_height * cells.y[c];
    const float lb = by_active[c] * a.below[c];
    to_cavity += lb * a.endo[c];
    to_background -= lb * a.epi[c];
  }
  Eigen::VectorXd& others = to.others[g];
  others[layout.plane] = height, others[layout.plane + 1] = along_x, others[layout.plane + 2] = along_y;
  others[layout.cavity] = to_cavity, others[layout.background] = to_background;
}

std::vector<Eigen::VectorXd> gather(const HeartCells& cells, const GateLayout& layout, const CellGradients& gradients) {
  std::vector<Eigen::VectorXd> numbers = gradients.others;
  const std::size_t gates = numbers.size(), length = cells.harmonics.pitch();
  const std::array<const AlignedMatrix*, 3> field{&gradients.endo, &gradients.wall, &gradients.uptake};
  const std::array<int, 3> first{layout.endo, layout.wall, layout.uptake};
  const std::array<int, 3> degree{layout.endo_degree, layout.wall_degree, layout.uptake_degree};
  std::array<std::size_t, 3> count{};
  std::transform(degree.begin(), degree.end(), count.begin(), harmonics_up_to);
  const std::size_t pieces = (length + cells_at_once - 1) / cells_at_once;
  std::vector<std::vector<float>> sums(field.size() * pieces);  // field by field
  parallel_for(sums.size(), 1, [&](std::size_t task, std::size_t) {
    const std::size_t f = task / pieces, begin = task % pieces * cells_at_once;
    sums[task].resize(count[f] * gates);
    gemm_t(cells.harmonics, count[f], *field[f], begin, std::min(begin + cells_at_once, length), sums[task].data());
  });
  for (std::size_t task = 0; task < sums.size(); ++task)
    for (std::size_t k = 0; k < count[task / pieces]; ++k)
      for (std::size_t g = 0; g < gates; ++g) numbers[g][first[task / pieces] + k] += sums[task][k * gates + g];
  return numbers;
}

Eigen::VectorXd backpropagate(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                              const Activity& activity, std::span<const float> by_cell, double by_cavity,
                              double by_wall) {
  CellGradients gradients = no_gradients(cells, layout, 1);
  backpropagate_to_cells(cells, layout, gate, activity, by_cell, by_cavity, by_wall, gradients, 0);
  return gather(cells, layout, gradients).front();
}

}  // namespace dynasurf::psf_fit
