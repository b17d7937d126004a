#pragma once
#include <cmath>
#include <vector>

#include "dynasurf/psf_fit/detail/activity.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

// A heart of simple shape for the tests of the fit's parts.

namespace dynasurf::psf_fit::test {

/// Numbers between -0.5 and 0.5.
inline std::vector<float> noise(std::size_t count, std::uint64_t seed) {
  std::vector<float> values;
  synthetic::Random random(seed, 1);
  for (std::size_t n = 0; n < count; ++n) values.push_back(static_cast<float>(random.uniform() - 0.5));
  return values;
}

inline double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (std::size_t n = 0; n < a.size(); ++n) sum += static_cast<double>(a[n]) * static_cast<double>(b[n]);
  return sum;
}

/// A round wall of inner radius 20 and outer radius 30 mm, cut 12 mm above its middle.
struct RoundHeart {
  HeartCells cells;
  GateLayout layout = make_gate_layout(3, 2, 2, 0);
  Eigen::VectorXd gate;
};
inline RoundHeart round_heart() {
  RoundHeart heart;
  CellLattice lattice;
  lattice.count = {36, 36, 36};
  lattice.step = {2, 2, 2};
  lattice.start = {-35, -35, -35};
  lattice.edge_mm = 1;
  HeartFrame frame;
  frame.scale = {25, 25, 25};
  Eigen::VectorXd outer = Eigen::VectorXd::Zero(1);
  outer[0] = std::log(30.0 / 25);
  heart.cells = select_cells(lattice, frame, 3, 30, outer, 0, 5);
  heart.gate = Eigen::VectorXd::Zero(heart.layout.count());
  heart.gate[heart.layout.endo] = std::log(20.0 / 25);
  heart.gate[heart.layout.wall] = std::log(std::pow(30.0 / 25, 3) - std::pow(20.0 / 25, 3));
  heart.gate[heart.layout.uptake] = 0;
  heart.gate[heart.layout.plane] = 12;
  heart.gate[heart.layout.cavity] = 0.1;
  heart.gate[heart.layout.background] = 0.05;
  return heart;
}

}  // namespace dynasurf::psf_fit::test
