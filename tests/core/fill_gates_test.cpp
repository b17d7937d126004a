#include "dynasurf/core/detail/fill_gates.hpp"

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

std::vector<Image> gates_of(std::initializer_list<float> values) {
  Grid grid;
  grid.dims = {2, 1, 1};
  std::vector<Image> gates;
  for (const float value : values) gates.emplace_back(grid, value);
  return gates;
}

std::vector<float> firsts(const std::vector<Image>& gates) {
  std::vector<float> values;
  for (const Image& gate : gates) values.push_back(gate.values[0]);
  return values;
}

TEST(FillGates, LeavesAWholeBeatAlone) {
  std::vector<Image> gates = gates_of({1, 2, 3});
  EXPECT_TRUE(fill_gates(gates, {false, false, false}).empty());
  EXPECT_EQ(firsts(gates), (std::vector<float>{1, 2, 3}));
}

TEST(FillGates, WeighsTheNearerNeighbourMore) {
  std::vector<Image> gates = gates_of({0, 99, 99, 9});
  const std::vector<FilledGate> filled = fill_gates(gates, {false, true, true, false});
  EXPECT_EQ(firsts(gates), (std::vector<float>{0, 3, 6, 9}));
  ASSERT_EQ(filled.size(), 2u);
  EXPECT_EQ(filled[1].gate, 2u);
  EXPECT_EQ(filled[1].before, 0u);
  EXPECT_EQ(filled[1].after, 3u);
}

TEST(FillGates, GoesRoundTheEndOfTheBeat) {
  std::vector<Image> gates = gates_of({99, 4, 8});
  fill_gates(gates, {true, false, false});
  EXPECT_EQ(gates[0].values[0], 6);
  EXPECT_EQ(gates[0].values[1], 6);
}

TEST(FillGates, IsTheOnlyGateThatIsLeft) {
  std::vector<Image> gates = gates_of({99, 4, 99});
  fill_gates(gates, {true, false, true});
  EXPECT_EQ(firsts(gates), (std::vector<float>{4, 4, 4}));
}

}  // namespace
}  // namespace dynasurf
