#include "dynasurf/ventricle/quality.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {
namespace {

// Limits of what is believed without a second look. The wall of edge-derived surfaces beats by the blur alone
// (a coefficient of variation near 0.1 at 13 mm); the other numbers bound what a living heart can have.
constexpr double least_arrived = 0.95;  // particles within a voxel of their border
constexpr double most_wall_variation = 0.20;
constexpr double least_ef = 5, most_ef = 85;
constexpr double least_edv_ml = 15, most_edv_ml = 600;

template <class... A>
std::string format(const char* pattern, A... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), pattern, values...);
  return text.data();
}

std::string gate_list(const std::vector<int>& gates) {
  std::string text = gates.size() == 1 ? "gate " : "gates ";
  for (std::size_t n = 0; n < gates.size(); ++n) text += (n ? ", " : "") + std::to_string(gates[n] + 1);
  return text;
}

/// Gates of which `says_so` holds become one flag.
template <class Predicate>
void flag_gates(const VentricleResult& result, std::vector<Flag>& flags, std::string code, Severity severity,
                const std::string& what, Predicate says_so) {
  std::vector<int> gates;
  for (const Gate& gate : result.gates)
    if (says_so(gate)) gates.push_back(gate.gate);
  if (!gates.empty())
    flags.push_back({std::move(code), severity, what + " in " + gate_list(gates), static_cast<double>(gates.size())});
}

void flag_surfaces(const VentricleResult& result, std::vector<Flag>& flags) {
  for (const Wall wall : {Wall::endo, Wall::epi}) {
    const auto surface = [wall](const Gate& g) -> const std::optional<Surface>& {
      return wall == Wall::endo ? g.endo : g.epi;
    };
    const std::string name(name_of(wall));
    flag_gates(result, flags, "surface_missing", Severity::failure, "no " + name + "cardial border was found",
               [&](const Gate& g) { return !surface(g); });
    flag_gates(result, flags, "surface_diverged", Severity::failure, "the " + name + "cardial surface diverged",
               [&](const Gate& g) { return surface(g) && surface(g)->stop_reason == StopReason::diverged; });
    flag_gates(result, flags, "surface_incomplete", Severity::warning,
               format("fewer than %.0f %% of the ", 100 * least_arrived) + name +
                   "cardial surface lie within a voxel of its border",
               [&](const Gate& g) { return surface(g) && surface(g)->within_one_voxel < least_arrived; });
  }
  flag_gates(result, flags, "surface_invalid", Severity::warning,
             "a surface is not closed, manifold, oriented and free of self-intersections", [](const Gate& g) {
               return (g.endo && !g.endo->repair.check.valid()) || (g.epi && !g.epi->repair.check.valid());
             });
  flag_gates(result, flags, "walls_cross", Severity::failure,
             "the endocardial volume is not smaller than the epicardial one",
             [](const Gate& g) { return g.wall_ml && *g.wall_ml <= 0; });
}

void flag_numbers(const VentricleResult& result, std::vector<Flag>& flags) {
  if (result.wall_variation && *result.wall_variation > most_wall_variation)
    flags.push_back(
        {"wall_volume_varies", Severity::warning,
         format("the wall's volume varies by %.0f %% over the beat (coefficient of variation); muscle keeps its volume",
                100 * *result.wall_variation),
         *result.wall_variation});
  if (result.ef_percent && (*result.ef_percent < least_ef || *result.ef_percent > most_ef))
    flags.push_back(
        {"ejection_fraction_implausible", Severity::warning,
         format("an ejection fraction of %.1f %% is outside %.0f-%.0f %%", *result.ef_percent, least_ef, most_ef),
         *result.ef_percent});
  if (result.edv_ml && (*result.edv_ml < least_edv_ml || *result.edv_ml > most_edv_ml))
    flags.push_back({"volume_implausible", Severity::warning,
                     format("an end-diastolic volume of %.1f mL is outside %.0f-%.0f mL", *result.edv_ml, least_edv_ml,
                            most_edv_ml),
                     *result.edv_ml});
}

/// "surface_missing" says these already.
bool is_told_by_a_surface(const Note& note) { return note.code == "labels.no_endo" || note.code == "labels.no_epi"; }

/// One flag per code of the stages' warnings, with how often it came.
void flag_notes(const VentricleResult& result, std::vector<Flag>& flags) {
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
    flags.push_back(
        {code, failure ? Severity::failure : Severity::warning, message, static_cast<double>(notes.size())});
  }
}

}  // namespace

std::span<const std::string_view> names_of(Verdict) {
  static constexpr std::array<std::string_view, 3> names{"ok", "check", "fail"};
  return names;
}

std::vector<Flag> judge(const VentricleResult& result) {
  std::vector<Flag> flags;
  flag_surfaces(result, flags);
  flag_numbers(result, flags);
  flag_notes(result, flags);
  return flags;
}

Verdict verdict_of(std::span<const Flag> flags) {
  Verdict verdict = Verdict::ok;
  for (const Flag& flag : flags) {
    if (flag.severity == Severity::failure) return Verdict::fail;
    if (flag.severity == Severity::warning) verdict = Verdict::check;
  }
  return verdict;
}

}  // namespace dynasurf
