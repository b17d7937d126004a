#pragma once
#include <vector>

#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// A gate and its neighbours in the beat, of which it was made.
struct FilledGate {
  std::size_t gate, before, after;
};

/// Every missing gate becomes the mean of its nearest neighbours in the beat that are not missing, the nearer one with
/// more weight, so that neither the largest nor the smallest volume is its own. One gate at least must not be missing.
std::vector<FilledGate> fill_gates(std::vector<Image>& gates, const std::vector<bool>& missing);

}  // namespace dynasurf
