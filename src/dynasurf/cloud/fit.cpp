#include "dynasurf/cloud/detail/fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <Eigen/LU>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/relax.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/simplify.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t fit_grain = 1024;
using Places = std::vector<Vec3>;

/// A vertex of a boundary, and those before and after it. It moves across the surface only, or the boundary would
/// creep.
struct RimVertex {
  std::uint32_t vertex, before, after;
  Vec3 normal = Vec3::Zero();
  Vec3 across(const Vec3& x) const { return x.dot(normal) * normal; }
};

/// Rows of neighbours of each vertex, one after the other, and of the triangles around it.
struct Rows {
  std::vector<std::uint32_t> first, neighbour, triangle;
  std::vector<RimVertex> rim;
  std::vector<std::uint8_t> is_rim;  // per vertex

  double neighbours(std::size_t vertex) const { return first[vertex + 1] - first[vertex]; }
};

/// Around a vertex of a boundary one neighbour is only the next corner of a triangle, and one only the corner before.
void find_rim(const TriMesh& mesh, Rows& r) {
  r.is_rim.assign(mesh.vertices.size(), 0);
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v) {
    std::int64_t after_less_before = 0;
    const auto before = [&](std::uint32_t i) {
      const auto& t = mesh.triangles[r.triangle[i]];
      return t[0] == v ? t[2] : t[1] == v ? t[0] : t[1];
    };
    for (std::uint32_t i = r.first[v]; i < r.first[v + 1]; ++i)
      after_less_before += r.neighbour[i] - std::int64_t{before(i)};
    if (after_less_before == 0) continue;
    r.is_rim[v] = 1;
    RimVertex rim{v, v, v};
    for (std::uint32_t i = r.first[v]; i < r.first[v + 1]; ++i) {
      bool goes_on = false, came = false;
      for (std::uint32_t k = r.first[v]; k < r.first[v + 1]; ++k) {
        goes_on |= before(k) == r.neighbour[i];
        came |= r.neighbour[k] == before(i);
      }
      if (!goes_on) rim.after = r.neighbour[i];
      if (!came) rim.before = before(i);
    }
    r.rim.push_back(rim);
  }
}

Rows rows_of(const TriMesh& mesh) {
  Rows r;
  r.first.assign(mesh.vertices.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++r.first[v + 1];
  for (std::size_t v = 0; v + 1 < r.first.size(); ++v) r.first[v + 1] += r.first[v];
  r.neighbour.resize(r.first.back());
  r.triangle.resize(r.first.back());
  std::vector<std::uint32_t> at(r.first.begin(), r.first.end() - 1);
  // On a closed surface every neighbour is the next corner of exactly one triangle.
  for (std::uint32_t n = 0; n < mesh.triangles.size(); ++n)
    for (std::size_t c = 0; c < 3; ++c) {
      const auto& t = mesh.triangles[n];
      r.triangle[at[t[c]]] = n;
      r.neighbour[at[t[c]]++] = t[(c + 1) % 3];
    }
  find_rim(mesh, r);
  return r;
}

/// x - mean of the neighbours; on a boundary, of those along it, and across the surface only.
void bend(const Rows& rows, const Places& x, Places& y) {
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (rows.is_rim[v]) continue;
    Vec3 sum = Vec3::Zero();
    for (std::uint32_t i = rows.first[v]; i < rows.first[v + 1]; ++i) sum += x[rows.neighbour[i]];
    y[v] = x[v] - sum / rows.neighbours(v);
  }
  for (const RimVertex& r : rows.rim) y[r.vertex] = r.across(x[r.vertex] - 0.5 * (x[r.before] + x[r.after]));
}

/// The transpose of `bend`, added with a factor.
void add_bent_back(const Rows& rows, const Places& x, double factor, Places& y) {
  for (std::size_t v = 0; v < x.size(); ++v) {
    if (rows.is_rim[v]) continue;
    const Vec3 whole = factor * x[v], part = whole / rows.neighbours(v);
    y[v] += whole;
    for (std::uint32_t i = rows.first[v]; i < rows.first[v + 1]; ++i) y[rows.neighbour[i]] -= part;
  }
  for (const RimVertex& r : rows.rim) {
    const Vec3 whole = factor * r.across(x[r.vertex]);
    y[r.vertex] += whole;
    y[r.before] -= 0.5 * whole;
    y[r.after] -= 0.5 * whole;
  }
}

/// The pull of all points on the corners of one triangle: six blocks (00 01 02 11 12 22) and the right side.
struct PointPull {
  std::array<Mat3, 6> block;
  std::array<Vec3, 3> right;
};

class Fit {
 public:
  Fit(TriMesh& mesh, const FitPoints& to, const FitOptions& options)
      : mesh_(mesh), to_(to), o_(options), rows_(rows_of(mesh)), on_(to.points.size()) {}

  /// One round; returns the mean distance before it.
  double round() {
    const double mean = find_nearest();
    gather(mean);
    const Places before = mesh_.vertices;
    solve();
    shorten_bad_moves(before);
    return mean;
  }

 private:
  Vec3 normal(std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return (mesh_.vertices[b] - mesh_.vertices[a]).cross(mesh_.vertices[c] - mesh_.vertices[a]).normalized();
  }

  /// Of all triangles at first; then, as the moves are small, of those around the place where it was. A few triangles
  /// move far, and are asked all.
  double find_nearest() {
    constexpr std::size_t few = 1000;
    std::optional<mesh::ClosestPoint> closest;
    const bool is_first = on_.front().triangle == mesh::SurfacePoint::none;
    if (is_first || mesh_.triangles.size() <= few) closest.emplace(mesh_);
    return parallel_sum(on_.size(), fit_grain,
                        [&](std::size_t begin, std::size_t end) {
                          double sum = 0;
                          for (std::size_t i = begin; i < end; ++i) {
                            // Where it was, or where the point before it is, is a good guess.
                            const std::uint32_t guess = on_[!is_first || i == begin ? i : i - 1].triangle;
                            on_[i] = closest ? closest->from_guess(to_.points[i], guess) : follow(to_.points[i], guess);
                            sum += std::sqrt(on_[i].distance2);
                          }
                          return sum;
                        }) /
           on_.size();
  }

  mesh::SurfacePoint nearest_in(const Vec3& p, std::uint32_t t) const {
    const auto& [a, b, c] = mesh_.triangles[t];
    return mesh::closest_on_triangle(p, mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c], t);
  }

  /// The nearest place from triangle to triangle, starting in one, until none around is nearer.
  mesh::SurfacePoint follow(const Vec3& p, std::uint32_t triangle) const {
    mesh::SurfacePoint best = nearest_in(p, triangle);
    for (bool any = true; any && *std::min_element(best.weights.begin(), best.weights.end()) <= 0;) {
      any = false;
      const auto corner = std::max_element(best.weights.begin(), best.weights.end()) - best.weights.begin();
      const std::uint32_t v = mesh_.triangles[best.triangle][corner];
      for (std::uint32_t i = rows_.first[v]; i < rows_.first[v + 1]; ++i) {
        const mesh::SurfacePoint other = nearest_in(p, rows_.triangle[i]);
        if (other.distance2 < best.distance2) best = other, any = true;
      }
    }
    return best;
  }

  void gather(double mean) {
    // Points in the order of their triangles, so that triangles can be worked on apart.
    std::vector<std::uint32_t> first(mesh_.triangles.size() + 1, 0), order(on_.size());
    for (const mesh::SurfacePoint& s : on_) ++first[s.triangle + 1];
    for (std::size_t t = 0; t + 1 < first.size(); ++t) first[t + 1] += first[t];
    std::vector<std::uint32_t> at(first.begin(), first.end() - 1);
    for (std::uint32_t i = 0; i < on_.size(); ++i) order[at[on_[i].triangle]++] = i;
    pulls_.resize(mesh_.triangles.size());
    const double share = 1.0 * mesh_.vertices.size() / on_.size();
    // Means suit noise better than medians do; distances beyond it are shape that the triangles cannot follow.
    const double soft = 0.25 * mean * mean + 4 * o_.noise * o_.noise + 1e-18;
    parallel_for(pulls_.size(), 256, [&](std::size_t begin, std::size_t end) {
      for (std::size_t t = begin; t < end; ++t) {
        PointPull& pull = pulls_[t];
        pull.block.fill(Mat3::Zero());
        pull.right.fill(Vec3::Zero());
        const Vec3 facing = normal(t);
        for (std::uint32_t i = first[t]; i < first[t + 1]; ++i) add_point(pull, order[i], facing, share, soft);
      }
    });
  }

  void add_point(PointPull& pull, std::uint32_t i, const Vec3& facing, double share, double soft) const {
    constexpr double along = 0.02;  // the share of the pull along the surface
    if (!to_.normals.empty() && to_.normals[i].dot(facing) < -0.2) return;
    const mesh::SurfacePoint& s = on_[i];
    const auto& t = mesh_.triangles[s.triangle];
    const Vec3 place =
        s.weights[0] * mesh_.vertices[t[0]] + s.weights[1] * mesh_.vertices[t[1]] + s.weights[2] * mesh_.vertices[t[2]];
    Vec3 across = to_.points[i] - place;
    const double distance = across.norm();
    const bool is_within = std::min({s.weights[0], s.weights[1], s.weights[2]}) > 0;
    across = is_within || !(distance > 0) ? facing : Vec3(across / distance);
    const double weight = share * std::sqrt(soft / (s.distance2 + soft));
    const Mat3 pulling = weight * ((1 - along) * across * across.transpose() + along * Mat3::Identity());
    const Vec3 target = pulling * to_.points[i];
    std::size_t e = 0;
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t b = a; b < 3; ++b) pull.block[e++] += s.weights[a] * s.weights[b] * pulling;
      pull.right[a] += s.weights[a] * target;
    }
  }

  /// y = (pulls + hold and smoothness) x
  void apply(const Places& x, Places& y) const {
    std::fill(y.begin(), y.end(), Vec3::Zero());
    for (std::size_t t = 0; t < pulls_.size(); ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const auto& m = pulls_[t].block;
      y[a] += m[0] * x[a] + m[1] * x[b] + m[2] * x[c];
      y[b] += m[1] * x[a] + m[3] * x[b] + m[4] * x[c];
      y[c] += m[2] * x[a] + m[4] * x[b] + m[5] * x[c];
    }
    Places bent(x.size());
    bend(rows_, x, bent);
    Places again(x.size());
    bend(rows_, bent, again);
    // The bend's own bend: a surface that curves evenly costs nothing.
    add_bent_back(rows_, bent, o_.hold, y);
    Places back(x.size(), Vec3::Zero());
    add_bent_back(rows_, again, o_.smoothness, back);
    add_bent_back(rows_, back, 1, y);
    for (std::size_t v = 0; v < x.size(); ++v) y[v] += 1e-6 * x[v];
    keep_rim(y);
  }

  void keep_rim(Places& x) const {
    for (const RimVertex& r : rows_.rim) x[r.vertex] = r.across(x[r.vertex]);
  }

  void find_normals_of_rim() {
    for (RimVertex& r : rows_.rim) {
      Vec3 sum = Vec3::Zero();
      for (std::uint32_t i = rows_.first[r.vertex]; i < rows_.first[r.vertex + 1]; ++i)
        sum += normal(rows_.triangle[i]);
      r.normal = sum.norm() > 0 ? Vec3(sum.normalized()) : Vec3::Zero();
    }
  }

  /// Solves for the moves by conjugate gradients with the vertices' own blocks as preconditioner.
  void solve() {
    const std::size_t n = mesh_.vertices.size();
    find_normals_of_rim();
    Places r(n), x(n, Vec3::Zero()), z(n), p(n, Vec3::Zero()), q(n);
    // The right side is what pulls at the surface as it is; `hold` works on moves only.
    std::fill(r.begin(), r.end(), Vec3::Zero());
    std::vector<Mat3> own(n, Mat3(Mat3::Identity() * (1.2 * o_.hold + 1.4 * o_.smoothness + 1e-6)));
    for (std::size_t t = 0; t < pulls_.size(); ++t) {
      const auto& [a, b, c] = mesh_.triangles[t];
      const auto& m = pulls_[t].block;
      const auto& at = mesh_.vertices;
      r[a] += pulls_[t].right[0] - m[0] * at[a] - m[1] * at[b] - m[2] * at[c];
      r[b] += pulls_[t].right[1] - m[1] * at[a] - m[3] * at[b] - m[4] * at[c];
      r[c] += pulls_[t].right[2] - m[2] * at[a] - m[4] * at[b] - m[5] * at[c];
      own[a] += m[0];
      own[b] += m[3];
      own[c] += m[5];
    }
    Places bent(n), again(n), back(n, Vec3::Zero());
    bend(rows_, mesh_.vertices, bent);
    bend(rows_, bent, again);
    add_bent_back(rows_, again, -o_.smoothness, back);
    add_bent_back(rows_, back, 1, r);
    keep_rim(r);
    for (Mat3& m : own) m = m.inverse().eval();
    const auto dot = [n](const Places& a, const Places& b) {
      double sum = 0;
      for (std::size_t v = 0; v < n; ++v) sum += a[v].dot(b[v]);
      return sum;
    };
    double rz = 0, enough = 0;
    for (int k = 0; k < o_.iterations; ++k) {
      for (std::size_t v = 0; v < n; ++v) z[v] = own[v] * r[v];
      keep_rim(z);
      const double rz_new = dot(r, z);
      if (k == 0) enough = 1e-8 * rz_new;
      if (!(rz_new > enough)) break;
      for (std::size_t v = 0; v < n; ++v) p[v] = z[v] + (k == 0 ? 0 : rz_new / rz) * p[v];
      rz = rz_new;
      apply(p, q);
      const double alpha = rz / dot(p, q);
      for (std::size_t v = 0; v < n; ++v) {
        x[v] += alpha * p[v];
        r[v] -= alpha * q[v];
      }
    }
    for (std::size_t v = 0; v < n; ++v) mesh_.vertices[v] += x[v];
  }

  void shorten_bad_moves(const Places& before) {
    constexpr int halvings = 6;
    const double least = own::sin(o_.smallest_angle_deg * std::numbers::pi / 180);
    const double turn = own::cos(o_.largest_turn_deg * std::numbers::pi / 180);
    std::vector<std::uint8_t> is_bad(before.size());
    for (int k = 0;; ++k) {
      std::fill(is_bad.begin(), is_bad.end(), std::uint8_t{0});
      bool any = false;
      for (const auto& t : mesh_.triangles) {
        const Vec3 &a = before[t[0]], &b = before[t[1]], &c = before[t[2]];
        const Vec3 &x = mesh_.vertices[t[0]], &y = mesh_.vertices[t[1]], &z = mesh_.vertices[t[2]];
        const Vec3 old = (b - a).cross(c - a), now = (y - x).cross(z - x);
        const double sine = mesh::sine_of_smallest_angle(x, y, z);
        const bool turned = old.dot(now) < turn * old.norm() * now.norm();
        if (!turned && (sine >= least || sine >= mesh::sine_of_smallest_angle(a, b, c))) continue;
        any = true;
        for (const std::uint32_t v : t) is_bad[v] = 1;
      }
      if (!any) return;
      // In the end all that is left goes back, and with it, ring after ring, what depended on it.
      const double keep = k < halvings ? 0.5 : 0;
      for (std::size_t v = 0; v < before.size(); ++v)
        if (is_bad[v]) mesh_.vertices[v] = before[v] + keep * (mesh_.vertices[v] - before[v]);
    }
  }

  TriMesh& mesh_;
  const FitPoints& to_;
  const FitOptions& o_;
  Rows rows_;
  std::vector<mesh::SurfacePoint> on_;
  std::vector<PointPull> pulls_;
};

}  // namespace

double fit(mesh::SurfaceEditor& surface, const FitPoints& to, const FitOptions& options) {
  if (to.points.empty()) return 0;
  std::vector<std::uint32_t> slots;
  const TriMesh start = surface.mesh(&slots);
  const auto take_over = [&](const TriMesh& mesh) {
    for (std::size_t v = 0; v < slots.size(); ++v) surface.position(slots[v]) = mesh.vertices[v];
  };
  const auto rounds = [&](const auto& after_each) {
    TriMesh mesh = start;
    Fit fitting(mesh, to, options);
    double mean = 0;
    for (int k = 0; k < options.rounds; ++k) {
      mean = fitting.round();
      after_each(mesh);
    }
    take_over(mesh);
    return mean;
  };
  const double mean = rounds([](const TriMesh&) {});
  if (mesh::self_intersections(surface.mesh()).free()) return mean;
  take_over(start);
  // Seldom so: then each round answers for itself.
  return rounds([&](TriMesh& mesh) {
    const std::vector<Vec3> safe(surface.positions().begin(), surface.positions().end());
    take_over(mesh);
    if (mesh::revert_self_intersections(surface, safe) > 0)
      for (std::size_t v = 0; v < slots.size(); ++v) mesh.vertices[v] = surface.position(slots[v]);
  });
}

double mean_distance(const mesh::SurfaceEditor& surface, std::span<const Vec3> points) {
  const TriMesh mesh = surface.mesh();
  const mesh::ClosestPoint closest(mesh);
  return parallel_sum(points.size(), fit_grain,
                      [&](std::size_t begin, std::size_t end) {
                        double sum = 0;
                        for (std::size_t i = begin; i < end; ++i) sum += std::sqrt(closest(points[i]).distance2);
                        return sum;
                      }) /
         std::max<std::size_t>(1, points.size());
}

}  // namespace dynasurf::cloud
