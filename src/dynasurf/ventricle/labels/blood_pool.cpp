#include "dynasurf/ventricle/labels/detail/blood_pool.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double middle_px = 1.5;  // up to here it is the middle, then rings of a pixel begin

constexpr std::size_t least_circles = 5;  // a few may be gut or the solid apex

/// Of one slice; 0 when the circle has no bright ring.
double filling_of(const Image& image, double x, double y, double radius_px, int k) {
  const int rings = floor_int(std::max(0.0, radius_px - middle_px)) + 2;
  std::vector<double> sums(rings, 0), counts(sums);
  const int reach = ceil_int(radius_px);
  const int ci = floor_int(x + 0.5), cj = floor_int(y + 0.5);
  for (int j = cj - reach; j <= cj + reach; ++j)
    for (int i = ci - reach; i <= ci + reach; ++i) {
      const double d = own::hypot(i - x, j - y);
      if (d > radius_px || !image.grid.contains(i, j, k)) continue;
      const int ring = d <= middle_px ? 0 : 1 + floor_int(d - middle_px);
      sums[ring] += image(i, j, k), counts[ring] += 1;
    }
  double brightest = 0;
  for (std::size_t r = 0; r < sums.size(); ++r)
    if (counts[r] > 0) brightest = std::max(brightest, sums[r] / counts[r]);
  return brightest > 0 && counts[0] > 0 ? sums[0] / counts[0] / brightest : 0;
}

}  // namespace

double filling(const Image& image, const std::vector<std::optional<Circle>>& local) {
  std::vector<double> shares;
  for (std::size_t k = 0; k < local.size(); ++k)
    if (const auto& c = local[k]) shares.push_back(filling_of(image, c->x_px, c->y_px, c->radius_px, k));
  if (shares.size() < least_circles) return 0;
  return upper_median(std::move(shares));
}

double inner_share(const SidedEdges& edges) {
  const auto pixels = [](const SliceEdges& slices) -> double {
    std::size_t count = 0;
    for (const auto& slice : slices)
      for (const image::Component& c : slice) count += c.pixels.size();
    return count;
  };
  const double inner = pixels(edges.endo), outer = pixels(edges.epi);
  return inner > 0 ? inner / (inner + outer) : 0;
}

bool is_blood_pool(double filling, double inner_share) {
  constexpr double least_filling = 0.95, most_inner = 0.05;
  return filling >= least_filling && inner_share <= most_inner;
}

Mask borders_of_pool(Mask borders) {
  for (std::uint8_t& v : borders.values) v = v & Labels::epi_bit ? Labels::endo_bit : 0;
  return borders;
}

int division_slice_of_pool(const std::vector<double>& profile) {
  const auto brightest = std::max_element(profile.begin(), profile.end());
  if (brightest == profile.end()) return -1;
  int k = brightest - profile.begin();
  while (k >= 0 && profile[k] >= 0.5 * *brightest) --k;
  return k;
}

}  // namespace dynasurf::ventricle
