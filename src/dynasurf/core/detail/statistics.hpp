#pragma once
#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace dynasurf {

/// The value at `rank`, from 0, in ascending order, in linear time on average; T() where there are not so many.
template <class T>
T of_rank(std::vector<T> values, std::size_t rank) {
  if (rank >= values.size()) return T();
  const auto at = values.begin() + rank;
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The quantile of a share, 0 to 1: of n values the one at rank share (n - 1), rounded down. T() for no values.
template <class T>
T quantile(std::vector<T> values, double share) {
  if (values.empty()) return T();
  const std::size_t rank = share * (values.size() - 1);
  return of_rank(std::move(values), rank);
}

/// The middle value, or the mean of the two middle ones, so that mirrored values have the mirrored median. 0 for no
/// values.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

/// The middle value, of an even number the upper one; T() for no values.
template <class T>
T upper_median(std::vector<T> values) {
  const std::size_t middle = values.size() / 2;
  return of_rank(std::move(values), middle);
}

}  // namespace dynasurf
