#include "dynasurf/ventricle/labels/detail/circle.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Dense>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/detail/visit_marked.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double half_turn_deg = 180;
constexpr int least_slices_for_an_axis = 5;

struct Ring {
  double radius_px, share;  // mean distance, and the share of pixels within the tolerance of it
};

Ring ring_around(const std::vector<image::Pixel>& pixels, double x, double y, double tolerance) {
  std::vector<double> distances;
  double sum = 0;
  for (const image::Pixel& p : pixels) {
    distances.push_back(std::sqrt((p.i - x) * (p.i - x) + (p.j - y) * (p.j - y)));
    sum += distances.back();
  }
  const double count = pixels.size();
  const double radius = sum / count;
  const auto on_ring =
      std::count_if(distances.begin(), distances.end(), [&](double d) { return std::abs(d - radius) <= tolerance; });
  return {radius, on_ring / count};
}

image::PixelMean middle_of(const Grid& grid) { return {(grid.dims[0] - 1) / 2.0, (grid.dims[1] - 1) / 2.0}; }

/// 1 in the middle of the image, falling with the distance from it.
double nearness(const Grid& grid, double x, double y, double width_share) {
  const image::PixelMean m = middle_of(grid);
  const double width = width_share * grid.dims[0];
  const double dx = x - m.x_px, dy = y - m.y_px;
  return own::exp(-(dx * dx + dy * dy) / (2 * width * width));
}

/// The edge as a circle around its own centre, if it is circular.
std::optional<Circle> as_circle(const image::Component& edge, const AutoCircle& o) {
  const image::PixelMean mean = image::mean_of(edge.pixels);
  Circle c{mean.x_px, mean.y_px, 0};
  // The centroid of an arc lies near the arc, not in the middle of its circle.
  if (o.robust_fit) {
    const auto fit = fit_circle(edge.pixels);
    if (!fit || coverage_deg(edge.pixels, fit->x_px, fit->y_px) < half_turn_deg) return std::nullopt;
    c = *fit;
  }
  const Ring ring = ring_around(edge.pixels, c.x_px, c.y_px, o.centroid_tolerance_px);
  if (!(ring.share > o.centroid_share)) return std::nullopt;
  return Circle{c.x_px, c.y_px, ring.radius_px};
}

std::optional<Circle> largest_circle(const std::vector<image::Component>& edges, const AutoCircle& o) {
  std::optional<Circle> best;
  std::size_t most = 0;
  for (const image::Component& edge : edges) {
    if (edge.pixels.size() <= most) continue;
    if (const auto circle = as_circle(edge, o)) best = circle, most = edge.pixels.size();
  }
  return best;
}

/// Middle of the intensities; of an image without any, its middle.
image::PixelMean intensity_centroid(const Image& image) {
  double sum = 0, x = 0, y = 0;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) {
        const double w = std::max(0.0F, image(i, j, k));
        sum += w, x += w * i, y += w * j;
      }
  return sum > 0 ? image::PixelMean{x / sum, y / sum} : middle_of(image.grid);
}

struct Line {
  double start, slope;
};

/// Theil and Sen: the median of all slopes, then the median of what remains.
Line median_line(const std::vector<double>& k, const std::vector<double>& v) {
  std::vector<double> slopes, starts;
  for (std::size_t a = 0; a < k.size(); ++a)
    for (std::size_t b = a + 1; b < k.size(); ++b) slopes.push_back((v[b] - v[a]) / (k[b] - k[a]));
  const double slope = median(slopes);
  for (std::size_t a = 0; a < k.size(); ++a) starts.push_back(v[a] - slope * k[a]);
  return {median(starts), slope};
}

}  // namespace

SliceEdges find_components(const Mask& edges, int min_px) {
  SliceEdges found(std::max(0, edges.grid.dims[2]));
  for (int k = 0; k < edges.grid.dims[2]; ++k) {
    auto& slice = found[k];
    slice = image::components_of_slice(edges, k);
    std::erase_if(slice, [&](const image::Component& c) { return std::ssize(c.pixels) < min_px; });
  }
  return found;
}

Mask to_mask(const SliceEdges& edges, const Grid& grid) {
  Mask mask(grid);
  for (const auto& slice : edges)
    for (const image::Component& c : slice)
      for (const image::Pixel& p : c.pixels) mask(p.i, p.j, c.slice) = 1;
  return mask;
}

Circle coarse_circle(const Grid& grid, const CoarseCircle& o) {
  const image::PixelMean m = middle_of(grid);
  return {o.x_px.value_or(m.x_px), o.y_px.value_or(m.y_px),
          o.radius_px.value_or(0.5 * std::min(grid.dims[0], grid.dims[1]))};
}

Mask clip(Mask edges, const Axis& axis, double radius_px) {
  for (int k = 0; k < edges.grid.dims[2]; ++k)
    visit_marked(edges, k, [&](int i, int j) {
      const double dx = i - axis.x_at(k), dy = j - axis.y_at(k);
      if (dx * dx + dy * dy > radius_px * radius_px) edges(i, j, k) = 0;
    });
  return edges;
}

std::optional<Circle> fit_circle(const std::vector<image::Pixel>& pixels) {
  if (pixels.size() < 3) return std::nullopt;
  const image::PixelMean mean = image::mean_of(pixels);
  // |q|^2 = 2 c.q + (r^2 - |c|^2) is linear in the centre c; coordinates from the mean keep it well conditioned.
  double xx = 0, xy = 0, yy = 0, xs = 0, ys = 0, ss = 0;
  for (const image::Pixel& p : pixels) {
    const double x = p.i - mean.x_px, y = p.j - mean.y_px, s = x * x + y * y;
    xx += x * x, xy += x * y, yy += y * y, xs += x * s, ys += y * s, ss += s;
  }
  const double determinant = xx * yy - xy * xy;
  if (!(determinant > 1e-9 * (xx + yy) * (xx + yy))) return std::nullopt;
  const double x = (xs * yy - ys * xy) / (2 * determinant), y = (ys * xx - xs * xy) / (2 * determinant);
  const double mean_square = ss / pixels.size();
  return Circle{mean.x_px + x, mean.y_px + y, std::sqrt(mean_square + x * x + y * y)};
}

double coverage_deg(const std::vector<image::Pixel>& pixels, double x_px, double y_px) {
  if (pixels.size() < 2) return 0;
  std::vector<double> angles;
  angles.reserve(pixels.size());
  for (const image::Pixel& p : pixels) angles.push_back(own::atan2(p.j - y_px, p.i - x_px));
  std::sort(angles.begin(), angles.end());
  // The gap across the seam of the angle, from the last one to the first.
  double widest = angles.front() + 2 * std::numbers::pi - angles.back();
  for (std::size_t n = 1; n < angles.size(); ++n) widest = std::max(widest, angles[n] - angles[n - 1]);
  return 360 - widest * 180 / std::numbers::pi;
}

Centre find_centre(const SliceEdges& edges, const Image& image, const AutoCircle& o, Notes& notes) {
  Centre centre;
  double sum = 0, x = 0, y = 0;
  for (const auto& slice : edges) {
    centre.local.push_back(largest_circle(slice, o));
    if (!centre.local.back()) continue;
    const Circle& c = *centre.local.back();
    const double w = nearness(image.grid, c.x_px, c.y_px, o.centre_width);
    sum += w, x += w * c.x_px, y += w * c.y_px;
  }
  if (sum > 0) {
    centre.x_px = x / sum, centre.y_px = y / sum;
    return centre;
  }
  const image::PixelMean mean = intensity_centroid(image);
  centre.x_px = mean.x_px, centre.y_px = mean.y_px;
  notes.push_back({Severity::warning, "circle.no_circular_edge",
                   "No slice has a circular edge; the centre of the intensities (column " + std::to_string(mean.x_px) +
                       ", row " + std::to_string(mean.y_px) + ") stands for the centre of the ventricle."});
  return centre;
}

Axis find_axis(const Centre& centre, const AutoCircle& o) {
  std::vector<double> k, x, y;
  for (std::size_t s = 0; s < centre.local.size(); ++s) {
    if (!centre.local[s]) continue;
    k.push_back(s);
    x.push_back(centre.local[s]->x_px), y.push_back(centre.local[s]->y_px);
  }
  if (!o.robust_fit || k.size() < least_slices_for_an_axis) return {centre.x_px, centre.y_px, 0, 0};
  const Line across = median_line(k, x), down = median_line(k, y);
  return {across.start, down.start, across.slope, down.slope};
}

WidestEdge find_widest_edge(const SliceEdges& edges, const Grid& grid, const Axis& axis, const AutoCircle& o,
                            Notes& notes) {
  WidestEdge widest;
  double best = 0;
  const std::size_t least_px = 2 * o.min_component_px;
  for (const auto& slice : edges)
    for (const image::Component& edge : slice) {
      const double x = axis.x_at(edge.slice), y = axis.y_at(edge.slice);
      if (edge.pixels.size() <= least_px) continue;
      if (o.robust_fit && coverage_deg(edge.pixels, x, y) < half_turn_deg) continue;
      const Ring ring = ring_around(edge.pixels, x, y, o.radius_tolerance_px);
      if (!(ring.share > o.radius_share)) continue;
      const image::PixelMean mean = image::mean_of(edge.pixels);
      // The thesis names no value to compare; this is distance with the Gaussian of CIRC-CENTROID.
      const double score = ring.radius_px * nearness(grid, mean.x_px, mean.y_px, o.centre_width);
      if (score > best) best = score, widest = {ring.radius_px, edge.slice};
    }
  if (widest.slice < 0)
    notes.push_back({Severity::warning, "circle.no_wide_edge",
                     "No edge of more than " + std::to_string(least_px) +
                         " pixels is circular around the centre; the automatic circle is the coarse one."});
  return widest;
}

}  // namespace dynasurf::ventricle
