#include "dynasurf/ventricle/fit/activity.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/error.hpp"
#include "dynasurf/ventricle/fit/harmonics.hpp"

namespace dynasurf {
namespace {

constexpr float beyond = 4.5F;  // edge widths at which a step is over

/// Gaussian step and its slope.
struct Step {
  float share = 0, slope = 0;
};
Step step_at(float s) {
  if (s >= beyond) return {1, 0};
  if (s <= -beyond) return {0, 0};
  constexpr float root_half = 0.70710678F, peak = 0.39894228F;
  return {0.5F * std::erfc(-s * root_half), peak * std::exp(-0.5F * s * s)};
}

/// Inside of a wall at q_wall seen from q. A step of width e in q, moved in by e^2 / q_wall, holds the volume of the
/// sharp one: the integral of 3 q^2 over it is q_wall^3.
struct Inside {
  float share, by_wall;  // and its derivative by q_wall
};
Inside inside_of(float wall, float q, float edge) {
  const float s = (wall - edge * edge / wall - q) / edge;
  const Step step = step_at(s);
  return {step.share, step.slope * (1 / edge + edge / (wall * wall))};
}

Eigen::VectorXf fields(const HeartCells& cells, const Eigen::VectorXd& gate, int first, int degree) {
  const int count = harmonics_up_to(degree);
  const Eigen::VectorXf numbers = gate.segment(first, count).cast<float>();
  return cells.harmonics.leftCols(count) * numbers;
}

struct Plane {
  float height, along_x, along_y;
};
Plane plane_of(const GateLayout& layout, const Eigen::VectorXd& gate) {
  return {static_cast<float>(gate[layout.plane]), static_cast<float>(gate[layout.plane + 1]),
          static_cast<float>(gate[layout.plane + 2])};
}

}  // namespace

HeartCells select_cells(const CellLattice& lattice, const HeartFrame& frame, int degree, double highest_mm,
                        const Eigen::VectorXd& surface, int surface_degree, double margin_mm) {
  HeartCells cells;
  cells.lattice = lattice;
  cells.frame = frame;
  const int most = std::max(degree, surface_degree);
  std::vector<double> values(static_cast<std::size_t>(harmonics_up_to(most)));
  std::vector<float> rows;
  for (int k = 0; k < lattice.count[2]; ++k)
    for (int j = 0; j < lattice.count[1]; ++j)
      for (int i = 0; i < lattice.count[0]; ++i) {
        const Vec3 p = lattice.start + Vec3(i, j, k).cwiseProduct(lattice.step);
        const Vec3 heart = frame.to_heart(p);
        if (heart[2] > highest_mm) continue;
        const Vec3 scaled = heart.cwiseQuotient(frame.scale);
        const double q = scaled.norm();
        const Vec3 direction = q > 1e-9 ? Vec3(scaled / q) : Vec3(0, 0, -1);
        harmonics_at(direction, most, values);
        const double slope = direction.cwiseQuotient(frame.scale).norm();  // of q, per mm
        double wall = 0;
        for (int h = 0; h < harmonics_up_to(surface_degree); ++h)
          wall += surface[h] * values[static_cast<std::size_t>(h)];
        if (q > std::exp(wall) + margin_mm * slope) continue;
        cells.cell.push_back(static_cast<std::size_t>(i) +
                             static_cast<std::size_t>(lattice.count[0]) *
                                 (static_cast<std::size_t>(j) + static_cast<std::size_t>(lattice.count[1]) * k));
        cells.q.push_back(static_cast<float>(q));
        cells.edge_q.push_back(static_cast<float>(lattice.edge_mm * slope));
        cells.x.push_back(static_cast<float>(heart[0]));
        cells.y.push_back(static_cast<float>(heart[1]));
        cells.z.push_back(static_cast<float>(heart[2]));
        for (int h = 0; h < harmonics_up_to(degree); ++h)
          rows.push_back(static_cast<float>(values[static_cast<std::size_t>(h)]));
      }
  cells.harmonics = Eigen::Map<Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>(
      rows.data(), static_cast<Eigen::Index>(cells.cell.size()), harmonics_up_to(degree));
  return cells;
}

Activity lay_out(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate) {
  const std::size_t n = cells.cell.size();
  Activity a;
  for (auto* v :
       {&a.endo, &a.epi, &a.below, &a.by_endo, &a.by_epi, &a.by_plane, &a.epi_by_endo, &a.epi_by_wall, &a.uptake})
    v->resize(n);
  a.cells.assign(cells.lattice.size(), 0.0F);
  const Eigen::VectorXf log_endo = fields(cells, gate, layout.endo, layout.endo_degree);
  const Eigen::VectorXf log_wall = fields(cells, gate, layout.wall, layout.wall_degree);
  const Eigen::VectorXf uptake = fields(cells, gate, layout.uptake, layout.uptake_degree);
  const Plane plane = plane_of(layout, gate);
  const auto edge_mm = static_cast<float>(cells.lattice.edge_mm);
  const auto cavity = static_cast<float>(gate[layout.cavity]);
  const auto background = static_cast<float>(gate[layout.background]);
  double cavity_cells = 0, wall_cells = 0;
  for (std::size_t c = 0; c < n; ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    const float q_endo = std::exp(std::clamp(log_endo[row], -4.0F, 2.0F));
    const float muscle = std::exp(std::clamp(log_wall[row], -9.0F, 4.0F));
    const float endo_cubed = q_endo * q_endo * q_endo;
    const float q_epi = std::cbrt(endo_cubed + muscle);
    const Inside endo = inside_of(q_endo, cells.q[c], cells.edge_q[c]);
    const Inside epi = inside_of(q_epi, cells.q[c], cells.edge_q[c]);
    const Step below =
        step_at((plane.height + plane.along_x * cells.x[c] + plane.along_y * cells.y[c] - cells.z[c]) / edge_mm);
    a.endo[c] = endo.share, a.epi[c] = epi.share, a.below[c] = below.share;
    a.by_endo[c] = endo.by_wall * q_endo;
    a.by_epi[c] = epi.by_wall;
    a.by_plane[c] = below.slope / edge_mm;
    a.epi_by_endo[c] = endo_cubed / (q_epi * q_epi);
    a.epi_by_wall[c] = muscle / (3 * q_epi * q_epi);
    a.uptake[c] = uptake[row];
    a.cells[cells.cell[c]] =
        below.share * ((uptake[row] - background) * epi.share + (cavity - uptake[row]) * endo.share);
    cavity_cells += static_cast<double>(below.share * endo.share);
    wall_cells += static_cast<double>(below.share * (epi.share - endo.share));
  }
  a.cavity_mm3 = cavity_cells * cells.lattice.cell_mm3();
  a.wall_mm3 = wall_cells * cells.lattice.cell_mm3();
  return a;
}

Eigen::VectorXd trace_back(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                           const Activity& a, std::span<const float> by_cell, double by_cavity, double by_wall) {
  const std::size_t n = cells.cell.size();
  const auto cavity = static_cast<float>(gate[layout.cavity]);
  const auto background = static_cast<float>(gate[layout.background]);
  const auto volume_endo = static_cast<float>((by_cavity - by_wall) * cells.lattice.cell_mm3());
  const auto volume_epi = static_cast<float>(by_wall * cells.lattice.cell_mm3());
  Eigen::VectorXf endo(static_cast<Eigen::Index>(n)), wall(endo.size()), uptake(endo.size());
  double height = 0, along_x = 0, along_y = 0, to_cavity = 0, to_background = 0;
  for (std::size_t c = 0; c < n; ++c) {
    const auto row = static_cast<Eigen::Index>(c);
    const float l = by_cell.empty() ? 0.0F : by_cell[cells.cell[c]];
    const float lb = l * a.below[c];
    const float by_endo_share = lb * (cavity - a.uptake[c]) + volume_endo * a.below[c];
    const float by_epi_share = lb * (a.uptake[c] - background) + volume_epi * a.below[c];
    const float by_below = l * ((a.uptake[c] - background) * a.epi[c] + (cavity - a.uptake[c]) * a.endo[c]) +
                           volume_endo * a.endo[c] + volume_epi * a.epi[c];
    const float by_q_epi = by_epi_share * a.by_epi[c];
    endo[row] = by_endo_share * a.by_endo[c] + by_q_epi * a.epi_by_endo[c];
    wall[row] = by_q_epi * a.epi_by_wall[c];
    uptake[row] = lb * (a.epi[c] - a.endo[c]);
    const auto by_height = static_cast<double>(by_below * a.by_plane[c]);
    height += by_height;
    along_x += by_height * static_cast<double>(cells.x[c]);
    along_y += by_height * static_cast<double>(cells.y[c]);
    to_cavity += static_cast<double>(lb * a.endo[c]);
    to_background -= static_cast<double>(lb * a.epi[c]);
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(layout.count());
  const auto project = [&](const Eigen::VectorXf& field, int first, int degree) {
    const int count = harmonics_up_to(degree);
    gradient.segment(first, count) = (cells.harmonics.leftCols(count).transpose() * field).cast<double>();
  };
  project(endo, layout.endo, layout.endo_degree);
  project(wall, layout.wall, layout.wall_degree);
  project(uptake, layout.uptake, layout.uptake_degree);
  gradient[layout.plane] = height, gradient[layout.plane + 1] = along_x, gradient[layout.plane + 2] = along_y;
  gradient[layout.cavity] = to_cavity, gradient[layout.background] = to_background;
  return gradient;
}

}  // namespace dynasurf
