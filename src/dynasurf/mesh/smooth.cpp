#include "dynasurf/mesh/smooth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::mesh {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;
// A vertex reaches its centroid in at most so many steps, however short `step_mm` is.
constexpr double kShortestShare = 1e-4;

using Ring = std::span<const std::uint32_t>;

/// The turn around a vertex: the angles of its fan, added as products of complex numbers, which needs no arc function
/// per angle. `re` and `im` hold the angle's direction, `half_turns` how often the sum passed a multiple of pi.
struct Turn {
  double re = 1, im = 0;
  int half_turns = 0;

  /// Adds the angle in [0, pi] whose cosine and sine are in the ratio of `c` and `s`; 0/0 adds nothing.
  void add(double c, double s) {
    if (c == 0 && s == 0) return;
    const bool upper = is_upper();
    const double r = re * c - im * s;
    im = re * s + im * c;
    re = r;
    half_turns += is_upper() != upper ? 1 : 0;
  }
  /// Keeps products of many factors from overflow.
  void rescale() {
    const double size = std::abs(re) + std::abs(im);
    if (size > 1e60 || (size < 1e-60 && size > 0)) re /= size, im /= size;
  }
  double angle() const {
    // Direction above the real axis: the sum is in an even half turn, below: in an odd one.
    const double within = own::atan2(is_upper() ? im : -im, is_upper() ? re : -re);
    return half_turns * std::numbers::pi + within;
  }
  bool is_upper() const { return (im > 0) | ((im == 0) & (re > 0)); }
};

Turn turn_around(const Vec3& centre, std::span<const Vec3> p, Ring ring) {
  Turn turn;
  int added = 0;
  Vec3 previous = p[ring.back()] - centre;
  for (const std::uint32_t n : ring) {
    const Vec3 next = p[n] - centre;
    turn.add(previous.dot(next), previous.cross(next).norm());
    if (++added % 8 == 0) turn.rescale();
    previous = next;
  }
  return turn;
}

/// Tells peaks from flat places. Nearly all vertices are flat: their turn ends close to the positive real axis, just
/// before or after one full turn, which a product shows; only the others need the angle itself.
class PeakTest {
 public:
  explicit PeakTest(double tolerance_rad)
      : tolerance_(tolerance_rad), slope_(tolerance_rad < std::numbers::pi / 2 ? own::tan(tolerance_rad) : -1) {}

  bool operator()(const Vec3& centre, std::span<const Vec3> p, Ring ring) const {
    const Turn turn = turn_around(centre, p, ring);
    const bool near_full_turn = turn.is_upper() ? turn.half_turns == 2 : turn.half_turns == 1;
    if (near_full_turn && turn.re > 0 && std::abs(turn.im) <= slope_ * turn.re) return false;
    return std::abs(turn.angle() - kFullTurn) > tolerance_;
  }

 private:
  double tolerance_, slope_;
};

/// The triangles around each vertex, as the side opposite to it.
struct OppositeSides {
  std::vector<std::uint32_t> first;
  std::vector<std::array<std::uint32_t, 2>> side;
};

OppositeSides opposite_sides(const TriMesh& mesh) {
  OppositeSides result;
  result.first.assign(mesh.vertices.size() + 1, 0);
  for (const auto& t : mesh.triangles)
    for (const std::uint32_t v : t) ++result.first[v + 1];
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.side.resize(mesh.triangles.size() * 3);
  std::vector<std::uint32_t> next = result.first;
  for (const auto& t : mesh.triangles)
    for (std::size_t c = 0; c < 3; ++c) result.side[next[t[c]]++] = {t[(c + 1) % 3], t[(c + 2) % 3]};
  return result;
}

/// Appends the neighbours in the order of the fan; appends nothing unless the fan is closed and single.
void append_ring(std::span<const std::array<std::uint32_t, 2>> sides, std::vector<std::uint32_t>& ring) {
  if (sides.size() < 3) return;
  const std::size_t start = ring.size();
  std::uint32_t at = sides[0][0];
  for (std::size_t taken = 0; taken < sides.size(); ++taken) {
    const auto side = std::find_if(sides.begin(), sides.end(), [&](const auto& s) { return s[0] == at; });
    if (side == sides.end()) break;
    ring.push_back(at);
    at = (*side)[1];
    if (at == sides[0][0]) break;
  }
  if (at != sides[0][0] || ring.size() - start != sides.size()) ring.resize(start);
}

enum class Outcome { untouched, moved, at_centroid };

Outcome smooth_vertex(Vec3& position, std::span<const Vec3> p, Ring ring, const PeakTest& is_peak,
                      const Smoothing& options, double step_mm) {
  if (!is_peak(position, p, ring)) return Outcome::untouched;
  Vec3 centroid = Vec3::Zero();
  for (const std::uint32_t n : ring) centroid += p[n];
  centroid /= ring.size();
  const Vec3 start = position, way = centroid - start;
  const double length = way.norm();
  if (!(length > 0)) return Outcome::untouched;

  const double share_step = std::max(options.literal_step ? step_mm : step_mm / length, kShortestShare);
  for (int s = 1;; ++s) {
    const double share = std::min(s * share_step, 1.0);
    position = start + share * way;
    if (!is_peak(position, p, ring)) return Outcome::moved;
    if (share >= 1) return Outcome::at_centroid;
  }
}

}  // namespace

VertexRings vertex_rings(const TriMesh& mesh) {
  const OppositeSides opposite = opposite_sides(mesh);
  VertexRings rings;
  rings.first.reserve(mesh.vertices.size() + 1);
  rings.neighbours.reserve(opposite.side.size());
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    rings.first.push_back(rings.neighbours.size());
    append_ring(std::span(opposite.side).subspan(opposite.first[v], opposite.first[v + 1] - opposite.first[v]),
                rings.neighbours);
  }
  rings.first.push_back(rings.neighbours.size());
  return rings;
}

std::vector<double> angle_deficits(const TriMesh& mesh) {
  const VertexRings rings = vertex_rings(mesh);
  std::vector<double> deficit(mesh.vertices.size(), 0.0);
  for (std::uint32_t v = 0; v < deficit.size(); ++v)
    if (const Ring ring = rings.of(v); !ring.empty())
      deficit[v] = kFullTurn - turn_around(mesh.vertices[v], mesh.vertices, ring).angle();
  return deficit;
}

SmoothReport smooth(std::span<Vec3> vertices, const VertexRings& rings, std::span<const std::uint32_t> movable,
                    const Smoothing& options, double smallest_spacing_mm) {
  const double step_mm = options.step_mm > 0 ? options.step_mm : smallest_spacing_mm / 20;
  const PeakTest is_peak(options.tolerance_rad);
  SmoothReport report;
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    report = {};
    for (const std::uint32_t v : movable) {
      const Ring ring = rings.of(v);
      if (ring.empty()) continue;
      const Outcome outcome = smooth_vertex(vertices[v], vertices, ring, is_peak, options, step_mm);
      report.moved += outcome != Outcome::untouched ? 1 : 0;
      report.at_centroid += outcome == Outcome::at_centroid ? 1 : 0;
    }
    if (report.moved == 0) break;
  }
  return report;
}

SmoothReport smooth(TriMesh& mesh, const Smoothing& options, double smallest_spacing_mm,
                    const std::vector<std::uint8_t>& pinned) {
  Smoothing checked = options;
  check_options(checked, "smooth");
  std::vector<std::uint32_t> movable;
  movable.reserve(mesh.vertices.size());
  for (std::uint32_t v = 0; v < mesh.vertices.size(); ++v)
    if (v >= pinned.size() || pinned[v] == 0) movable.push_back(v);
  return smooth(mesh.vertices, vertex_rings(mesh), movable, options, smallest_spacing_mm);
}

}  // namespace dynasurf::mesh
