#include "dynasurf/ventricle/measures/detail/reference.hpp"

#include <algorithm>

namespace dynasurf::ventricle {

std::vector<std::size_t> reference_samples(const PolarValues& values, bool is_uptake) {
  std::vector<std::size_t> order;
  for (std::size_t n = 0; n < values.size(); ++n)
    if (values[n]) order.push_back(n);
  if (order.empty()) return order;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return *values[a] > *values[b]; });
  const double from = is_uptake ? 0.15 : 0, to = is_uptake ? 0.35 : 0.05;
  const double count = order.size();
  const Index first = from * count, last = to * count;
  return {order.begin() + first, order.begin() + std::max(first + 1, last)};
}

}  // namespace dynasurf::ventricle
