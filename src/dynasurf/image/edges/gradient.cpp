#include <array>
#include <cmath>

#include "dynasurf/image/detail/ridges.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {

std::span<const std::string_view> names_of(GradientMeasure) {
  static constexpr std::array<std::string_view, 4> names{"squared", "magnitude", "laplacian", "roberts"};
  return names;
}

namespace {

/// The measure of a slice, and the direction its ridges are sought across.
struct Measured {
  Slice strength, laplacian;
  SliceVectors across;
};

SliceVectors gradient_per_mm(const Slice& s, const Grid& grid) {
  SliceVectors g = central_gradient(s);
  const float dx = grid.spacing[0], dy = grid.spacing[1];
  for (float& v : g.x.values) v /= dx;
  for (float& v : g.y.values) v /= dy;
  return g;
}

Slice laplacian_of(const Slice& s, const Grid& grid) {
  Slice l(s.width, s.height);
  const double dx2 = grid.spacing[0] * grid.spacing[0], dy2 = grid.spacing[1] * grid.spacing[1];
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i) {
      const double here = s(i, j), beside = double(s.clamped(i - 1, j)) + s.clamped(i + 1, j),
                   above = double(s.clamped(i, j - 1)) + s.clamped(i, j + 1);
      l(i, j) = (beside - 2 * here) / dx2 + (above - 2 * here) / dy2;
    }
  return l;
}

/// Roberts' cross sits on the corners between the pixels. A pixel takes the largest of its four corners, so that the
/// map neither moves by half a pixel nor depends on how the image is turned; divided by sqrt(2) it is a slope.
Slice roberts_of(const Slice& s, const Grid& grid) {
  const double diagonal = std::sqrt((grid.spacing[0] * grid.spacing[0] + grid.spacing[1] * grid.spacing[1]) / 2);
  Slice r(s.width, s.height);
  const auto corner = [&](int i, int j) {  // below and right of pixel (i, j)
    const double falling = double(s.clamped(i + 1, j + 1)) - s.clamped(i, j),
                 rising = double(s.clamped(i + 1, j)) - s.clamped(i, j + 1);
    return std::sqrt((falling * falling + rising * rising) / 2) / diagonal;
  };
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i)
      r(i, j) = std::max({corner(i - 1, j - 1), corner(i, j - 1), corner(i - 1, j), corner(i, j)});
  return r;
}

Measured measure(const Slice& s, const Grid& grid, GradientMeasure how) {
  Measured m{{}, {}, gradient_per_mm(s, grid)};
  if (how == GradientMeasure::roberts) {
    m.strength = roberts_of(s, grid);
  } else if (how == GradientMeasure::laplacian) {
    m.laplacian = m.strength = laplacian_of(s, grid);
    for (float& v : m.strength.values) v = std::abs(v);
  } else {
    m.strength = lengths_of(m.across);
    if (how == GradientMeasure::squared)
      for (float& v : m.strength.values) v *= v;
  }
  return m;
}

/// Where the Laplacian changes sign towards a neighbour by at least `least`: of the two pixels the one nearer to zero,
/// of equal ones the brighter (negative) one. What is left is the swing, else 0. The crossing lies on the line between
/// the two.
struct Crossings {
  Slice swing;
  SliceVectors offset;
};

Crossings zero_crossings(const Slice& l) {
  constexpr std::array<std::array<int, 2>, 4> sides{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};
  Crossings c{Slice(l.width, l.height), {Slice(l.width, l.height), Slice(l.width, l.height)}};
  for (int j = 0; j < l.height; ++j)
    for (int i = 0; i < l.width; ++i)
      for (const auto& d : sides) {
        const float here = l(i, j), there = l.clamped(i + d[0], j + d[1]);
        const bool mine = std::abs(here) < std::abs(there) || (here == -there && here < 0);
        if (!((here < 0 && there > 0) || (here > 0 && there < 0)) || !mine) continue;
        const float swing = std::abs(here - there), t = here / (here - there);
        if (swing <= c.swing(i, j)) continue;
        c.swing(i, j) = swing;
        c.offset.x(i, j) = t * d[0];
        c.offset.y(i, j) = t * d[1];
      }
  return c;
}

void mark(const Slice& strength, float least, Mask& edges, int k) {
  for (int j = 0; j < strength.height; ++j)
    for (int i = 0; i < strength.width; ++i)
      if (strength(i, j) > 0 && strength(i, j) >= least) edges(i, j, k) = major_edge;
}

}  // namespace

EdgeMap detect_edges(const Image& image, const GradientEdges& options) {
  GradientEdges o = options;
  check_options(o, "gradient");
  require_finite(image);
  EdgeMap map{Mask(image.grid), Image(image.grid), {}, {}};
  for_each_slice(image.grid, [&](int k) {
    put_slice(measure(slice_of(image, k), image.grid, o.measure).strength, map.gradient, k);
  });

  if (o.subpixel) map.offsets = EdgeOffsets{Image(image.grid), Image(image.grid)};
  const float least = o.threshold * largest_of(map.gradient);
  for_each_slice(image.grid, [&](int k) {
    const Measured m = measure(slice_of(image, k), image.grid, o.measure);
    if (o.measure != GradientMeasure::laplacian || !o.thin) {
      mark(o.thin ? thin(m.strength, m.across) : m.strength, least, map.edges, k);
      if (o.subpixel) put_offsets(m.strength, m.across, map, k);
      return;
    }
    const Crossings c = zero_crossings(m.laplacian);
    mark(c.swing, least, map.edges, k);
    if (!o.subpixel) return;
    for (int j = 0; j < c.swing.height; ++j)
      for (int i = 0; i < c.swing.width; ++i)
        if (map.edges(i, j, k)) {
          map.offsets->x_px(i, j, k) = c.offset.x(i, j);
          map.offsets->y_px(i, j, k) = c.offset.y(i, j);
        }
  });
  note_flat(map);
  return map;
}

}  // namespace dynasurf::image
