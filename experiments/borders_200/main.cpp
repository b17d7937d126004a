// Two hundred virtual patients through the whole pipeline, without help. Prints one line per patient and a table.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/ventricle/function.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "patients.hpp"

namespace dynasurf {
namespace {

/// What is true of one patient, in the world.
struct Truth {
  Vec3 axis, centre;  // centre: on the axis, halfway from the middle of the apical wall to the base, mean of the gates
  std::vector<double> base, endo_apex;  // heights along the axis, per gate
};

struct Span {
  double low, high;
};
Span span_along(const TriMesh& mesh, const Vec3& axis) {
  Span s{1e9, -1e9};
  for (const Vec3& p : mesh.vertices) s.low = std::min(s.low, p.dot(axis)), s.high = std::max(s.high, p.dot(axis));
  return s;
}

Truth truth_of(const Patient& patient, const Phantom& phantom) {
  const Pose& pose = patient.options.pose;
  const double t = pose.tilt_deg * M_PI / 180, a = pose.tilt_towards_deg * M_PI / 180;
  Mat3 direction = phantom.study.grid().direction;
  if (patient.options.base_first) direction.col(2) *= -1;
  Truth truth;
  truth.axis = direction * Vec3(std::sin(t) * std::cos(a), std::sin(t) * std::sin(a), std::cos(t));
  Vec3 mean = Vec3::Zero();
  double middle = 0;
  const auto gates = static_cast<double>(phantom.truth.size());
  for (const TrueGate& gate : phantom.truth) {
    const Span epi = span_along(gate.epi, truth.axis), endo = span_along(gate.endo, truth.axis);
    truth.base.push_back(epi.high);
    truth.endo_apex.push_back(endo.low);
    middle += ((epi.low + endo.low) / 2 + epi.high) / 2 / gates;
    for (const Vec3& p : gate.epi.vertices) mean += p / (gates * static_cast<double>(gate.epi.vertices.size()));
  }
  truth.centre = mean + (middle - mean.dot(truth.axis)) * truth.axis;
  return truth;
}

double mean_distance(const TriMesh& from, const TriMesh& to) {
  double sum = 0;
  for (const Vec3& p : from.vertices) {
    double nearest = 1e18;
    for (const Vec3& q : to.vertices) nearest = std::min(nearest, (p - q).squaredNorm());
    sum += std::sqrt(nearest);
  }
  return sum / static_cast<double>(from.vertices.size());
}

struct Outcome {
  Patient patient;
  bool ran = false, has_surfaces = false, has_plane = false, has_heart = false;
  double ef = 0, ef_error = 99, axis_deg = 180, centre_mm = 999, across_mm = 999, base_mm = 999, division = 99;
  double border_mm = 999, allowed_mm = 0, edv_ratio = 0;
  Verdict verdict = Verdict::fail;
  std::string flags, clues;  // clues: the numbers that flags are made from

  bool wrong() const { return !has_surfaces || std::abs(ef_error) > 8 || border_mm > allowed_mm || centre_mm > 20; }
};

std::string clues_of(const VentricleResult& r) {
  std::vector<double> endo, epi, counts;
  double arrived = 1, spread = 0, seen = 0;
  for (std::size_t g = 0; g < r.gates.size(); ++g) {
    const Gate& gate = r.gates[g];
    if (gate.endo) endo.push_back(gate.endo->volume_ml), arrived = std::min(arrived, gate.endo->within_one_voxel);
    if (gate.epi) epi.push_back(gate.epi->volume_ml), arrived = std::min(arrived, gate.epi->within_one_voxel);
    if (gate.base_plane) {
      spread += gate.base_plane->spread_mm / static_cast<double>(r.gates.size());
      seen += gate.base_plane->seen / static_cast<double>(r.gates.size());
    }
  }
  std::array<char, 256> text{};
  std::snprintf(
      text.data(), text.size(),
      "rough %.3f %.3f wall %.3f edv %.0f arrived %.2f spread %.1f seen %.2f contrast %.2f share %.2f rival %.2f "
      "end %.2f",
      cycle_roughness(endo), cycle_roughness(epi), r.wall_variation.value_or(-1), r.edv_ml.value_or(-1), arrived,
      spread, seen, r.heart ? r.heart->contrast : 0, r.heart ? r.heart->ridge_share : 0,
      r.heart ? r.heart->runner_up : 0, r.heart ? r.heart->other_end : 0);
  return text.data();
}

Outcome examine(int number) {
  Outcome o;
  o.patient = draw_patient(number);
  Phantom phantom = scan(o.patient);
  const Truth truth = truth_of(o.patient, phantom);
  VentricleResult result;
  try {
    result = reconstruct(phantom.study, VentricleOptions{});
  } catch (const InputError& e) {
    o.flags = e.what();
    return o;
  }
  o.ran = true;
  o.verdict = result.verdict;
  for (const Flag& f : result.flags) o.flags += (o.flags.empty() ? "" : " ") + f.code;
  if (result.heart) {
    o.has_heart = true;
    const Cup& cup = result.heart->cup;
    o.axis_deg = std::acos(std::clamp(cup.axis.dot(truth.axis), -1.0, 1.0)) * 180 / M_PI;
    const Vec3 off = cup.middle() - truth.centre;
    o.centre_mm = off.norm();
    o.across_mm = (off - off.dot(truth.axis) * truth.axis).norm();
  }
  o.clues = clues_of(result);
  o.has_surfaces = std::all_of(result.gates.begin(), result.gates.end(), [](const Gate& g) { return g.endo && g.epi; });
  double base = 0, division = 0;
  int planes = 0;
  const Grid& grid = result.study.grid();
  for (std::size_t g = 0; g < result.gates.size(); ++g) {
    const Gate& gate = result.gates[g];
    if (gate.base_plane) {
      const Vec3 p = truth.centre + (truth.base[g] - truth.centre.dot(truth.axis)) * truth.axis;
      base += std::abs(gate.base_plane->height(p)), ++planes;
    }
    const Vec3 apex = truth.centre + (truth.endo_apex[g] - truth.centre.dot(truth.axis)) * truth.axis;
    division += std::abs(gate.labels.division_slice - std::floor(to_grid(grid, apex)[2] / grid.spacing[2]));
  }
  o.has_plane = planes > 0;
  if (planes) o.base_mm = base / planes;
  o.division = division / static_cast<double>(result.gates.size());
  if (!o.has_surfaces) return o;
  if (result.ef_percent) o.ef = *result.ef_percent, o.ef_error = o.ef - *phantom.ef_percent;
  if (result.edv_ml) o.edv_ratio = *result.edv_ml / *phantom.edv_ml;
  const Gate& first = result.gates.front();
  o.border_mm = std::max(mean_distance(first.endo->mesh, phantom.truth.front().endo),
                         mean_distance(first.epi->mesh, phantom.truth.front().epi));
  // The steepest place of a blurred wall lies off its border: up to a quarter of the width of the blur.
  o.allowed_mm = phantom.study.grid().spacing.norm() + 0.25 * phantom.fwhm_mm;
  return o;
}

void print_line(const Outcome& o) {
  const VirtualPatient& p = o.patient.options;
  std::printf(
      "%3d %s def=%-12s gut=%d rv=%.1f edv=%3.0f ef=%2.0f fwhm=%4.1f px=%.1f sl=%.1f g=%2d n=%3.0f | %s %s ef%+6.1f "
      "edv x%.2f axis %5.1f centre %5.1f across %4.1f base %5.1f div %4.1f border %4.1f/%4.1f | %s | %s\n",
      o.patient.number, o.patient.oblique ? "oblique" : "short  ", std::string(word_of(p.defect)).c_str(),
      o.patient.has_gut ? 1 : 0, p.right_ventricle, p.edv_ml, p.ef_percent, p.fwhm_mm, p.lattice.dx_mm, p.lattice.dz_mm,
      p.gates, p.noise.peak_counts, o.wrong() ? "WRONG" : "right", std::string(word_of(o.verdict)).c_str(), o.ef_error,
      o.edv_ratio, o.axis_deg, o.centre_mm, o.across_mm, o.base_mm, o.division, o.border_mm, o.allowed_mm,
      o.clues.c_str(), o.flags.c_str());
  std::fflush(stdout);
}

using Rows = std::vector<Outcome>;

double quantile(std::vector<double> v, double share) {
  if (v.empty()) return NAN;
  std::sort(v.begin(), v.end());
  return v[static_cast<std::size_t>(std::lround(share * static_cast<double>(v.size() - 1)))];
}

double share_of(const Rows& rows, const std::function<bool(const Outcome&)>& is) {
  return rows.empty() ? NAN
                      : 100.0 * static_cast<double>(std::count_if(rows.begin(), rows.end(), is)) /
                            static_cast<double>(rows.size());
}

Rows part_of(const Rows& rows, const std::function<bool(const Outcome&)>& is) {
  Rows part;
  std::copy_if(rows.begin(), rows.end(), std::back_inserter(part), is);
  return part;
}

void print_table(const char* title, const Rows& rows) {
  if (rows.empty()) return;
  const auto all = [&](double Outcome::*member) {
    std::vector<double> v;
    for (const Outcome& o : rows) v.push_back(o.*member);
    return v;
  };
  const Rows wrong = part_of(rows, [](const Outcome& o) { return o.wrong(); });
  const Rows right = part_of(rows, [](const Outcome& o) { return !o.wrong(); });
  const Rows known = part_of(rows, [](const Outcome& o) { return o.has_surfaces; });
  std::vector<double> ef, absolute;
  for (const Outcome& o : known) ef.push_back(o.ef_error), absolute.push_back(std::abs(o.ef_error));
  double mean = 0, square = 0;
  for (double e : ef) mean += e / static_cast<double>(ef.size());
  for (double e : ef) square += (e - mean) * (e - mean) / static_cast<double>(ef.size());
  const auto flagged = [](const Outcome& o) { return o.verdict != Verdict::ok; };
  std::printf("\n%s: %zu patients\n", title, rows.size());
  std::printf("  both surfaces in all gates        %5.1f %%\n", share_of(rows, [](auto& o) { return o.has_surfaces; }));
  std::printf("  wrong                             %5.1f %% (%zu)\n",
              100.0 * static_cast<double>(wrong.size()) / static_cast<double>(rows.size()), wrong.size());
  std::printf("  wrong ones flagged                %5.1f %%\n", share_of(wrong, flagged));
  std::printf("  right ones flagged                %5.1f %%\n", share_of(right, flagged));
  std::printf("  ejection fraction error, points   %+5.1f +- %.1f, 95 %% within %.1f\n", mean, std::sqrt(square),
              quantile(absolute, 0.95));
  const auto line = [&](const char* name, double Outcome::*member, double limit) {
    std::printf("  %-33s median %5.2f, 95 %% %6.2f, within %.0f: %5.1f %%\n", name, quantile(all(member), 0.5),
                quantile(all(member), 0.95), limit,
                share_of(rows, [&](const Outcome& o) { return o.*member <= limit; }));
  };
  line("long axis, degrees", &Outcome::axis_deg, 5);
  line("centre, mm", &Outcome::centre_mm, 3);
  line("centre across the axis, mm", &Outcome::across_mm, 3);
  line("valve plane, mm (mean of gates)", &Outcome::base_mm, 5);
  line("division slice, slices", &Outcome::division, 1);
  line("border at end-diastole, mm", &Outcome::border_mm, 5);
}

int run(int from, int to) {
  Rows rows;
  for (int n = from; n < to; ++n) {
    rows.push_back(examine(n));
    print_line(rows.back());
  }
  const auto half = [&](bool reporting) {
    return part_of(rows, [&](const Outcome& o) { return (o.patient.number >= 100) == reporting; });
  };
  print_table("Choosing half (0 to 99)", half(false));
  print_table("Reporting half (100 to 199)", half(true));
  print_table("  of it short axis", part_of(half(true), [](const Outcome& o) { return !o.patient.oblique; }));
  print_table("  of it transaxial or oblique", part_of(half(true), [](const Outcome& o) { return o.patient.oblique; }));
  print_table("  of it with a defect", part_of(half(true), [](const Outcome& o) { return o.patient.has_defect; }));
  print_table("  of it with gut", part_of(half(true), [](const Outcome& o) { return o.patient.has_gut; }));
  return 0;
}

}  // namespace
}  // namespace dynasurf

int main(int count, char** arguments) {
  const int from = count > 1 ? std::atoi(arguments[1]) : 0, to = count > 2 ? std::atoi(arguments[2]) : 200;
  return dynasurf::run(from, to);
}
