#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include "dynasurf/core/note.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/ventricle/measures/tracked_motion.hpp"

namespace dynasurf::report {

/// What tracked points say of a beat, and where it comes from.
struct MotionRun {
  ventricle::TrackedMotion motion;
  ventricle::LongAxis axis;
  int points = 0;
  std::vector<double> cavity_ml, outer_ml;  // of surfaces moved along with the points, per gate; empty without any
  Notes notes;
};

/// results.json of `dynasurf motion`, schema dynasurf.motion/1 (docs/file-formats.md). Gates count from 1.
nlohmann::ordered_json motion_json(const MotionRun& run, const Provenance& provenance);

/// Rotation of the three levels and twist over the beat, and the strains beside them.
std::string motion_svg(const ventricle::TrackedMotion& motion);

}  // namespace dynasurf::report
