#pragma once
#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "dynasurf/report/normals.hpp"

namespace dynasurf::report {

/// One of two studies that are shown side by side.
struct ComparedStudy {
  nlohmann::ordered_json results;  // its results.json
  PolarTable polar;                // its polar.csv
  std::string report;              // where its own report lies, as an address; empty: not linked
  std::string splash_png;          // the bytes of its splash.png; empty: no slices are shown
};

/// The study of a folder that `dynasurf ventricle` wrote, without a link to its report. Throws InputError unless all is
/// there that is compared and shown, IoError.
ComparedStudy read_compared_study(const std::filesystem::path& folder);

/// The map of perfusion, rest less stress: positive where uptake is lost under stress.
ventricle::Measures difference_of(const ComparedStudy& rest, const ComparedStudy& stress);

/// comparison.json (schema dynasurf.comparison/1): ratios of volumes, ejection fractions, scores and what the segments
/// lost. Numbers are absent (null) where a study does not have them. The reading is the one that leads in both studies,
/// so that like is compared with like; else the edge's.
nlohmann::ordered_json comparison_json(const ComparedStudy& rest, const ComparedStudy& stress,
                                       const ventricle::Measures& difference);

/// Rest less stress of two polar maps: positive where something is lost under stress. Both are laid out by the frame of
/// their own heart, which is what registers them. Absent where either is.
ventricle::PolarValues lost_under_stress(const ventricle::PolarValues& rest, const ventricle::PolarValues& stress);

/// Rest and stress on one page, for the screen and for two A4 pages: the readings of both with their intervals, the
/// numbers of `comparison` (schema dynasurf.comparison/1), both volume curves, the slices of both, the polar maps with
/// their difference, the segments with their scores. Plain HTML without a script; nothing is loaded.
std::string comparison_html(const ComparedStudy& rest, const ComparedStudy& stress,
                            const nlohmann::ordered_json& comparison);

}  // namespace dynasurf::report
