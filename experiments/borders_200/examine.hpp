#pragma once
#include <cmath>
#include <string>
#include <string_view>

#include "dynasurf/ventricle/detail/quality_metrics.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "patients.hpp"

namespace dynasurf {

/// How a study came out, against its truth.
struct Outcome {
  Patient patient;
  std::string kind;      // what was planted, empty for the patients of the series
  bool is_heart = true;  // there is a ventricle to be found
  bool has_surfaces = false;
  double ef_error = 99, axis_deg = 180, centre_mm = 999, across_mm = 999, base_mm = 999, division = 99;
  double border_mm = 999, allowed_mm = 0, edv_ratio = 0;
  ventricle::Verdict verdict = ventricle::Verdict::fail;
  double least_edv_ratio = 0.35, ef_90 = 0;  // half of the fit's interval of the ejection fraction
  std::string flags, clues;

  /// A surface is missing, the ejection fraction off by more than 8 points, a border or the volume by more than what
  /// blur explains (of a fit through the blur: by a quarter), or it is another structure.
  bool wrong() const {
    return !is_heart || !has_surfaces || std::abs(ef_error) > 8 || border_mm > allowed_mm || centre_mm > 20 ||
           edv_ratio > 1.25 || edv_ratio < least_edv_ratio;
  }
  bool flagged() const { return verdict != ventricle::Verdict::ok; }
};

/// Runs the whole pipeline on a study with a preset and compares. `phantom.truth` has one entry per gate. Where there
/// is a fit through the blur, volumes, ejection fraction and borders are the fit's.
Outcome examine(const Patient& patient, const synthetic::Phantom& phantom, std::string_view preset,
                bool is_heart = true);

}  // namespace dynasurf
