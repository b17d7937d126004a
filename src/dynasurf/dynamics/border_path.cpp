#include "dynasurf/dynamics/detail/border_path.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dynasurf::dynamics {
namespace {

/// floor() of a number that fits an int; the library's call is slow on machines without a rounding instruction.
int floor_to_int(double x) {
  const int i = static_cast<int>(x);
  return i - (x < i ? 1 : 0);
}

}  // namespace

BorderPath::BorderPath(const Image& border)
    : grid_(border.grid), per_mm_(border.grid.spacing.cwiseInverse()), is_border_(border.values.size()) {
  std::transform(border.values.begin(), border.values.end(), is_border_.begin(),
                 [](float v) -> std::uint8_t { return v != 0; });
}

std::optional<BorderHit> BorderPath::first_hit(const Vec3& from_mm, const Vec3& to_mm) const {
  Vec3 from, to;  // in voxels, cells beginning at whole numbers
  Index3 at{}, last{};
  for (int a = 0; a < 3; ++a) {
    from[a] = from_mm[a] * per_mm_[a] + 0.5;
    to[a] = to_mm[a] * per_mm_[a] + 0.5;
    at[a] = floor_to_int(from[a]);
    last[a] = floor_to_int(to[a]);
  }
  if (is_border(at)) return BorderHit{at, from_mm};
  if (at == last) return std::nullopt;

  // `next` is the share of the path at which it leaves the voxel along each axis. Counting the voxels still to go, not
  // only comparing shares, makes the walk end in `last` whatever the rounding: the next walk continues from there.
  Index3 step{}, to_go{};
  Vec3 next, between;
  for (int a = 0; a < 3; ++a) {
    const double way = to[a] - from[a];
    step[a] = last[a] > at[a] ? 1 : -1;
    to_go[a] = std::abs(last[a] - at[a]);
    if (to_go[a] == 0) continue;
    between[a] = 1 / std::abs(way);
    next[a] = (at[a] + (step[a] > 0 ? 1 : 0) - from[a]) / way;
  }
  while (to_go[0] + to_go[1] + to_go[2] > 0) {
    int axis = -1;
    for (int a = 0; a < 3; ++a)
      if (to_go[a] > 0 && (axis < 0 || next[a] < next[axis])) axis = a;
    const double share = std::clamp(next[axis], 0.0, 1.0);
    at[axis] += step[axis];
    --to_go[axis];
    next[axis] += between[axis];
    if (is_border(at)) return BorderHit{at, from_mm + share * (to_mm - from_mm)};
  }
  return std::nullopt;
}

}  // namespace dynasurf::dynamics
