#pragma once
#include <string>
#include <vector>

#include "dynasurf/core/grid.hpp"

namespace dynasurf {

/// Points of the heart's muscle that were followed over the beat, as tags or markers show them (FUT-TAGGED). World
/// frame (LPS), mm. Every point is known in every gate.
struct TrackedPoints {
  std::vector<std::string> name;         // per point
  std::vector<std::vector<Vec3>> gates;  // [gate][point]
};

}  // namespace dynasurf
