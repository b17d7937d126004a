#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace dynasurf::experiments {

/// One parameter: what F1 is at each of its values, on both halves.
struct Curve {
  std::string name;
  std::vector<double> values, choosing, reporting;
  std::size_t usual = 0;  // index of the default
};

/// One small panel per parameter, all with the same scale of F1, as SVG.
void draw_curves(const std::vector<Curve>& curves, const std::filesystem::path& file);

}  // namespace dynasurf::experiments
