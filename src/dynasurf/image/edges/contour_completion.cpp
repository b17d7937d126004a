#include "dynasurf/image/edges/detail/contour_completion.hpp"

#include <cmath>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/image/detail/components.hpp"
#include "dynasurf/image/detail/gaussian.hpp"
#include "dynasurf/image/detail/ridges.hpp"
#include "dynasurf/image/edges/detail/contour_prior.hpp"

namespace dynasurf::image {
namespace {

using Values = std::vector<double>;

/// c xi xi^T = [a b; b d] per pixel, and the normal, which is across the contours.
struct Tensor {
  Values a, b, d;
  SliceVectors normal;
  Slice strength;  // how much more speaks for the tangent than across it
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

Products in_window(Products p, double sigma_px) {
  const auto window = half_gaussian(sigma_px);
  for (Slice* s : {&p.xx, &p.xy, &p.yy}) smooth(*s, window);
  return p;
}

/// Tensor of the tangents that the directions in `p` agree upon.
Tensor tensor_of(const Products& p) {
  const std::size_t count = p.xx.values.size();
  Tensor t{Values(count, 0), Values(count, 0), Values(count, 0), {p.xx, p.xx}, p.xx};
  for (std::size_t n = 0; n < count; ++n) {
    const double xx = p.xx.values[n], yy = p.yy.values[n], xy = p.xy.values[n];
    const double sum = xx + yy, difference = std::sqrt((xx - yy) * (xx - yy) + 4 * xy * xy);  // of the eigenvalues
    // Where gradients point everywhere, or nowhere, there is no tangent to flow along.
    const double agreement = sum > 0 ? difference / sum : 0, c = agreement * agreement;
    const double cos2 = difference > 0 ? (xx - yy) / difference : 1, sin2 = difference > 0 ? 2 * xy / difference : 0;
    t.a[n] = c * (1 - cos2) / 2, t.d[n] = c * (1 + cos2) / 2, t.b[n] = -c * sin2 / 2;
    const double angle = 0.5 * own::atan2(2 * xy, xx - yy);
    t.normal.x.values[n] = own::cos(angle);
    t.normal.y.values[n] = own::sin(angle);
    t.strength.values[n] = difference;
  }
  return t;
}

/// The directions across a circle or an ellipse about its middle, mixed with those that were seen.
void mix_in(const std::optional<Conic>& prior, double weight, Products& p) {
  if (!prior || weight == 0) return;
  for (int j = 0; j < p.xx.height; ++j)
    for (int i = 0; i < p.xx.width; ++i) {
      const Eigen::Vector2d across = prior->slope(i, j);
      const double length2 = across.squaredNorm();
      if (!(length2 > 0)) continue;
      const double seen = p.xx(i, j) + double{p.yy(i, j)};
      const double share = seen > 0 ? (1 - weight) / seen : 0;
      const auto mix = [&](float& value, double of_prior) { value = share * value + weight * of_prior / length2; };
      mix(p.xx(i, j), across[0] * across[0]);
      mix(p.xy(i, j), across[0] * across[1]);
      mix(p.yy(i, j), across[1] * across[1]);
    }
}

Tensor tangents_of(const Slice& image, const ContourCompletion& o, const std::optional<Conic>& prior) {
  Products p = in_window(products_of(image, o.gradient_sigma_px), o.tensor_sigma_px);
  mix_in(prior, o.prior_weight, p);
  return tensor_of(p);
}

void add_vote(Products& votes, int i, int j, double weight, const Eigen::Vector2d& across) {
  const float xx = weight * across[0] * across[0], xy = weight * across[0] * across[1],
              yy = weight * across[1] * across[1];
  votes.xx(i, j) += xx;
  votes.xy(i, j) += xy;
  votes.yy(i, j) += yy;
}

/// asin(s) / s up to 45 degrees, to a ten-thousandth.
double arc_over_sine(double s) {
  const double s2 = s * s;
  return 1 + s2 * (1.0 / 6 + s2 * (3.0 / 40 + s2 * (15.0 / 336 + s2 * 105.0 / 3456)));
}

/// What one pixel of a contour says about the places around it: the direction across the arc that starts along the
/// contour and leads there. Short and straight arcs say more. An arc and its contour share their circle, so what the
/// two ends of a torn ring say agrees on that ring.
void vote(const Pixel& from, double across_x, double across_y, double reach_px, Products& votes) {
  const int window = ceil_int(2.5 * reach_px);
  for (int j = std::max(0, from.j - window); j <= std::min(votes.xx.height - 1, from.j + window); ++j)
    for (int i = std::max(0, from.i - window); i <= std::min(votes.xx.width - 1, from.i + window); ++i) {
      const double x = i - from.i, y = j - from.j, way2 = x * x + y * y;
      if (way2 > 6.25 * reach_px * reach_px) continue;
      const double out = x * across_x + y * across_y, along = y * across_x - x * across_y;
      if (std::abs(out) > std::abs(along)) continue;  // the chord turns from the contour by more than 45 degrees
      // The chord turns from the contour by an angle of this sine and cosine, the arc by twice that.
      const double way = std::sqrt(way2), sine = way > 0 ? out / way : 0, cosine = way > 0 ? std::abs(along) / way : 1;
      const double length = way * arc_over_sine(sine), bend = way > 0 ? 2 * sine / way * reach_px : 0;
      const double weight = own::exp(-0.5 * (length * length / (reach_px * reach_px) + bend * bend));
      const double turn_cos = cosine * cosine - sine * sine, turn_sin = (along < 0 ? 2 : -2) * sine * cosine;
      const double nx = across_x * turn_cos - across_y * turn_sin, ny = across_x * turn_sin + across_y * turn_cos;
      add_vote(votes, i, j, weight, {nx, ny});
    }
}

Products votes_of(const Slice& contour, const SliceVectors& normal, double reach_px) {
  const Slice zero(contour.width, contour.height);
  Products votes{zero, zero, zero};
  for (int j = 0; j < contour.height; ++j)
    for (int i = 0; i < contour.width; ++i)
      if (contour(i, j) > 0) vote({i, j}, normal.x(i, j), normal.y(i, j), reach_px, votes);
  return votes;
}

/// What the prior makes each pixel of a contour say: that the contour goes on along the circle or ellipse of the family
/// that runs through the pixel, however the contour bends there.
void add_votes_of(const Conic& prior, const Slice& contour, double reach_px, double weight, Products& votes) {
  constexpr double thickness_px = 0.7;
  const int window = ceil_int(2.5 * reach_px);
  for (int pj = 0; pj < contour.height; ++pj)
    for (int pi = 0; pi < contour.width; ++pi) {
      if (!(contour(pi, pj) > 0)) continue;
      const double member = prior.level(pi, pj);
      for (int j = std::max(0, pj - window); j <= std::min(contour.height - 1, pj + window); ++j)
        for (int i = std::max(0, pi - window); i <= std::min(contour.width - 1, pi + window); ++i) {
          const Eigen::Vector2d slope = prior.slope(i, j);
          const double slope2 = slope.squaredNorm();
          if (!(slope2 > 0)) continue;
          const double off = (prior.level(i, j) - member) / (std::sqrt(slope2) * thickness_px);
          if (off * off > 16) continue;
          const double x = (i - pi) / reach_px, y = (j - pj) / reach_px;
          const double vote = weight * own::exp(-0.5 * (off * off + x * x + y * y)) / slope2;
          add_vote(votes, i, j, vote, slope);
        }
    }
}

/// Tangents that only the pixels of the contour decide on. The gradient at the end of a contour points along it, so
/// the image's own tangents would lie across every gap. Pixels are steps, so their tangents are first set right by what
/// the others say about them; as arcs are voted for, the ends of a curve do not lag behind it.
Tensor extended_tangents_of(const Slice& contour, const ContourCompletion& o, const std::optional<Conic>& prior) {
  const double reach_px = 2 * o.tensor_sigma_px;
  const Tensor own = tensor_of(in_window(products_of(contour, o.gradient_sigma_px), o.tensor_sigma_px / 3));
  const Tensor right = tensor_of(votes_of(contour, own.normal, reach_px));
  Products votes = votes_of(contour, right.normal, reach_px);
  if (prior && o.prior_weight > 0) {
    const float kept = 1 - o.prior_weight;
    for (Slice* s : {&votes.xx, &votes.xy, &votes.yy})
      for (float& v : s->values) v *= kept;
    add_votes_of(*prior, contour, 2 * reach_px, o.prior_weight, votes);
  }
  return tensor_of(votes);
}

/// Scharr's weights beside the centre line: the smallest error of direction a 3x3 difference can have.
constexpr double scharr_side = 3.0 / 16, scharr_middle = 10.0 / 16;

struct Lattice {
  int width, height;
  std::size_t at(int i, int j) const { return std::clamp(j, 0, height - 1) * width + std::clamp(i, 0, width - 1); }
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
  for (std::size_t n = 0; n < u.size(); ++n) s.values[n] = u[n];
  return s;
}

/// Where most speaks for a contour becomes a minor edge when it is hot enough. The heat says that a place is joined to
/// the contour, not where the contour runs: it leaks along every step of its pixels.
void add_bridges(const CompletedContour& c, const ContourCompletion& o, EdgeMap& map, int k) {
  constexpr double least_share = 0.2;  // of the strength on the contour itself: less is said by chance
  const Slice &heat = c.heat, &strength = c.strength;
  double sum = 0, count = 0;
  for (int j = 0; j < heat.height; ++j)
    for (int i = 0; i < heat.width; ++i)
      if (map.edges(i, j, k)) sum += strength(i, j), count += 1;
  const double least = count > 0 ? least_share * sum / count : 0;
  for (int j = 0; j < heat.height; ++j)
    for (int i = 0; i < heat.width; ++i) {
      const float x = c.normal.x(i, j), y = c.normal.y(i, j);
      if (map.edges(i, j, k) || heat(i, j) < o.complete_level || strength(i, j) < least ||
          !is_ridge(strength, i, j, x, y))
        continue;
      map.edges(i, j, k) = minor_edge;
      if (!map.offsets) continue;
      const RidgeOffset offset = ridge_offset(strength, i, j, x, y);
      map.offsets->x_px(i, j, k) = offset.x;
      map.offsets->y_px(i, j, k) = offset.y;
    }
}

}  // namespace

Slice diffuse_along_contours(const Slice& image, const ContourCompletion& o, const std::optional<Conic>& prior) {
  const Lattice lattice{image.width, image.height};
  Values u(image.values.begin(), image.values.end());
  Tensor t = tangents_of(image, o, prior);
  for (int step = 0; step < o.steps; ++step) {
    if (o.refresh > 0 && step > 0 && step % o.refresh == 0)
      t = tangents_of(to_slice(u, image.width, image.height), o, prior);
    flow(u, t, lattice, o.step);
  }
  return to_slice(u, image.width, image.height);
}

CompletedContour complete_contour(const Slice& contour, const ContourCompletion& o, const std::optional<Conic>& prior) {
  const Lattice lattice{contour.width, contour.height};
  Values u(contour.values.begin(), contour.values.end());
  const Tensor t = extended_tangents_of(contour, o, prior);
  for (int step = 0; step < o.steps; ++step) {
    flow(u, t, lattice, o.step);
    for (std::size_t n = 0; n < u.size(); ++n)
      if (contour.values[n] > 0) u[n] = 1;
  }
  return {to_slice(u, contour.width, contour.height), t.normal, t.strength};
}

EdgeMap detect_edges(const Image& image, const ContourCompletion& options) {
  ContourCompletion o = options;
  check_options(o, "acc");
  require_finite(image);
  if (o.prior_x_px.has_value() != o.prior_y_px.has_value())
    throw OptionError("options acc.prior_x_px and acc.prior_y_px belong together; expected both or neither");
  EdgeMap map;
  if (o.complete || o.prior != ContourPrior::none) map = detect_edges(image, o.canny);
  const auto prior_of = [&](int k) {
    return o.prior == ContourPrior::none ? std::nullopt : fit_conics(components_of_slice(map.edges, k), o);
  };
  if (o.complete) {
    for_each_slice(image.grid, [&](int k) {
      Slice contour(image.grid.dims[0], image.grid.dims[1]);
      for (int j = 0; j < contour.height; ++j)
        for (int i = 0; i < contour.width; ++i) contour(i, j) = map.edges(i, j, k) ? 1.0F : 0.0F;
      add_bridges(complete_contour(contour, o, prior_of(k)), o, map, k);
    });
    return map;
  }
  Image diffused(image.grid);
  for_each_slice(image.grid,
                 [&](int k) { put_slice(diffuse_along_contours(slice_of(image, k), o, prior_of(k)), diffused, k); });
  return detect_edges(diffused, o.canny);
}

}  // namespace dynasurf::image
