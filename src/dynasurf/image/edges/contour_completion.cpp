#include "dynasurf/image/edges/detail/contour_completion.hpp"

#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/image/detail/ridges.hpp"

namespace dynasurf::image {
namespace {

using Values = std::vector<double>;

/// c xi xi^T = [a b; b d] per pixel, and the normal, which is across the contours.
struct Tensor {
  Values a, b, d;
  SliceVectors normal;
};

/// The products of the gradient with itself.
struct Products {
  Slice xx, xy, yy;
};

Products products_of(Slice image, double sigma_px) {
  smooth(image, half_gaussian(sigma_px));
  const SliceVectors g = central_gradient(image);
  const Slice zero(image.width, image.height);
  Products p{zero, zero, zero};
  for (std::size_t n = 0; n < zero.values.size(); ++n) {
    const float x = g.x.values[n], y = g.y.values[n];
    p.xx.values[n] = x * x, p.xy.values[n] = x * y, p.yy.values[n] = y * y;
  }
  return p;
}

/// Tensor of the tangents that the directions in `p` agree upon in a window.
Tensor tensor_of(Products p, double sigma_px) {
  const auto window = half_gaussian(sigma_px);
  for (Slice* s : {&p.xx, &p.xy, &p.yy}) smooth(*s, window);
  const std::size_t count = p.xx.values.size();
  Tensor t{Values(count, 0), Values(count, 0), Values(count, 0), {p.xx, p.xx}};
  for (std::size_t n = 0; n < count; ++n) {
    const double xx = p.xx.values[n], yy = p.yy.values[n], xy = p.xy.values[n];
    const double sum = xx + yy, difference = std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy);  // of the eigenvalues
    // Where gradients point everywhere, or nowhere, there is no tangent to flow along.
    const double agreement = sum > 0 ? difference / sum : 0, c = agreement * agreement;
    const double cos2 = difference > 0 ? (xx - yy) / difference : 1, sin2 = difference > 0 ? 2 * xy / difference : 0;
    t.a[n] = c * (1 - cos2) / 2, t.d[n] = c * (1 + cos2) / 2, t.b[n] = -c * sin2 / 2;
    const double angle = 0.5 * own::atan2(2 * xy, xx - yy);
    t.normal.x.values[n] = static_cast<float>(own::cos(angle));
    t.normal.y.values[n] = static_cast<float>(own::sin(angle));
  }
  return t;
}

Tensor tangents_of(const Slice& image, const ContourCompletion& o) {
  return tensor_of(products_of(image, o.gradient_sigma_px), o.tensor_sigma_px);
}

/// Tangents that only the pixels of the contour decide on. The gradient at the end of a contour points along it, so
/// the image's own tangents would lie across every gap. Their own window is small: a wide one lags behind the
/// curvature at the ends, and the bridge leaves the arc.
Tensor extended_tangents_of(const Slice& contour, const ContourCompletion& o) {
  const Tensor own = tensor_of(products_of(contour, o.gradient_sigma_px), o.tensor_sigma_px / 3);
  Products p{contour, contour, contour};
  for (std::size_t n = 0; n < contour.values.size(); ++n) {
    const float x = own.normal.x.values[n], y = own.normal.y.values[n], on = contour.values[n] > 0 ? 1.0F : 0.0F;
    p.xx.values[n] = on * x * x, p.xy.values[n] = on * x * y, p.yy.values[n] = on * y * y;
  }
  return tensor_of(std::move(p), o.tensor_sigma_px);
}

/// Scharr's weights beside the centre line: the smallest error of direction a 3x3 difference can have.
constexpr double scharr_side = 3.0 / 16, scharr_middle = 10.0 / 16;

struct Lattice {
  int width, height;
  std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(std::clamp(j, 0, height - 1) * width + std::clamp(i, 0, width - 1));
  }
};

/// One explicit step u += dt div(D grad u).
void flow(Values& u, const Tensor& t, const Lattice& l, double dt) {
  Values x(u.size()), y(u.size());
  for (int j = 0; j < l.height; ++j)
    for (int i = 0; i < l.width; ++i) {
      const auto v = [&](int di, int dj) { return u[l.at(i + di, j + dj)]; };
      const double ux =
          (scharr_middle * (v(1, 0) - v(-1, 0)) + scharr_side * ((v(1, 1) - v(-1, -1)) + (v(1, -1) - v(-1, 1)))) / 2;
      const double uy =
          (scharr_middle * (v(0, 1) - v(0, -1)) + scharr_side * ((v(1, 1) - v(-1, -1)) + (v(-1, 1) - v(1, -1)))) / 2;
      const std::size_t n = l.at(i, j);
      x[n] = dt * (t.a[n] * ux + t.b[n] * uy);
      y[n] = dt * (t.b[n] * ux + t.d[n] * uy);
    }
  // Minus the transposed gradient: what a pixel's slope took from its neighbours goes back to them.
  for (int j = 0; j < l.height; ++j)
    for (int i = 0; i < l.width; ++i) {
      const std::size_t n = l.at(i, j);
      const auto give = [&](int di, int dj, double wx, double wy) { u[l.at(i + di, j + dj)] -= wx * x[n] + wy * y[n]; };
      constexpr double m = scharr_middle / 2, s = scharr_side / 2;
      give(1, 0, m, 0), give(-1, 0, -m, 0), give(0, 1, 0, m), give(0, -1, 0, -m);
      give(1, 1, s, s), give(-1, -1, -s, -s), give(1, -1, s, -s), give(-1, 1, -s, s);
    }
}

Slice to_slice(const Values& u, int width, int height) {
  Slice s(width, height);
  for (std::size_t n = 0; n < u.size(); ++n) s.values[n] = static_cast<float>(u[n]);
  return s;
}

/// Ridges of the completed contour that are hot enough become minor edges.
void add_bridges(const Slice& heat, const SliceVectors& normal, const ContourCompletion& o, EdgeMap& map, int k) {
  for (int j = 0; j < heat.height; ++j)
    for (int i = 0; i < heat.width; ++i) {
      const float x = normal.x(i, j), y = normal.y(i, j);
      if (map.edges(i, j, k) || heat(i, j) < o.complete_level || !is_ridge(heat, i, j, x, y)) continue;
      map.edges(i, j, k) = minor_edge;
      if (!map.offsets) continue;
      const RidgeOffset offset = ridge_offset(heat, i, j, x, y);
      map.offsets->x_px(i, j, k) = offset.x;
      map.offsets->y_px(i, j, k) = offset.y;
    }
}

}  // namespace

Slice diffuse_along_contours(const Slice& image, const ContourCompletion& o) {
  const Lattice lattice{image.width, image.height};
  Values u(image.values.begin(), image.values.end());
  Tensor t = tangents_of(image, o);
  for (int step = 0; step < o.steps; ++step) {
    if (o.refresh > 0 && step > 0 && step % o.refresh == 0) t = tangents_of(to_slice(u, image.width, image.height), o);
    flow(u, t, lattice, o.step);
  }
  return to_slice(u, image.width, image.height);
}

Slice complete_contour(const Slice& contour, const ContourCompletion& o) {
  const Lattice lattice{contour.width, contour.height};
  Values u(contour.values.begin(), contour.values.end());
  const Tensor t = extended_tangents_of(contour, o);
  for (int step = 0; step < o.steps; ++step) {
    flow(u, t, lattice, o.step);
    for (std::size_t n = 0; n < u.size(); ++n)
      if (contour.values[n] > 0) u[n] = 1;
  }
  return to_slice(u, contour.width, contour.height);
}

EdgeMap detect_edges(const Image& image, const ContourCompletion& options) {
  ContourCompletion o = options;
  check_options(o, "acc");
  require_finite(image);
  if (o.complete) {
    EdgeMap map = detect_edges(image, o.canny);
    for_each_slice(image.grid, [&](int k) {
      Slice contour(image.grid.dims[0], image.grid.dims[1]);
      for (int j = 0; j < contour.height; ++j)
        for (int i = 0; i < contour.width; ++i) contour(i, j) = map.edges(i, j, k) ? 1.0F : 0.0F;
      add_bridges(complete_contour(contour, o), extended_tangents_of(contour, o).normal, o, map, k);
    });
    return map;
  }
  Image diffused(image.grid);
  for_each_slice(image.grid, [&](int k) { put_slice(diffuse_along_contours(slice_of(image, k), o), diffused, k); });
  return detect_edges(diffused, o.canny);
}

}  // namespace dynasurf::image
