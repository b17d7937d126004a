#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

#include "dynasurf/ventricle/measures/measures.hpp"

namespace dynasurf::report {

/// The key `measures` of results.json: everything but the maps. Null when absent.
nlohmann::ordered_json measures_json(const std::optional<ventricle::Measures>& measures, double cycle_ms);

/// One kind of polar map: how it is called in files, what it shows, and where its colours end.
struct PolarKind {
  std::string_view name, title, unit;
  ventricle::PolarValues ventricle::PolarMaps::*values;
  std::optional<double> low, high;  // absent: the smallest and the largest value of the segments
  bool is_cyclic = false;           // an angle: colours close
  bool is_difference = false;       // colours run both ways from a pale middle
};
/// All kinds, in the order of the report.
std::span<const PolarKind> polar_kinds();

/// segments.csv: a line of names, then one line per segment.
std::string segments_csv(const ventricle::Measures& measures);
/// polar.csv: one line per sample from the apex, ring by ring: ring, sector, rho, angle_deg, segment, area_mm2, then
/// the maps by their names.
std::string polar_csv(const ventricle::Measures& measures);
/// curve.csv: 64 instants of the beat: phase (of the beat), volume_ml and rate (EDV per beat) of the periodic fit.
std::string curve_csv(const ventricle::VolumeCurveFit& function);

/// A polar map as a picture: samples as coloured cells, borders of the segments, their means, a scale. Anterior wall
/// on top, septum left, apex in the middle. Plain SVG 1.1; nothing is loaded.
std::string polar_svg(const ventricle::Measures& measures, const PolarKind& kind);
/// Histograms of the phases of counts and of motion, one above the other. Empty when there is neither.
std::string phase_histogram_svg(const ventricle::Measures& measures);

}  // namespace dynasurf::report
