#include "dynasurf/image/detail/ridges.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {
namespace {

/// Eqs 2.2 and 2.3. The thesis has y upwards in sy; here it grows with the row, as everywhere: only a sign.
SliceVectors sobel_of(const Slice& s) {
  SliceVectors g{Slice(s.width, s.height), Slice(s.width, s.height)};
  for (int j = 0; j < s.height; ++j)
    for (int i = 0; i < s.width; ++i) {
      const auto at = [&](int di, int dj) -> double { return s.clamped(i + di, j + dj); };
      const double right = at(1, -1) + at(1, 1) + 2 * at(1, 0), left = at(-1, -1) + at(-1, 1) + 2 * at(-1, 0);
      const double below = at(-1, 1) + at(1, 1) + 2 * at(0, 1), above = at(-1, -1) + at(1, -1) + 2 * at(0, -1);
      g.x(i, j) = right - left;
      g.y(i, j) = below - above;
    }
  return g;
}

}  // namespace

EdgeMap detect_edges(const Image& image, const SobelEdges& options) {
  SobelEdges o = options;
  check_options(o, "sobel");
  require_finite(image);
  EdgeMap map{Mask(image.grid), Image(image.grid), {}, {}};
  for_each_slice(image.grid, [&](int k) { put_slice(lengths_of(sobel_of(slice_of(image, k))), map.gradient, k); });

  if (o.subpixel) map.offsets = EdgeOffsets{Image(image.grid), Image(image.grid)};
  const float least = o.threshold * largest_of(map.gradient);
  for_each_slice(image.grid, [&](int k) {
    const Slice magnitude = slice_of(map.gradient, k);
    SliceVectors across;
    if (o.thin || o.subpixel) across = sobel_of(slice_of(image, k));
    const Slice kept = o.thin ? thin(magnitude, across) : magnitude;
    for (int j = 0; j < kept.height; ++j)
      for (int i = 0; i < kept.width; ++i)
        if (kept(i, j) > 0 && kept(i, j) >= least) map.edges(i, j, k) = major_edge;
    if (o.subpixel) put_offsets(magnitude, across, map, k);
  });
  note_flat(map);
  return map;
}

}  // namespace dynasurf::image
