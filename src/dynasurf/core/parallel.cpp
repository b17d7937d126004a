#include "dynasurf/core/parallel.hpp"

#include <algorithm>
#include <vector>

#include "dynasurf/core/detail/run_pieces.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf {

void parallel_for(std::size_t count, std::size_t grain, const std::function<void(std::size_t, std::size_t)>& body) {
  DYNASURF_ASSERT(grain > 0);
  const std::size_t pieces = (count + grain - 1) / grain;
  if (pieces <= 1) {
    if (count > 0) body(0, count);
    return;
  }
  detail::run_noted_pieces(pieces, [&](std::size_t p) { body(p * grain, std::min(count, (p + 1) * grain)); });
}

namespace {

std::vector<double> per_piece(std::size_t count, std::size_t grain,
                              const std::function<double(std::size_t, std::size_t)>& body) {
  std::vector<double> results((count + grain - 1) / grain, 0.0);
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) { results[begin / grain] = body(begin, end); });
  return results;
}

}  // namespace

double parallel_sum(std::size_t count, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& body) {
  double sum = 0;
  for (double s : per_piece(count, grain, body)) sum += s;
  return sum;
}

double parallel_max(std::size_t count, std::size_t grain, const std::function<double(std::size_t, std::size_t)>& body) {
  double largest = 0;
  for (double m : per_piece(count, grain, body)) largest = std::max(largest, m);
  return largest;
}

}  // namespace dynasurf
