#include "dynasurf/ventricle/detail/quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "dynasurf/core/detail/format.hpp"
#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/ventricle/detail/quality_metrics.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::ventricle {
namespace {

// Limits of what is believed without a second look. The wall of edge-derived surfaces beats by the blur alone
// (a coefficient of variation near 0.1 at 13 mm); the other numbers bound what a living heart can have.
constexpr double least_arrived = 0.95;  // particles within a voxel of their border
constexpr double least_reached = 0.95;  // of a border; good surfaces reach 0.985 and more, those grown from inside 0.6
constexpr double most_wall_variation = 0.20;
constexpr double least_ef = 5, most_ef = 85;
constexpr double least_edv_ml = 15, most_edv_ml = 600;
constexpr double impossible_ef = 95, impossible_small_ml = 5, impossible_large_ml = 1000;

// Limits of where the heart was found and of the cycle. Set by judgement; experiments/borders_200 shows what they do.
constexpr double most_other_end = 0.97;
constexpr double least_base_seen = 0.45, most_base_spread_mm = 4, most_base_cut = 0.3;
// Beside a fit, whose valve plane and beat are its own, edges may scatter more: behind a camera those of right results
// had 4.9 mm and 0.16, gates in the wrong order 0.25.
constexpr double most_base_spread_fitted_mm = 6, most_roughness_fitted = 0.2;
constexpr double most_outside = 0.05;                             // of the wall
constexpr double least_elongation = 1.15, most_elongation = 2.6;  // of the ellipsoid of the wall
constexpr double most_length_to_width = 1.7;                      // of the outer surface, which ends at the valve
constexpr double most_readings_apart = 20;
constexpr double most_bridged = 0.06;  // of the largest cavity
// Half of a 90 % interval. Readings off by more count as wrong (experiments/camera), so wider ones may be.
constexpr double most_ef_90 = 8, most_edv_90 = 15;  // points, %
constexpr double believed_edv = 7;                  // % of an interval that holds what is believed of the wall
constexpr double most_hot_neighbour = 0.25;
constexpr double most_unround = 0.13;
constexpr double most_noise = 0.2;
// Of 59 studies behind a camera the counts of none moved by more than 2.3 mm; half of the gates 12.8 mm aside moved
// them by 5 mm or more.
constexpr double most_counts_move_mm = 3.5, most_surface_move_mm = 5;
constexpr double least_thickness_mm = 8, most_thickness_mm = 18, most_fitted_thickness_mm = 12;
constexpr double least_end_systole = 0.2, most_end_systole = 0.65;
constexpr double most_roughness = 0.12;
constexpr double least_counts = 0.85, most_counts = 1.15;  // of the usual gate
constexpr double most_missing_slices = 2.5;                // per gate
// Of a surface's middle from the heart's; edges that lose the apex end short of it by a part of the heart's length.
constexpr double most_beside_mm = 8, most_along = 0.4;  // along: of half the length

std::string gate_list(const std::vector<int>& gates) {
  std::string text = gates.size() == 1 ? "gate " : "gates ";
  for (std::size_t n = 0; n < gates.size(); ++n) text += (n ? ", " : "") + std::to_string(gates[n] + 1);
  return text;
}

/// Gates of which `says_so` holds become one flag.
template <class Predicate>
void flag_gates(const Result& result, std::vector<QualityFlag>& flags, std::string code, Severity severity,
                const std::string& what, Predicate says_so) {
  std::vector<int> gates;
  for (const Gate& gate : result.gates)
    if (says_so(gate)) gates.push_back(gate.gate);
  if (!gates.empty())
    flags.push_back({std::move(code), severity, what + " in " + gate_list(gates), 1.0 * gates.size()});
}

/// What blur or a defect does to edges does not make a fit through the blur doubtful: its error bar knows of unseen
/// wall, and is judged by itself. It is listed without changing the verdict.
Severity doubt_of_edges(const Result& result) {
  const auto& ef = result.leading.ef_percent;
  return ef && ef->has_interval() ? Severity::info : Severity::warning;
}

/// The same of a number that no fit makes up for above a second limit.
Severity doubt_of_edges(const Result& result, double value, double most_beside_a_fit) {
  return value > most_beside_a_fit ? Severity::warning : doubt_of_edges(result);
}

/// Without both surfaces in all gates edges measure nothing. The fit needs none, but its intervals were learned where
/// all were there.
Severity failure_of_edges(const Result& result) {
  return result.readings.psf_corrected ? Severity::warning : Severity::failure;
}

bool is_blood_pool(const Result& result) {
  return !result.gates.empty() && result.gates.front().labels.bright == ImageContrast::cavity;
}

void flag_surfaces(const Result& result, std::vector<QualityFlag>& flags) {
  for (const Border wall : {Border::endo, Border::epi}) {
    if (wall == Border::epi && is_blood_pool(result)) continue;
    const auto surface = [wall](const Gate& g) -> const std::optional<Surface>& { return g.edge_surfaces.of(wall); };
    const std::string name(name_of(wall));
    flag_gates(result, flags, "surface_missing", failure_of_edges(result), "no " + name + "cardial border was found",
               [&](const Gate& g) { return !surface(g); });
    flag_gates(result, flags, "surface_diverged", failure_of_edges(result), "the " + name + "cardial surface diverged",
               [&](const Gate& g) { return surface(g) && surface(g)->stop_reason == dynamics::StopReason::diverged; });
    flag_gates(result, flags, "surface_incomplete", doubt_of_edges(result),
               format("fewer than %.0f %% of the ", 100 * least_arrived) + name +
                   "cardial surface lie within a voxel of its border",
               [&](const Gate& g) { return surface(g) && surface(g)->within_one_voxel < least_arrived; });
    flag_gates(result, flags, "border_unreached", doubt_of_edges(result),
               format("the surface stays away from more than %.0f %% of the ", 100 * (1 - least_reached)) + name +
                   "cardial border, so its volume is not that of the border",
               [&](const Gate& g) { return surface(g) && surface(g)->border_reached < least_reached; });
  }
  flag_gates(result, flags, "surface_invalid", Severity::warning,
             "a surface is not closed, manifold, oriented and free of self-intersections", [](const Gate& g) {
               const EdgeSurfaces& s = g.edge_surfaces;
               return (s.endo && !s.endo->repair.check.valid()) || (s.epi && !s.epi->repair.check.valid());
             });
  flag_gates(result, flags, "walls_cross", failure_of_edges(result),
             "the endocardial volume is not smaller than the epicardial one",
             [](const Gate& g) { return g.edge_surfaces.wall_ml && *g.edge_surfaces.wall_ml <= 0; });
}

void flag_numbers(const Result& result, const QualityMetrics& clues, std::vector<QualityFlag>& flags) {
  if (result.wall_variation && *result.wall_variation > most_wall_variation)
    flags.push_back(
        {"wall_volume_varies", doubt_of_edges(result),
         format("the wall's volume varies by %.0f %% over the beat (coefficient of variation); muscle keeps its volume",
                100 * *result.wall_variation),
         *result.wall_variation});
  const auto severity = [](bool is_impossible) { return is_impossible ? Severity::failure : Severity::warning; };
  const auto &ef = result.leading.ef_percent, &edv = result.leading.edv_ml;
  if (ef && (ef->value < least_ef || ef->value > most_ef))
    flags.push_back({"ejection_fraction_implausible", severity(ef->value > impossible_ef),
                     format("an ejection fraction of %.1f %% is outside %.0f-%.0f %%", ef->value, least_ef, most_ef),
                     ef->value});
  if (clues.readings_apart > most_readings_apart)
    flags.push_back(
        {"readings_disagree", doubt_of_edges(result),
         format("the Gaussian-profile reading has an ejection fraction %.0f points away: the cavity is too small for "
                "the blur, or a part of the wall is not seen",
                clues.readings_apart),
         clues.readings_apart});
  if (edv && (edv->value < least_edv_ml || edv->value > most_edv_ml))
    flags.push_back(
        {"volume_implausible",
         severity(edv->value < impossible_small_ml || edv->value > impossible_large_ml || is_blood_pool(result)),
         format("an end-diastolic volume of %.1f mL is outside %.0f-%.0f mL", edv->value, least_edv_ml, most_edv_ml),
         edv->value});
}

double half_interval(const heart::Estimate& e) { return (e.high() - e.low()) / 2; }

/// Half of its 90 % interval, in %; 0 where it has none.
double edv_uncertainty(const Result& result) {
  const auto& edv = result.leading.edv_ml;
  return edv && edv->has_interval() ? 100 * half_interval(*edv) / edv->value : 0;
}

/// Intervals too wide to tell a right reading from a wrong one.
void flag_intervals(const Result& result, std::vector<QualityFlag>& flags) {
  const auto& ef = result.leading.ef_percent;
  if (ef && ef->has_interval() && half_interval(*ef) > most_ef_90)
    flags.push_back(
        {"ef_uncertain", Severity::warning,
         format("the ejection fraction may be off by %.0f points (half of its 90 %% interval)", half_interval(*ef)),
         half_interval(*ef)});
  if (const double off = edv_uncertainty(result); off > most_edv_90)
    flags.push_back({"edv_uncertain", Severity::warning,
                     format("the end-diastolic volume may be off by %.0f %% (half of its 90 %% interval)", off), off});
}

/// "surface_missing" says these already.
bool is_told_by_a_surface(const Note& note) { return note.code == "labels.no_endo" || note.code == "labels.no_epi"; }

bool lies_off(const TriMesh& outer, const heart::LvShell& cup) {
  if (outer.vertices.empty()) return false;
  const Vec3 off = mean_point(outer.vertices) - cup.middle();
  const double along = off.dot(cup.axis);
  return std::abs(along) > most_along * cup.half_length_mm || (off - along * cup.axis).norm() > most_beside_mm;
}

/// Where the heart was found, and whether the surfaces are there.
void flag_place(const Result& result, std::vector<QualityFlag>& flags) {
  if (is_blood_pool(result)) {
    flags.push_back({"blood_pool", Severity::warning,
                     "the cavity is bright and no wall is seen: taken for an image of the blood pool, with the inner "
                     "border alone; the slices must be short-axis ones, and what else is bright (right ventricle, "
                     "atria) may have been taken in",
                     1});
    return;
  }
  if (!result.heart) {
    flags.push_back({"heart_not_found", Severity::warning,
                     "nothing in the volume looks like a ventricle by its shape; the borders may be of something else",
                     1});
    return;
  }
  const heart::Location& heart = *result.heart;
  if (!heart.is_clear())
    flags.push_back({"heart_uncertain", Severity::warning,
                     format("the wall is hard to see: contrast %.2f, seen in %.0f %% of the directions", heart.contrast,
                            100 * heart.ridge_share),
                     heart.contrast});
  if (heart.other_end > most_other_end)
    flags.push_back({"ends_uncertain", Severity::warning,
                     format("apex and base are hard to tell apart: exchanged they explain the image %.2f times as well",
                            heart.other_end),
                     heart.other_end});
  const std::string where =
      format("lies more than %.0f mm beside or %.0f mm along the axis from where the heart was found", most_beside_mm,
             most_along * heart.cup.half_length_mm);
  flag_gates(result, flags, "surface_off_heart", doubt_of_edges(result), "a surface " + where, [&](const Gate& gate) {
    return gate.edge_surfaces.epi && lies_off(gate.edge_surfaces.epi->mesh, heart.cup);
  });
  const auto& fit = result.readings.psf_corrected;
  if (fit && std::any_of(fit->gates.begin(), fit->gates.end(),
                         [&](const auto& gate) { return lies_off(gate.epi, heart.cup); }))
    flags.push_back({"surface_off_heart", Severity::warning, "the fitted surface " + where, 1});
}

/// A number outside what right results have.
struct Limit {
  const char* code;
  double value, least, most;
  const char* message;  // with the value
  double factor = 1;    // of the value in the message
  Severity severity = Severity::warning;
};

void flag_limits(std::span<const Limit> limits, std::vector<QualityFlag>& flags) {
  for (const Limit& l : limits)
    if (l.value < l.least || l.value > l.most)
      flags.push_back({l.code, l.severity, format(l.message, l.factor * l.value), l.value});
}

void flag_base(const Result& result, const QualityMetrics& c, std::vector<QualityFlag>& flags) {
  const bool is_unseen = c.base_seen < least_base_seen;
  if (is_unseen || c.base_spread_mm > most_base_spread_mm)
    flags.push_back(
        {"base_uncertain",
         is_unseen ? Severity::warning : doubt_of_edges(result, c.base_spread_mm, most_base_spread_fitted_mm),
         format("the end of the wall was seen in %.0f %% of the directions, %.1f mm from a plane", 100 * c.base_seen,
                c.base_spread_mm),
         c.base_seen});
  const std::array limits{Limit{"base_cut_off", c.base_cut, 0, most_base_cut,
                                "the volume ends before the wall does in %.0f %% of the directions", 100}};
  flag_limits(limits, flags);
}

/// Edges behind a wide point spread lie far apart around any wall: no doubt where the fit finds a usual one between
/// them. A wall that is thick to both, or too thin for edges, comes of a wrong size of the voxels.
Severity doubt_of_thickness(const Result& result, const QualityMetrics& c) {
  const auto& fit = result.readings.psf_corrected;
  const bool is_blur = c.thickness_mm > most_thickness_mm && fit && fit->thickness_mm.value < most_fitted_thickness_mm;
  return is_blur ? doubt_of_edges(result) : Severity::warning;
}

/// What lies around the heart and what the heart looks like.
void flag_looks(const Result& result, const QualityMetrics& c, std::vector<QualityFlag>& flags) {
  if (!result.heart) return;
  const heart::LvShell& cup = result.heart->cup;
  const std::array limits{
      Limit{"heart_cut_off", result.heart->outside, 0, most_outside, "%.0f %% of the wall lie outside the volume", 100},
      Limit{"shape_implausible", cup.half_length_mm / cup.radius_mm, least_elongation, most_elongation,
            "the heart is %.1f times as long as wide; hearts are not, so the spacing of the slices may be wrong"},
      Limit{"shape_implausible", c.length_to_width, 0, most_length_to_width,
            "the outer surface is %.1f times as long as wide; hearts are not, so the spacing of the slices may be "
            "wrong"},
      Limit{"wall_missing", c.bridged, 0, most_bridged,
            "so much of the wall is not seen that bridging it leaves %.0f %% of the cavity's volume uncertain", 100,
            doubt_of_edges(result)},
      Limit{"hot_neighbour", c.hot_neighbour, 0, most_hot_neighbour,
            "something as hot as the wall touches it in %.0f %% of the directions", 100},
      Limit{"noisy", c.noise, 0, most_noise, "noise is %.0f %% of the wall's brightness", 100, doubt_of_edges(result)},
      Limit{"section_not_round", c.unround, 0, most_unround,
            "the outer border is not round: its radius varies by %.0f %%", 100, doubt_of_edges(result)},
      Limit{"thickness_implausible", c.thickness_mm, least_thickness_mm, most_thickness_mm,
            "the wall seems %.1f mm thick; no camera and heart make it so, the size of the voxels may be wrong", 1,
            doubt_of_thickness(result, c)}};
  flag_limits(limits, flags);
}

/// Gates against each other.
void flag_cycle(const Result& result, const QualityMetrics& c, std::vector<QualityFlag>& flags) {
  const std::array limits{
      Limit{"counts_uneven", c.least_counts, least_counts, 1e9,
            "a gate has only %.0f %% of the counts of the others; its beats may have been cut short", 100},
      Limit{"counts_uneven", c.most_counts, 0, most_counts, "a gate has %.0f %% of the counts of the others", 100},
      Limit{"heart_moves", c.counts_move_mm, 0, most_counts_move_mm,
            "the middle of a gate's counts lies %.1f mm from that of the others; the patient may have moved"},
      Limit{"heart_moves", c.surface_moves_mm, 0, most_surface_move_mm,
            "a gate lies %.1f mm from where the beat would have it; the patient may have moved", 1,
            doubt_of_edges(result)},
      Limit{"end_systole_implausible", c.end_systole, least_end_systole, most_end_systole,
            "the heart is smallest after %.0f %% of the beat; the gates may be out of order", 100},
      Limit{"curve_rough", c.endo_roughness, 0, most_roughness,
            "the cavity's volume jumps by %.0f %% from its smooth course over the beat", 100,
            doubt_of_edges(result, c.endo_roughness, most_roughness_fitted)}};
  flag_limits(limits, flags);
}

void flag_missing_slices(const Result& result, std::vector<QualityFlag>& flags) {
  if (result.gates.empty()) return;
  for (const Border wall : {Border::endo, Border::epi}) {
    const std::string code = "labels." + std::string(name_of(wall)) + "_missing";
    const double missing =
        std::count_if(result.notes.begin(), result.notes.end(), [&](const Note& n) { return n.code == code; });
    const double per_gate = missing / result.gates.size();
    if (per_gate > most_missing_slices)
      flags.push_back({"border_missing", Severity::warning,
                       "the " + std::string(name_of(wall)) +
                           format("cardial border is missing in %.1f slices of a gate, in the mean", per_gate),
                       per_gate});
  }
}

/// Warnings of the labelling that alone do not make a result doubtful: where the cavity ends is uncertain by a slice or
/// two in half of all right results, and a slice without a border is bridged. They are listed without changing the
/// verdict; what they lead to is judged by its numbers.
bool is_remark(const std::string& code) {
  return code.starts_with("slice_find.") || code.starts_with("slice_refine.") || code == "labels.endo_missing" ||
         code == "labels.epi_missing";
}

/// One flag per code of the stages' warnings, with how often it came.
void flag_notes(const Result& result, std::vector<QualityFlag>& flags) {
  std::vector<std::string> order;
  std::map<std::string, std::vector<const Note*>> by_code;
  for (const Note& note : result.notes)
    if (note.severity != Severity::info && !is_told_by_a_surface(note)) {
      if (by_code[note.code].empty()) order.push_back(note.code);
      by_code[note.code].push_back(&note);
    }
  for (const std::string& code : order) {
    const auto& notes = by_code[code];
    std::vector<int> gates;
    for (const Note* note : notes)
      if (note->gate >= 0 && (gates.empty() || gates.back() != note->gate)) gates.push_back(note->gate);
    const bool failure =
        std::any_of(notes.begin(), notes.end(), [](const Note* n) { return n->severity == Severity::failure; });
    std::string message = notes.front()->message;
    if (!gates.empty()) message += " (" + gate_list(gates) + ")";
    // What an interval holds needs no second doubt.
    const bool is_believed = code == "fit.thin_wall" || code == "fit.thickness_believed";
    const bool is_held = is_believed && edv_uncertainty(result) > believed_edv;
    const Severity severity = failure                         ? Severity::failure
                              : is_remark(code) || is_held    ? Severity::info
                              : code == "labels.gate_follows" ? doubt_of_edges(result)
                                                              : Severity::warning;
    flags.push_back({code, severity, message, 1.0 * notes.size()});
  }
}

}  // namespace

std::span<const std::string_view> names_of(Verdict) {
  static constexpr std::array<std::string_view, 3> names{"ok", "check", "fail"};
  return names;
}

std::vector<QualityFlag> assess(const Result& result) {
  std::vector<QualityFlag> flags;
  flag_surfaces(result, flags);
  flag_place(result, flags);
  const QualityMetrics clues = quality_metrics(result);
  flag_looks(result, clues, flags);
  flag_base(result, clues, flags);
  flag_cycle(result, clues, flags);
  flag_missing_slices(result, flags);
  flag_numbers(result, clues, flags);
  flag_intervals(result, flags);
  flag_notes(result, flags);
  // What decides the verdict comes first.
  std::stable_sort(flags.begin(), flags.end(),
                   [](const QualityFlag& a, const QualityFlag& b) { return a.severity > b.severity; });
  return flags;
}

Verdict verdict_of(std::span<const QualityFlag> flags) {
  Verdict verdict = Verdict::ok;
  for (const QualityFlag& flag : flags) {
    if (flag.severity == Severity::failure) return Verdict::fail;
    if (flag.severity == Severity::warning) verdict = Verdict::check;
  }
  return verdict;
}

}  // namespace dynasurf::ventricle
