#include "dynasurf/ventricle/labels/detail/division_slice.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/text_stream.hpp"

namespace dynasurf::ventricle {

std::vector<double> centre_profile(const Image& image, const Axis& axis) {
  std::vector<double> profile;
  for (int k = 0; k < image.grid.dims[2]; ++k) {
    const int ci = floor_int(axis.x_at(k) + 0.5), cj = floor_int(axis.y_at(k) + 0.5);
    double sum = 0;
    int count = 0;
    for (int j = cj - 1; j <= cj + 1; ++j)
      for (int i = ci - 1; i <= ci + 1; ++i)
        if (image.grid.contains(i, j, k)) sum += image(i, j, k), ++count;
    profile.push_back(count ? sum / count : 0);
  }
  return profile;
}

int find_division_slice(const std::vector<double>& profile, const std::vector<bool>& has_edges, const DivisionSlice& o,
                        Notes& notes) {
  const int top = std::ssize(profile) - 1;
  // A cavity is dark and the muscle of the apex bright: coming from the base, the centre brightens where the cavity
  // ends.
  const auto rise_into = [&](int k) { return profile[k] - profile[k + 1]; };
  const auto bright = [&](int k) { return profile[k] > o.floor; };

  for (int k = top - 1; k >= 0; --k)
    if (rise_into(k) > o.jump && bright(k)) return k;

  int best = -1;
  for (int k = top - 1; k >= 0; --k)
    if (bright(k) && rise_into(k) > 0 && (best < 0 || rise_into(k) > rise_into(best))) best = k;
  TextOutput text;
  if (best >= 0) {
    text << "The centre of the ventricle never brightens by more than " << o.jump
         << " from one slice to the next below; the largest rise (" << rise_into(best) << ", into slice " << best + 1
         << ") was taken as the end of the cavity.";
    notes.push_back({Severity::warning, "slice_find.fallback", text.str(), -1, best});
    return best;
  }

  const auto lowest = std::find(has_edges.begin(), has_edges.end(), true);
  if (lowest == has_edges.end()) {
    notes.push_back({Severity::warning, "slice_find.none", "No slice has edges, so no slice divides apex and cavity."});
    return -1;
  }
  best = lowest - has_edges.begin();
  text << "The centre of the ventricle is brighter than " << o.floor
       << " in no slice below a darker one (a defect of the apex looks so); the lowest slice with edges (" << best + 1
       << ") was taken as the end of the cavity.";
  notes.push_back({Severity::warning, "slice_find.no_rise", text.str(), -1, best});
  return best;
}

std::optional<WallTip> find_wall_tip(const std::vector<double>& profile, int lowest_with_cavity, double slice_mm,
                                     double bright) {
  constexpr double reach_mm = 40, cavity_mm = 20, least_prominence = 0.05;
  const int top = std::ssize(profile) - 1;
  if (lowest_with_cavity < 0 || lowest_with_cavity > top) return std::nullopt;
  const auto at = [&](int k) { return profile[k]; };
  const int first = std::max(0, lowest_with_cavity - ceil_int(reach_mm / slice_mm));

  int tip = -1;
  for (int k = std::min(top, lowest_with_cavity + 1); k >= first; --k) {
    const bool is_peak = (k == 0 || at(k) >= at(k - 1)) && (k == top || at(k) >= at(k + 1));
    const bool is_wall = is_peak && k <= lowest_with_cavity && at(k) >= bright;
    if (is_wall || (is_peak && (tip < 0 || at(k) > at(tip)))) tip = k;
    if (is_wall) break;
  }
  if (tip < 0) return std::nullopt;
  const int above = std::min(top, lowest_with_cavity + ceil_int(cavity_mm / slice_mm));
  const double cavity = *std::min_element(profile.begin() + tip, profile.begin() + above + 1);
  if (at(tip) - cavity < least_prominence) return std::nullopt;
  if (tip == 0 || tip == top) return WallTip{1.0 * tip, at(tip)};

  const double curvature = at(tip - 1) - 2 * at(tip) + at(tip + 1);
  // The vertex of the parabola through the peak and its neighbours.
  const double vertex = curvature < 0 ? 0.5 * (at(tip - 1) - at(tip + 1)) / curvature : 0;
  return WallTip{tip + std::clamp(vertex, -0.5, 0.5), at(tip)};
}

namespace {

struct Row {
  int moves = 0;  // slices the division slice moves up
  bool verified = false;
  Severity severity = Severity::warning;
  const char* meaning = "";
};

/// Table 2.1; case 3 with two borders in A+1 is row 0.
constexpr std::array<Row, 9> table{{
    {0, true, Severity::info, "the slice two above misses a border that its neighbours have"},
    {0, false, Severity::warning, "an apex of four slices or more without a cavity is unlikely"},
    {0, false, Severity::warning, "a cavity cannot begin below slices without one"},
    {0, false, Severity::warning, "one of the two slices above is wrong, and the slice above them does not tell which"},
    {0, false, Severity::warning, "a cavity cannot end below the division slice and be missing two slices above it"},
    {1, true, Severity::info, "the slice above has no cavity either, so it divides"},
    {0, false, Severity::warning, "a cavity cannot be missing in one slice between two that have it"},
    {0, true, Severity::info, ""},
    {0, false, Severity::warning, "the division slice has two borders itself"},
}};

}  // namespace

RefinedDivision refine_division_slice(int c, int slices, const std::function<int(int)>& borders, Notes& notes) {
  const auto seen = [&](int k) { return k >= 0 && k < slices ? borders(k) : 0; };
  const int n_c = seen(c), n_b = seen(c + 1), n_a = seen(c + 2);
  TextOutput text;
  text << "Borders seen from slice " << c + 3 << " down to the division slice " << c + 1 << ": " << n_a << ", " << n_b
       << ", " << n_c;
  if (c < 0 || std::min({n_a, n_b, n_c}) < 1) {
    text << "; the table needs three slices with borders, so the division slice was kept.";
    notes.push_back({Severity::warning, "slice_refine.not_in_table", text.str(), -1, c});
    return {c, 0, false};
  }

  // The rows of table 2.1 count in binary: one border is 0, two are 1, from A down to C.
  const int number = 1 + 4 * (n_a > 1) + 2 * (n_b > 1) + (n_c > 1);
  const bool a_was_misjudged = number == 3 && seen(c + 3) > 1;
  const Row& row = table[a_was_misjudged ? 0 : number];
  if (number != 7) {
    text << ": " << row.meaning << (row.moves ? "; the division slice moved up by one." : "; it was kept.");
    notes.push_back({row.severity, "slice_refine.case_" + std::to_string(number), text.str(), -1, c});
  }
  return {c + row.moves, number, row.verified};
}

}  // namespace dynasurf::ventricle
