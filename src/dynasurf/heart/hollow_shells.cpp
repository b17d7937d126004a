#include "dynasurf/heart/detail/hollow_shells.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "dynasurf/core/detail/lanes.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::heart {
namespace {

constexpr double beside_mm = 14;  // from the middle of the wall to where it has ended
constexpr std::size_t most_places = 10;
constexpr std::size_t directions = 26;

/// Of the directions of a shell the best ones may be a hot neighbour, the worst ones are the open base and defects.
constexpr std::size_t worst = 9, best = 4;

/// The most neighbours along a row that are looked at side by side.
constexpr int most_lanes = 16;

/// The image with its outermost voxels repeated around it.
struct Padded {
  Image image;
  int room = 0;

  const float* at(int i, int j, int k) const { return &image.values[image.grid.index(i + room, j + room, k + room)]; }
};

Padded pad(const Image& image, int room) {
  Grid grid = image.grid;
  for (int& count : grid.dims) count += 2 * room;
  grid.dims[0] += most_lanes;  // the last voxels of a row have neighbours too
  Padded result{Image(grid), room};
  parallel_for(grid.dims[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) result.image(i, j, k) = image.clamped(i - room, j - room, k - room);
  });
  return result;
}

/// Where the points of a shell and those beside it lie in a padded image, from its middle.
struct Shell {
  double radius_mm = 0;
  std::array<std::array<Index, 3>, directions> offsets{};  // inside, wall, outside per direction
};

Shell make_shell(double radius, const Grid& padded) {
  Shell shell{radius};
  const std::array<double, 3> at{std::max(0.0, radius - beside_mm), radius, radius + beside_mm};
  const std::vector<Vec3> ways = cube_directions();
  for (std::size_t d = 0; d < directions; ++d)
    for (std::size_t s = 0; s < 3; ++s) {
      const auto steps = [&](int a) { return std::lround(at[s] * ways[d][a] / padded.spacing[a]); };
      shell.offsets[d][s] = steps(0) + padded.dims[0] * (steps(1) + padded.dims[1] * steps(2));
    }
  return shell;
}

struct Comparison {
  std::size_t low, high;
};

/// Calls `found` with the comparisons that sort one value per direction, whatever the values are (Batcher's merge
/// exchange, Knuth volume 3, algorithm 5.2.2M).
template <class Found>
constexpr void each_comparison(Found found) {
  constexpr std::size_t half = 16;
  static_assert(half < directions && directions <= 2 * half);
  for (std::size_t p = half; p > 0; p /= 2)
    for (std::size_t q = half, r = 0, d = p;; d = q - p, q /= 2, r = p) {
      for (std::size_t n = 0; n + d < directions; ++n)
        if ((n & p) == r) found(Comparison{n, n + d});
      if (q == p) break;
    }
}

constexpr std::size_t comparison_count() {
  std::size_t count = 0;
  each_comparison([&](Comparison) { ++count; });
  return count;
}

/// Known when this is compiled, so that the loop over them unrolls and values stay in registers.
constexpr std::array<Comparison, comparison_count()> network = [] {
  std::array<Comparison, comparison_count()> all{};
  std::size_t n = 0;
  each_comparison([&](Comparison c) { all[n++] = c; });
  return all;
}();

template <class V>
DYNASURF_INLINE V smaller(V a, V b) {
  return simd::where_greater(a, b, b, a);
}

template <class V, std::size_t... n>
DYNASURF_INLINE void sort(V (&value)[directions], std::index_sequence<n...>) {
  const auto compare = [&](Comparison c) DYNASURF_INLINE_LAMBDA {
    const V a = value[c.low], b = value[c.high];
    value[c.low] = smaller(a, b);
    value[c.high] = simd::larger(b, a);
  };
  (compare(network[n]), ...);
}

/// Contrast of the shells around the voxels from `first` on in their middling directions.
template <class V>
DYNASURF_INLINE V worth_of(const float* first, const Shell& shell) {
  V contrast[directions];
  for (std::size_t d = 0; d < directions; ++d) {
    const auto [in, wall, out] = shell.offsets[d];
    const V inside = simd::load<V>(first + in), outside = simd::load<V>(first + out);
    contrast[d] =
        simd::load<V>(first + wall) - V(0.75F) * simd::larger(outside, inside) - V(0.25F) * smaller(inside, outside);
  }
  sort(contrast, std::make_index_sequence<network.size()>{});
  V sum = 0.0F;
  for (std::size_t d = worst; d < directions - best; ++d) sum += contrast[d];
  return sum / V(float{directions - worst - best});
}

}  // namespace

std::vector<Vec3> cube_directions() {
  std::vector<Vec3> all;
  for (int k = -1; k <= 1; ++k)
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        if (i != 0 || j != 0 || k != 0) all.push_back(Vec3(i, j, k).normalized());
  return all;
}

std::vector<Place> find_places(const Image& coarse) {
  const Grid& g = coarse.grid;
  const int room = ceil_int((shell_radii_mm.back() + beside_mm) / g.spacing.minCoeff());
  const Padded padded = pad(coarse, room);
  std::vector<Shell> shells;
  shells.reserve(shell_radii_mm.size());
  for (const double r : shell_radii_mm) shells.push_back(make_shell(r, padded.image.grid));

  std::vector<float> worth(g.size(), 0);
  std::vector<std::uint8_t> shell_of(g.size(), 0);
  parallel_for(g.dims[2], 1, [&](int begin, int end) {
    field::detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
      static_assert(native <= most_lanes);
      for (int k = begin; k < end; ++k)
        for (int j = 0; j < g.dims[1]; ++j)
          for (int i = 0; i < g.dims[0]; i += native)
            for (std::size_t s = 0; s < shells.size(); ++s) {
              float here[native];
              simd::store(here, worth_of<simd::Pack<float, native, native>>(padded.at(i, j, k), shells[s]));
              for (int l = 0; l < std::min(native, g.dims[0] - i); ++l) {
                const std::size_t at = g.index(i + l, j, k);
                if (here[l] > worth[at]) worth[at] = here[l], shell_of[at] = s;
              }
            }
    });
  });
  std::vector<Place> chosen;
  while (chosen.size() < most_places) {
    // The best voxel that is not near a chosen one; of equal ones the first. Few are the best so far when it is their
    // turn, and only those are compared with the chosen ones.
    Place best;
    for (std::size_t at = 0; at < worth.size(); ++at) {
      if (!(worth[at] > best.worth)) continue;
      const Vec3 centre = centre_of(g, voxel_in(g.dims, at));
      const bool is_new = std::all_of(chosen.begin(), chosen.end(),
                                      [&](const Place& c) { return (c.centre - centre).norm() >= places_apart_mm; });
      if (is_new)
        best = {centre, shells[shell_of[at]].radius_mm, worth[at]};
      else
        worth[at] = 0;
    }
    if (!(best.worth > 0)) break;
    chosen.push_back(best);
  }
  return chosen;
}

}  // namespace dynasurf::heart
