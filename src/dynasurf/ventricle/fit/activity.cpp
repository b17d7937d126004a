#include "dynasurf/ventricle/fit/activity.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
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

constexpr std::size_t cells_at_once = 4096;
constexpr float least_log_uptake = -5, most_log_uptake = 2;

/// Sums of harmonics at the cells, one column per gate.
Eigen::MatrixXf spread_over_cells(const HeartCells& cells, const std::vector<Eigen::VectorXd>& gates, int first,
                                  int degree) {
  const int count = harmonics_up_to(degree);
  Eigen::MatrixXf numbers(count, static_cast<Eigen::Index>(gates.size()));
  for (std::size_t g = 0; g < gates.size(); ++g)
    numbers.col(static_cast<Eigen::Index>(g)) = gates[g].segment(first, count).cast<float>();
  // What all gates have in common is summed once.
  const bool is_common = (numbers.colwise() - numbers.col(0)).isZero(0);
  Eigen::MatrixXf fields(static_cast<Eigen::Index>(cells.cell.size()), is_common ? 1 : numbers.cols());
  parallel_for(cells.cell.size(), cells_at_once, [&](std::size_t begin, std::size_t end) {
    const auto from = static_cast<Eigen::Index>(begin), rows = static_cast<Eigen::Index>(end - begin);
    fields.middleRows(from, rows).noalias() =
        cells.harmonics.block(from, 0, rows, count) * numbers.leftCols(fields.cols());
  });
  return fields;
}

Eigen::Index column_of(const Eigen::MatrixXf& fields, Eigen::Index g) { return fields.cols() == 1 ? 0 : g; }

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

CellFields fields_of(const HeartCells& cells, const GateLayout& layout, const std::vector<Eigen::VectorXd>& gates) {
  return {spread_over_cells(cells, gates, layout.endo, layout.endo_degree),
          spread_over_cells(cells, gates, layout.wall, layout.wall_degree),
          spread_over_cells(cells, gates, layout.uptake, layout.uptake_degree)};
}

Activity lay_out(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate) {
  return lay_out(cells, layout, gate, fields_of(cells, layout, {gate}), 0);
}

Activity lay_out(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                 const CellFields& fields, Eigen::Index g) {
  const std::size_t n = cells.cell.size();
  Activity a;
  for (auto* v :
       {&a.endo, &a.epi, &a.below, &a.by_endo, &a.by_epi, &a.by_plane, &a.epi_by_endo, &a.epi_by_wall, &a.uptake})
    v->resize(n);
  a.cells.assign(cells.lattice.size(), 0.0F);
  const auto log_endo = fields.endo.col(column_of(fields.endo, g));
  const auto log_wall = fields.wall.col(column_of(fields.wall, g));
  const auto log_uptake = fields.uptake.col(column_of(fields.uptake, g));
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
    a.uptake[c] = std::exp(std::clamp(log_uptake[row], least_log_uptake, most_log_uptake));
    a.cells[cells.cell[c]] =
        below.share * ((a.uptake[c] - background) * epi.share + (cavity - a.uptake[c]) * endo.share);
    cavity_cells += static_cast<double>(below.share * endo.share);
    wall_cells += static_cast<double>(below.share * (epi.share - endo.share));
  }
  a.cavity_mm3 = cavity_cells * cells.lattice.cell_mm3();
  a.wall_mm3 = wall_cells * cells.lattice.cell_mm3();
  return a;
}

CellGradient trace_to_cells(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                            const Activity& a, std::span<const float> by_cell, double by_cavity, double by_wall) {
  const std::size_t n = cells.cell.size();
  const auto cavity = static_cast<float>(gate[layout.cavity]);
  const auto background = static_cast<float>(gate[layout.background]);
  const auto volume_endo = static_cast<float>((by_cavity - by_wall) * cells.lattice.cell_mm3());
  const auto volume_epi = static_cast<float>(by_wall * cells.lattice.cell_mm3());
  CellGradient to;
  Eigen::VectorXf &endo = to.endo, &wall = to.wall, &uptake = to.uptake;
  for (Eigen::VectorXf* field : {&endo, &wall, &uptake}) field->resize(static_cast<Eigen::Index>(n));
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
    uptake[row] = lb * (a.epi[c] - a.endo[c]) * a.uptake[c];
    const auto by_height = static_cast<double>(by_below * a.by_plane[c]);
    height += by_height;
    along_x += by_height * static_cast<double>(cells.x[c]);
    along_y += by_height * static_cast<double>(cells.y[c]);
    to_cavity += static_cast<double>(lb * a.endo[c]);
    to_background -= static_cast<double>(lb * a.epi[c]);
  }
  to.others = Eigen::VectorXd::Zero(layout.count());
  to.others[layout.plane] = height, to.others[layout.plane + 1] = along_x, to.others[layout.plane + 2] = along_y;
  to.others[layout.cavity] = to_cavity, to.others[layout.background] = to_background;
  return to;
}

std::vector<Eigen::VectorXd> gather(const HeartCells& cells, const GateLayout& layout,
                                    const std::vector<CellGradient>& gradients) {
  const auto gates = static_cast<Eigen::Index>(gradients.size());
  std::vector<Eigen::VectorXd> numbers;
  for (const CellGradient& gradient : gradients) numbers.push_back(gradient.others);
  const std::size_t pieces = (cells.cell.size() + cells_at_once - 1) / cells_at_once;
  const auto project = [&](const Eigen::VectorXf CellGradient::*field, int first, int degree) {
    const int count = harmonics_up_to(degree);
    std::vector<Eigen::MatrixXf> sums(pieces);
    parallel_for(cells.cell.size(), cells_at_once, [&](std::size_t begin, std::size_t end) {
      const auto from = static_cast<Eigen::Index>(begin), rows = static_cast<Eigen::Index>(end - begin);
      Eigen::MatrixXf fields(rows, gates);
      for (Eigen::Index g = 0; g < gates; ++g)
        fields.col(g) = (gradients[static_cast<std::size_t>(g)].*field).segment(from, rows);
      sums[begin / cells_at_once].noalias() = cells.harmonics.block(from, 0, rows, count).transpose() * fields;
    });
    for (const Eigen::MatrixXf& sum : sums)
      for (Eigen::Index g = 0; g < gates; ++g)
        numbers[static_cast<std::size_t>(g)].segment(first, count) += sum.col(g).cast<double>();
  };
  project(&CellGradient::endo, layout.endo, layout.endo_degree);
  project(&CellGradient::wall, layout.wall, layout.wall_degree);
  project(&CellGradient::uptake, layout.uptake, layout.uptake_degree);
  return numbers;
}

Eigen::VectorXd trace_back(const HeartCells& cells, const GateLayout& layout, const Eigen::VectorXd& gate,
                           const Activity& activity, std::span<const float> by_cell, double by_cavity, double by_wall) {
  return gather(cells, layout, {trace_to_cells(cells, layout, gate, activity, by_cell, by_cavity, by_wall)}).front();
}

}  // namespace dynasurf
