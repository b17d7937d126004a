#include "dynasurf/ventricle/labels/detail/radial.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "dynasurf/ventricle/labels/detail/method.hpp"

namespace dynasurf::ventricle {
namespace {

double distance_of(const image::Pixel& p, int k, const Axis& axis) {
  const double dx = p.i - axis.x_at(k), dy = p.j - axis.y_at(k);
  return std::sqrt(dx * dx + dy * dy);
}

/// Coming from the base, the first slice with one border below one with two from which on none has two again; -1
/// where that does not happen.
int slice_of_change(const std::vector<RadialProfile>& profiles) {
  int change = -1;
  for (std::size_t k = 0; k + 1 < profiles.size(); ++k) {
    if (profiles[k].peaks_px.size() >= 2) break;
    if (profiles[k].peaks_px.size() == 1) change = k;
  }
  return change;
}

}  // namespace

RadialProfile radial_profile(const std::vector<image::Component>& edges, const Axis& axis, double circle_radius_px,
                             const RadialLabels& o) {
  RadialProfile profile;
  std::vector<double> sums;
  int all = 0;
  for (const image::Component& edge : edges)
    for (const image::Pixel& p : edge.pixels) {
      const double d = distance_of(p, edge.slice, axis);
      const std::size_t ring = d / o.ring_px;
      if (ring >= profile.counts.size()) profile.counts.resize(ring + 1, 0), sums.resize(ring + 1, 0);
      profile.counts[ring] += 1, sums[ring] += d, all += 1;
    }

  struct Peak {
    std::size_t ring;
    int count;
  };
  std::vector<Peak> peaks;
  const auto count_at = [&](std::size_t m) { return m < profile.counts.size() ? profile.counts[m] : 0; };
  for (std::size_t m = 0; m < profile.counts.size(); ++m) {
    const int here = count_at(m), before = m > 0 ? count_at(m - 1) : 0;
    if (here > o.least_share * all && here >= before && here >= count_at(m + 1)) peaks.push_back({m, here});
  }
  // The higher of two close peaks stays, whatever their order.
  std::stable_sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) { return a.count > b.count; });
  std::vector<Peak> kept;
  for (const Peak& p : peaks) {
    const double radius = sums[p.ring] / p.count;
    const bool close = std::any_of(kept.begin(), kept.end(), [&](const Peak& q) {
      return (p.ring > q.ring ? p.ring - q.ring : q.ring - p.ring) < 2;
    });
    if (!close && radius <= circle_radius_px) kept.push_back(p);
  }
  for (const Peak& p : kept) profile.peaks_px.push_back(sums[p.ring] / p.count);
  std::sort(profile.peaks_px.begin(), profile.peaks_px.end());
  return profile;
}

Mask label(const LabelScene& scene, const RadialLabels& method, Labels& labels) {
  std::vector<RadialProfile> profiles;
  for (const auto& slice : scene.inside)
    profiles.push_back(radial_profile(slice, scene.axis, scene.circle.radius_px, method));
  labels.division_slice = slice_of_change(profiles);

  Mask borders(scene.image.grid);
  for (int k = 0; k < std::ssize(scene.inside); ++k) {
    const auto& peaks = profiles[k].peaks_px;
    const bool two = k > labels.division_slice && peaks.size() >= 2;
    if (peaks.size() > 2)
      labels.notes.push_back({Severity::warning, "radial.peaks",
                              std::to_string(peaks.size()) + " rings of slice " + std::to_string(k + 1) +
                                  " look like a border; the innermost and the outermost were taken.",
                              -1, k});
    for (const image::Component& edge : scene.inside[k])
      for (const image::Pixel& p : edge.pixels) {
        const double d = distance_of(p, edge.slice, scene.axis);
        const bool inner = two && std::abs(d - peaks.front()) < std::abs(d - peaks.back());
        borders(p.i, p.j, edge.slice) = inner ? Labels::endo_bit : Labels::epi_bit;
      }
  }
  return borders;
}

}  // namespace dynasurf::ventricle
