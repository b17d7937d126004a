#include "dynasurf/ventricle/labels/detail/mlc.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/detail/visit_marked.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr int neighbour_slices = 3;

void paint(Mask& borders, const image::Component& edge, std::uint8_t bit) {
  for (const image::Pixel& p : edge.pixels) borders(p.i, p.j, edge.slice) |= bit;
}

/// The edges of one slice by growing distance, and where the largest gap between two of them lies.
struct Sorted {
  std::vector<std::size_t> order;
  std::vector<double> distance;  // in that order
  std::size_t inner = 0;         // this many lie inside the largest gap
  double gap = 0;
};

Sorted sort_by_distance(const std::vector<image::Component>& edges, const Axis& axis) {
  std::vector<double> mean;
  for (const image::Component& e : edges) {
    double sum = 0;
    for (const image::Pixel& p : e.pixels) sum += own::hypot(p.i - axis.x_at(e.slice), p.j - axis.y_at(e.slice));
    mean.push_back(sum / e.pixels.size());
  }
  Sorted s;
  s.order.resize(edges.size());
  std::iota(s.order.begin(), s.order.end(), std::size_t{0});
  std::stable_sort(s.order.begin(), s.order.end(), [&](std::size_t a, std::size_t b) { return mean[a] < mean[b]; });
  for (const std::size_t n : s.order) s.distance.push_back(mean[n]);
  for (std::size_t n = 1; n < s.distance.size(); ++n)
    if (s.distance[n] - s.distance[n - 1] > s.gap) s.gap = s.distance[n] - s.distance[n - 1], s.inner = n;
  return s;
}

/// Median distances of both borders in the slices around k that have a clear gap; empty when there are none.
struct Radii {
  double endo, epi;
};

std::optional<Radii> radii_around(const std::vector<Sorted>& slices, const std::vector<bool>& clear, int k) {
  std::vector<double> endo, epi;
  const int last = std::ssize(slices) - 1;
  for (int n = std::max(0, k - neighbour_slices); n <= std::min(last, k + neighbour_slices); ++n) {
    const Sorted& s = slices[n];
    if (!clear[n]) continue;
    const auto middle = s.distance.begin() + s.inner;
    endo.push_back(median({s.distance.begin(), middle}));
    epi.push_back(median({middle, s.distance.end()}));
  }
  if (endo.empty()) return std::nullopt;
  return Radii{median(endo), median(epi)};
}

}  // namespace

Mask classify_by_gap(const SliceEdges& edges, const Grid& grid, const Axis& axis, int division_slice, const Mlc& o) {
  std::vector<Sorted> slices;
  std::vector<bool> clear;
  for (int k = 0; k < grid.dims[2]; ++k) {
    slices.push_back(sort_by_distance(edges[k], axis));
    const bool divided = slices.back().inner > 0 && (o.strict_thesis || slices.back().gap >= o.min_gap_px);
    clear.push_back(k > division_slice && divided);
  }

  Mask borders(grid);
  for (int k = 0; k < grid.dims[2]; ++k) {
    const Sorted& s = slices[k];
    std::optional<Radii> expected;
    if (k > division_slice && !clear[k] && !o.strict_thesis) expected = radii_around(slices, clear, k);
    for (std::size_t n = 0; n < s.order.size(); ++n) {
      bool inner = clear[k] && n < s.inner;
      if (expected) inner = std::abs(s.distance[n] - expected->endo) < std::abs(s.distance[n] - expected->epi);
      paint(borders, edges[k][s.order[n]], inner ? Labels::endo_bit : Labels::epi_bit);
    }
  }
  return borders;
}

namespace {

/// Below this cosine between gradient and radius the gradient runs along the wall.
constexpr double least_cosine = 0.25;

struct Gradient {
  double x, y;
};

Gradient sobel(const Image& m, int i, int j, int k) {
  const auto at = [&](int di, int dj) -> double { return m.clamped(i + di, j + dj, k); };
  return {(at(1, -1) + 2 * at(1, 0) + at(1, 1) - at(-1, -1) - 2 * at(-1, 0) - at(-1, 1)) / 8,
          (at(-1, 1) + 2 * at(0, 1) + at(1, 1) - at(-1, -1) - 2 * at(0, -1) - at(1, -1)) / 8};
}

/// The side of every pixel of an edge: +1 brighter outwards, -1 darker outwards, 0 neither. The pixels are in the order
/// of the slice, so those of the rows beside one lie around it.
std::vector<int> sides_of(const image::Component& edge, const Image& image, const Axis& axis) {
  const double x = axis.x_at(edge.slice), y = axis.y_at(edge.slice);
  std::vector<double> outwards, strength;
  for (const image::Pixel& p : edge.pixels) {
    const Gradient g = sobel(image, p.i, p.j, edge.slice);
    const double dx = p.i - x, dy = p.j - y, d = std::sqrt(dx * dx + dy * dy);
    outwards.push_back(d > 0 ? (g.x * dx + g.y * dy) / d : 0);
    strength.push_back(std::sqrt(g.x * g.x + g.y * g.y));
  }
  std::vector<int> sides;
  std::size_t first = 0;
  for (const image::Pixel& p : edge.pixels) {
    double sum = 0, all = 0;
    while (edge.pixels[first].j < p.j - 1) ++first;
    for (std::size_t n = first; n < edge.pixels.size() && edge.pixels[n].j <= p.j + 1; ++n) {
      if (std::abs(edge.pixels[n].i - p.i) > 1) continue;
      sum += outwards[n], all += strength[n];
    }
    sides.push_back(sum > least_cosine * all ? 1 : sum < -least_cosine * all ? -1 : 0);
  }
  return sides;
}

}  // namespace

SidedEdges split_by_gradient(const SliceEdges& edges, const Image& image, const Axis& axis, int min_px) {
  Mask endo(image.grid), epi(image.grid);
  for (const auto& slice : edges)
    for (const image::Component& edge : slice) {
      const std::vector<int> sides = sides_of(edge, image, axis);
      for (std::size_t n = 0; n < sides.size(); ++n)
        if (sides[n] != 0) (sides[n] > 0 ? endo : epi)(edge.pixels[n].i, edge.pixels[n].j, edge.slice) = 1;
    }
  return {find_components(endo, min_px), find_components(epi, min_px)};
}

SliceEdges join(const SidedEdges& edges) {
  SliceEdges all = edges.endo;
  for (std::size_t k = 0; k < all.size(); ++k) all[k].insert(all[k].end(), edges.epi[k].begin(), edges.epi[k].end());
  return all;
}

namespace {

/// A border pixel seen from the axis.
struct Ray {
  image::Pixel pixel;
  double cosine, sine, distance;
};
using Rays = std::vector<std::vector<Ray>>;  // per slice

Rays rays_of(const SliceEdges& edges, const Axis& axis) {
  Rays rays(edges.size());
  for (const auto& slice : edges)
    for (const image::Component& edge : slice)
      for (const image::Pixel& p : edge.pixels) {
        const double dx = p.i - axis.x_at(edge.slice), dy = p.j - axis.y_at(edge.slice),
                     d = std::sqrt(dx * dx + dy * dy);
        rays[edge.slice].push_back({p, d > 0 ? dx / d : 1, d > 0 ? dy / d : 0, d});
      }
  return rays;
}

constexpr std::size_t window_slices = 2;
constexpr double window_cosine = 0.866;  // 30 degrees to either side
constexpr std::size_t least_rays = 5;

/// Grows from 0 to 4 with the angle of a direction, from the x axis over the y axis.
double turn_of(double cosine, double sine) { return sine >= 0 ? 1 - cosine : 3 + cosine; }
double turn_of(const Ray& r) { return turn_of(r.cosine, r.sine); }

/// The rays within two slices of one slice, by turn.
using Fan = std::vector<Ray>;

Fan fan_around(const Rays& border, std::size_t k) {
  Fan fan;
  const std::size_t first = k > window_slices ? k - window_slices : 0;
  for (std::size_t n = first; n <= std::min(border.size() - 1, k + window_slices); ++n)
    fan.insert(fan.end(), border[n].begin(), border[n].end());
  std::sort(fan.begin(), fan.end(), [](const Ray& a, const Ray& b) { return turn_of(a) < turn_of(b); });
  return fan;
}

/// The distance below which a share `q` of a border lies, in about the direction of `ray`. Empty when too few pixels
/// are near.
std::optional<double> quantile_near(const Fan& fan, const Ray& ray, double q) {
  // Rays of the window turn by less than 31 degrees; there they are looked for.
  constexpr double cosine = 0.857, sine = 0.515;
  const double low = turn_of(cosine * ray.cosine + sine * ray.sine, cosine * ray.sine - sine * ray.cosine),
               high = turn_of(cosine * ray.cosine - sine * ray.sine, cosine * ray.sine + sine * ray.cosine);
  const auto at = [&](double turn) {
    return std::lower_bound(fan.begin(), fan.end(), turn, [](const Ray& r, double t) { return turn_of(r) < t; }) -
           fan.begin();
  };
  const Index from = at(low), to = at(high), count = fan.size();
  std::vector<double> near;
  const auto look = [&](Index begin, Index end) {
    for (Index n = begin; n < end; ++n)
      if (const Ray& r = fan[n]; r.cosine * ray.cosine + r.sine * ray.sine > window_cosine) near.push_back(r.distance);
  };
  near.reserve(from <= to ? to - from : count - from + to);
  if (from <= to) {
    look(from, to);
  } else {  // over the x axis
    look(from, count);
    look(0, to);
  }
  if (near.size() < least_rays) return std::nullopt;
  const std::size_t rank = q * near.size();
  return of_rank(std::move(near), rank);
}

/// Typical distance of the outer border in all directions; a blob in one direction does not move it.
std::vector<std::optional<double>> typical_distances(const Rays& border) {
  std::vector<std::optional<double>> typical(border.size());
  for (std::size_t k = 0; k < border.size(); ++k) {
    std::vector<double> all;
    const std::size_t first = k > window_slices ? k - window_slices : 0,
                      last = std::min(border.size() - 1, k + window_slices);
    for (std::size_t n = first; n <= last; ++n)
      for (const Ray& r : border[n]) all.push_back(r.distance);
    if (all.size() >= least_rays) typical[k] = median(all);
  }
  return typical;
}

}  // namespace

Mask classify_by_gradient(const SidedEdges& edges, const Grid& grid, const Axis& axis, int min_px, Notes& notes) {
  // A ventricle may be oval by this factor, and a border may bulge from one slice to the next by this much.
  constexpr double most_oval = 1.35, bulge_share = 0.2, bulge_px = 3;
  // The far side of a blob has more pixels than the wall before it, so the outer border is sought below the median.
  constexpr double outer_quantile = 0.3;
  Rays endo = rays_of(edges.endo, axis), epi = rays_of(edges.epi, axis);
  const auto typical = typical_distances(epi);
  const Rays all_epi = epi;
  const auto outer_distance = [&](std::size_t k, const Fan& outer, const Ray& r) -> std::optional<double> {
    const auto here = quantile_near(outer, r, outer_quantile);
    return here && typical[k] ? std::min(*here, most_oval * *typical[k]) : typical[k];
  };

  std::vector<std::size_t> dropped_in(epi.size(), 0);
  const auto filter = [&](Rays& rays, const auto& contradicts_in) {
    parallel_for(rays.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        const auto contradicts = contradicts_in(k);
        dropped_in[k] += std::erase_if(rays[k], [&](const Ray& r) { return contradicts(r); });
      }
    });
  };
  filter(endo, [&](std::size_t k) {
    return [&, k, outer = fan_around(all_epi, k)](const Ray& r) {
      const auto outside = outer_distance(k, outer, r);
      return outside && r.distance >= *outside;
    };
  });
  filter(epi, [&](std::size_t k) {
    return [&, k, outer = fan_around(all_epi, k), inner = fan_around(endo, k)](const Ray& r) {
      const auto outside = outer_distance(k, outer, r);
      if (!outside) return false;
      const double inside = quantile_near(inner, r, 0.5).value_or(0);
      const bool in_cavity = inside < *outside && r.distance <= inside;
      return in_cavity || r.distance > *outside + std::max(bulge_px, bulge_share * *outside);
    };
  });
  const std::size_t dropped = std::accumulate(dropped_in.begin(), dropped_in.end(), std::size_t{0});
  Mask inner(grid), outer(grid);
  for (std::size_t k = 0; k < endo.size(); ++k) {
    for (const Ray& r : endo[k]) inner(r.pixel.i, r.pixel.j, k) = 1;
    for (const Ray& r : epi[k]) outer(r.pixel.i, r.pixel.j, k) = 1;
  }
  if (dropped > 0)
    notes.push_back({Severity::info, "mlc.outliers",
                     std::to_string(dropped) + " edge pixels contradict the borders around them and were left out."});

  Mask borders(grid);
  for (const auto& slice : find_components(inner, min_px))
    for (const image::Component& c : slice) paint(borders, c, Labels::endo_bit);
  for (const auto& slice : find_components(outer, min_px))
    for (const image::Component& c : slice) paint(borders, c, Labels::epi_bit);
  return borders;
}

std::vector<image::Pixel> pixels_of(const Mask& borders, int k, std::uint8_t bit) {
  std::vector<image::Pixel> pixels;
  visit_marked(
      borders, k, [bit](std::uint8_t voxel) { return (voxel & bit) != 0; },
      [&](int i, int j) {
        pixels.push_back({i, j});
      });
  return pixels;
}

int count_borders(const Mask& borders, int k, const Axis& axis, double least_coverage_deg) {
  const auto endo = pixels_of(borders, k, Labels::endo_bit), epi = pixels_of(borders, k, Labels::epi_bit);
  const bool has_endo = !endo.empty() && coverage_deg(endo, axis.x_at(k), axis.y_at(k)) >= least_coverage_deg;
  return has_endo + !epi.empty();
}

}  // namespace dynasurf::ventricle
