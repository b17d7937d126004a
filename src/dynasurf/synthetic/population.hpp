#pragma once
#include <cstdint>
#include <string_view>

#include "dynasurf/synthetic/options.hpp"

namespace dynasurf::synthetic {

/// One study of a made-up clinic: who was imaged, where, and what the phantom is made from.
struct DrawnPatient {
  VirtualPatient options;
  std::string_view sex;   // "F" or "M"
  int age_years = 0;      // 35 to 90
  std::string_view site;  // "A" or "B"; their cameras blur by about 11 and 13 mm
};

/// Draws the patient of this number, counted from 0: ejection fraction, volumes, muscle, a perfusion defect in two of
/// five, gut beside the heart in one of five, pose, uneven walls, camera, counts. Each depends on `seed` and `number`
/// alone, so that any part of a population can be made anew, in any order. The distributions are plausible for a clinic
/// and chosen by hand: they are taken from no registry. `repeat` is another acquisition of the same heart: the pose of
/// the stack and the noise differ.
DrawnPatient draw_patient(std::uint64_t seed, std::uint64_t number, int repeat = 0);

/// Voxels of which a study takes about a third of the time of a usual one: 40 x 40 x 20 of 4.5 x 4.5 x 6 mm.
Lattice small_lattice();

}  // namespace dynasurf::synthetic
