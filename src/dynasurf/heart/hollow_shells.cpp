#include "dynasurf/heart/detail/hollow_shells.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::heart {
namespace {

constexpr double beside_mm = 14;  // from the middle of the wall to where it has ended
constexpr std::size_t most_places = 10;
constexpr std::size_t directions = 26;

/// Neighbours along a row, which are looked at side by side: compilers make vectors of them.
constexpr int lanes = 8;
using Lanes = std::array<double, lanes>;

/// The image with its outermost voxels repeated around it.
struct Padded {
  Image image;
  int room = 0;

  const float* at(int i, int j, int k) const { return &image.values[image.grid.index(i + room, j + room, k + room)]; }
};

Padded pad(const Image& image, int room) {
  Grid grid = image.grid;
  for (int& count : grid.dims) count += 2 * room;
  grid.dims[0] += lanes;  // the last voxels of a row have neighbours too
  Padded result{Image(grid), room};
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) result.image(i, j, k) = image.clamped(i - room, j - room, k - room);
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

/// The comparisons that sort one value per direction, whatever the values are (Batcher's merge exchange, Knuth volume
/// 3, algorithm 5.2.2M).
std::vector<Comparison> sorting_network() {
  constexpr std::size_t half = 16;
  static_assert(half < directions && directions <= 2 * half);
  std::vector<Comparison> all;
  for (std::size_t p = half; p > 0; p /= 2)
    for (std::size_t q = half, r = 0, d = p;; d = q - p, q /= 2, r = p) {
      for (std::size_t n = 0; n + d < directions; ++n)
        if ((n & p) == r) all.push_back({n, n + d});
      if (q == p) break;
    }
  return all;
}

/// Contrast of the shells around the voxels from `first` on in their middling directions: the best ones may be a hot
/// neighbour, the worst ones are the open base and defects.
DYNASURF_CLONES
Lanes worth_of(const float* first, const Shell& shell, const std::vector<Comparison>& network) {
  constexpr std::size_t worst = 9, best = 4;
  std::array<Lanes, directions> contrast;
  for (std::size_t d = 0; d < directions; ++d) {
    const auto [in, wall, out] = shell.offsets[d];
    for (int l = 0; l < lanes; ++l) {
      const double inside = first[in + l], outside = first[out + l];
      contrast[d][l] = first[wall + l] - 0.75 * std::max(inside, outside) - 0.25 * std::min(inside, outside);
    }
  }
  for (const auto& [low, high] : network) {
    const Lanes a = contrast[low], b = contrast[high];
    for (int l = 0; l < lanes; ++l) contrast[low][l] = std::min(a[l], b[l]);
    for (int l = 0; l < lanes; ++l) contrast[high][l] = std::max(a[l], b[l]);
  }
  Lanes sum{};
  for (std::size_t d = worst; d < directions - best; ++d)
    for (int l = 0; l < lanes; ++l) sum[l] += contrast[d][l];
  for (double& value : sum) value /= directions - worst - best;
  return sum;
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
  const std::vector<Comparison> network = sorting_network();

  std::vector<Place> all(g.size());
  parallel_for(g.dims[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < g.dims[1]; ++j)
        for (int i = 0; i < g.dims[0]; i += lanes)
          for (const Shell& shell : shells) {
            const Lanes worth = worth_of(padded.at(i, j, k), shell, network);
            for (int l = 0; l < std::min(lanes, g.dims[0] - i); ++l) {
              Place& best = all[g.index(i + l, j, k)];
              if (worth[l] > best.worth) best = {centre_of(g, {i + l, j, k}), shell.radius_mm, worth[l]};
            }
          }
  });
  std::erase_if(all, [](const Place& p) { return p.worth <= 0; });
  std::stable_sort(all.begin(), all.end(), [](const Place& a, const Place& b) { return a.worth > b.worth; });
  std::vector<Place> chosen;
  for (const Place& p : all) {
    const bool is_new = std::all_of(chosen.begin(), chosen.end(),
                                    [&](const Place& c) { return (c.centre - p.centre).norm() >= places_apart_mm; });
    if (is_new) chosen.push_back(p);
    if (chosen.size() == most_places) break;
  }
  return chosen;
}

}  // namespace dynasurf::heart
