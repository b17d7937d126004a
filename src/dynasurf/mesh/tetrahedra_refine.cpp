#include <algorithm>
#include <map>
#include <string>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"

namespace dynasurf::mesh {
namespace {

using Tetrahedron = std::array<std::uint32_t, 4>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;  // lower number first

Edge edge_of(const Tetrahedron& t, std::size_t a, std::size_t b) { return std::minmax(t[a], t[b]); }

/// Cuts tetrahedra at marked edges. Edges have one order in the whole solid, by length and then by number, and every
/// tetrahedron is cut at its marked edges in that order: so two that share a face cut it alike.
class Bisection {
 public:
  explicit Bisection(const TetMesh& solid) : solid_(solid), result_{solid.vertices, {}} {}

  void mark_longest(const Tetrahedron& t) {
    mark(longest(t, [](const Edge&) { return true; }));
  }

  /// Marks the longest edge of every tetrahedron that has a marked one; whether there was one to mark.
  bool spread() {
    const std::size_t before = middle_.size();
    for (const Tetrahedron& t : solid_.tetrahedra)
      if (is_cut(t)) mark_longest(t);
    return middle_.size() > before;
  }

  TetMesh cut() {
    for (auto& [edge, middle] : middle_) {
      middle = result_.vertices.size();
      result_.vertices.push_back((solid_.vertices[edge.first] + solid_.vertices[edge.second]) / 2);
    }
    for (const Tetrahedron& t : solid_.tetrahedra) cut(t);
    return std::move(result_);
  }

 private:
  bool is_marked(const Edge& edge) const { return middle_.contains(edge); }
  void mark(const Edge& edge) { middle_.try_emplace(edge, 0); }
  bool is_cut(const Tetrahedron& t) const {
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        if (is_marked(edge_of(t, a, b))) return true;
    return false;
  }
  bool is_longer(const Edge& a, const Edge& b) const {
    const auto length2 = [&](const Edge& e) {
      return (solid_.vertices[e.first] - solid_.vertices[e.second]).squaredNorm();
    };
    const double x = length2(a), y = length2(b);
    return x != y ? x > y : a < b;
  }
  template <class Counts>
  Edge longest(const Tetrahedron& t, Counts counts) const {
    Edge best{0, 0};
    for (std::size_t a = 0; a < 4; ++a)
      for (std::size_t b = a + 1; b < 4; ++b)
        if (const Edge e = edge_of(t, a, b); counts(e) && (best.first == best.second || is_longer(e, best))) best = e;
    return best;
  }
  void cut(const Tetrahedron& t) {
    // New edges are not marked, and only ends of edges that are whole are numbers of the solid.
    if (!is_cut(t)) {
      result_.tetrahedra.push_back(t);
      return;
    }
    const Edge edge = longest(t, [&](const Edge& e) { return is_marked(e); });
    Tetrahedron one = t, other = t;
    std::replace(one.begin(), one.end(), edge.first, middle_.at(edge));
    std::replace(other.begin(), other.end(), edge.second, middle_.at(edge));
    cut(one);
    cut(other);
  }

  const TetMesh& solid_;
  TetMesh result_;
  std::map<Edge, std::uint32_t> middle_;  // of every marked edge, the number of its middle
};

/// The shares of the four corners of a tetrahedron in a place; below 0 beyond the opposite face.
Eigen::Vector4d shares_of(const TetMesh& solid, const Tetrahedron& t, const Vec3& place) {
  Mat3 edges;
  for (int k = 0; k < 3; ++k) edges.col(k) = solid.vertices[t[k + 1]] - solid.vertices[t[0]];
  const Vec3 share = edges.inverse() * (place - solid.vertices[t[0]]);
  return {1 - share.sum(), share[0], share[1], share[2]};
}

}  // namespace

TetMesh refined(const TetMesh& solid, std::span<const std::uint32_t> marked) {
  Bisection bisection(solid);
  for (const std::uint32_t n : marked) {
    if (n >= solid.tetrahedra.size()) throw InputError("refined: there is no tetrahedron " + std::to_string(n));
    bisection.mark_longest(solid.tetrahedra[n]);
  }
  while (bisection.spread()) {
  }
  return bisection.cut();
}

std::vector<Vec3> carried(const TetMesh& cage, std::span<const Vec3> moved, std::span<const Vec3> places) {
  if (cage.tetrahedra.empty()) throw InputError("carried: the cage has no tetrahedra");
  if (moved.size() != cage.vertices.size())
    throw InputError("carried: " + std::to_string(moved.size()) +
                     " displacements; expected one for each of the cage's " + std::to_string(cage.vertices.size()) +
                     " vertices");
  std::vector<Vec3> result(places.size());
  parallel_for(places.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      Eigen::Vector4d best = Eigen::Vector4d::Constant(0);
      const Tetrahedron* holder = nullptr;
      for (const Tetrahedron& t : cage.tetrahedra) {
        const Eigen::Vector4d shares = shares_of(cage, t, places[p]);
        if (holder == nullptr || shares.minCoeff() > best.minCoeff()) best = shares, holder = &t;
      }
      result[p] = Vec3::Zero();
      for (std::size_t c = 0; c < 4; ++c) result[p] += best[c] * moved[(*holder)[c]];
    }
  });
  return result;
}

}  // namespace dynasurf::mesh
