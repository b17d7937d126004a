#include "examine.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

#include "dynasurf/core/error.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {
namespace {

/// What is true of one patient, in the world.
struct Truth {
  Vec3 axis, centre;  // centre: on the axis, halfway from the middle of the apical wall to the base, mean of the gates
  std::vector<double> base, endo_apex;  // heights along the axis, per gate
};

/// True surfaces begin with the apex and end with the middle of the base.
Truth truth_of(const synthetic::Phantom& phantom) {
  Truth truth;
  truth.axis = Vec3::Zero(), truth.centre = Vec3::Zero();
  const auto gates = static_cast<double>(phantom.truth.size());
  for (const synthetic::TrueGate& gate : phantom.truth) {
    const Vec3 apex = (gate.epi.vertices.front() + gate.endo.vertices.front()) / 2, base = gate.epi.vertices.back();
    truth.axis += base - apex;
    truth.centre += (apex + base) / (2 * gates);
  }
  truth.axis.normalize();
  for (const synthetic::TrueGate& gate : phantom.truth) {
    truth.base.push_back(gate.epi.vertices.back().dot(truth.axis));
    truth.endo_apex.push_back(gate.endo.vertices.front().dot(truth.axis));
  }
  return truth;
}

/// Mean distance of a surface from the true one, whose vertices lie a millimetre or two apart.
double mean_distance(const TriMesh& from, const TriMesh& to) {
  double sum = 0;
  for (const Vec3& p : from.vertices) {
    double nearest = 1e18;
    for (std::size_t q = 0; q < to.vertices.size(); q += 3)
      nearest = std::min(nearest, (p - to.vertices[q]).squaredNorm());
    sum += std::sqrt(nearest);
  }
  return sum / static_cast<double>(from.vertices.size());
}

double on(const ventricle::Result& r, ventricle::Border wall) {
  double sum = 0;
  for (const ventricle::Gate& g : r.gates)
    if (const auto& s = g.edge_surfaces.of(wall)) sum += s->within_one_voxel / static_cast<double>(r.gates.size());
  return sum;
}

std::string text_of(const ventricle::Result& r) {
  const ventricle::QualityMetrics c = ventricle::quality_metrics(r);
  std::array<char, 500> text{};
  std::snprintf(
      text.data(), text.size(),
      "contrast %.2f share %.2f rival %.2f end %.2f out %.2f hot %.2f noise %.3f bridged %.3f unround %.3f moves "
      "%.1f %.1f thick %.1f counts %.2f %.2f rough %.3f %.3f es %.2f seen %.2f spread %.1f cut %.2f wall %.3f edv "
      "%.0f long %.2f %.2f apart %.1f on %.3f %.3f",
      r.heart ? r.heart->contrast : 0, r.heart ? r.heart->ridge_share : 0, r.heart ? r.heart->runner_up : 0,
      r.heart ? r.heart->other_end : 0, r.heart ? r.heart->outside : 0, c.hot_neighbour, c.noise, c.bridged, c.unround,
      c.counts_move_mm, c.surface_moves_mm, c.thickness_mm, c.least_counts, c.most_counts, c.endo_roughness,
      c.epi_roughness, c.end_systole, c.base_seen, c.base_spread_mm, c.base_cut, r.wall_variation.value_or(-1),
      r.readings.edge.edv_ml.value_or(heart::Estimate{-1}).value, c.length_to_width,
      r.heart ? r.heart->cup.half_length_mm / r.heart->cup.radius_mm : 0, c.readings_apart,
      on(r, ventricle::Border::endo), on(r, ventricle::Border::epi));
  return text.data();
}

void compare_place(const ventricle::Result& result, const Truth& truth, Outcome& o) {
  if (!result.heart) return;
  const heart::LvShell& cup = result.heart->cup;
  o.axis_deg = std::acos(std::clamp(cup.axis.dot(truth.axis), -1.0, 1.0)) * 180 / M_PI;
  const Vec3 off = cup.middle() - truth.centre;
  o.centre_mm = off.norm();
  o.across_mm = (off - off.dot(truth.axis) * truth.axis).norm();
}

void compare_slices(const ventricle::Result& result, const Truth& truth, Outcome& o) {
  double base = 0, division = 0;
  int planes = 0;
  const Grid& grid = result.study.grid();
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const ventricle::Gate& gate = result.gates[g];
    const auto on_axis = [&](double height) {
      return Vec3(truth.centre + (height - truth.centre.dot(truth.axis)) * truth.axis);
    };
    if (gate.edge_surfaces.base_plane)
      base += std::abs(gate.edge_surfaces.base_plane->height(on_axis(truth.base[g]))), ++planes;
    const double apex_mm = to_grid(grid, on_axis(truth.endo_apex[g]))[2];
    division += std::abs(gate.labels.division_slice - std::floor(apex_mm / grid.spacing[2]));
  }
  if (planes > 0) o.base_mm = base / planes;
  o.division = division / static_cast<double>(result.gates.size());
}

/// Borders at end-diastole and end-systole: the ejection fraction stands on these.
void compare_borders(const ventricle::Result& result, const synthetic::Phantom& phantom, Outcome& o) {
  const auto [least, most] = std::minmax_element(
      phantom.truth.begin(), phantom.truth.end(),
      [](const synthetic::TrueGate& a, const synthetic::TrueGate& b) { return a.endo_ml < b.endo_ml; });
  o.border_mm = 0;
  for (const auto& true_gate : {most, least}) {
    const auto g = static_cast<std::size_t>(true_gate - phantom.truth.begin());
    const TriMesh& endo = result.gates[g].surfaces.endo->mesh;
    const TriMesh& epi = result.gates[g].surfaces.epi->mesh;
    o.border_mm = std::max({o.border_mm, mean_distance(endo, true_gate->endo), mean_distance(epi, true_gate->epi)});
  }
}

}  // namespace

Outcome examine(const Patient& patient, const synthetic::Phantom& phantom, std::string_view preset, bool is_heart) {
  Outcome o;
  o.patient = patient, o.is_heart = is_heart;
  // The steepest place of a blurred wall lies off its border: up to a quarter of the width of the blur.
  const synthetic::VirtualPatient& p = patient.options;
  o.allowed_mm = Vec3(p.lattice.dx_mm, p.lattice.dy_mm, p.lattice.dz_mm).norm() + 0.25 * phantom.fwhm_mm;
  ventricle::Result result;
  try {
    result = ventricle::reconstruct(phantom.study, ventricle::preset(preset));
  } catch (const InputError& e) {
    o.flags = e.what();
    return o;
  }
  o.verdict = result.verdict;
  for (const ventricle::QualityFlag& f : result.flags)
    if (f.severity != Severity::info) o.flags += (o.flags.empty() ? "" : " ") + f.code;
  o.clues = text_of(result);
  o.has_surfaces = std::all_of(result.gates.begin(), result.gates.end(),
                               [](const ventricle::Gate& g) { return g.surfaces.endo && g.surfaces.epi; });
  if (!is_heart) return o;
  const Truth truth = truth_of(phantom);
  compare_place(result, truth, o);
  compare_slices(result, truth, o);
  if (!o.has_surfaces) return o;
  const ventricle::Reading& leading = result.leading;
  if (leading.ef_percent && phantom.ef_percent) {
    o.ef_error = leading.ef_percent->value - *phantom.ef_percent;
    if (leading.ef_percent->has_interval()) o.ef_90 = (leading.ef_percent->high() - leading.ef_percent->low()) / 2;
  }
  if (leading.edv_ml && phantom.edv_ml) o.edv_ratio = leading.edv_ml->value / *phantom.edv_ml;
  if (leading.kind == ventricle::ReadingKind::psf_corrected && leading.ef_percent) o.least_edv_ratio = 0.75;
  compare_borders(result, phantom, o);
  return o;
}

}  // namespace dynasurf
