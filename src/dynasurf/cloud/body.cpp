#include "dynasurf/cloud/detail/body.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "dynasurf/cloud/detail/triangle_marks.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/submesh.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::cloud {
namespace {

/// Of a surface from marching cubes: closed, manifold, all vertices in use.
BodyTopology kind_of(const TriMesh& mesh) {
  std::uint32_t parts = 0;
  mesh::components_of(mesh, parts);
  const int count = parts, euler = std::ssize(mesh.vertices) - std::ssize(mesh.triangles) / 2;
  return {count, count - euler / 2};
}

}  // namespace

TriMesh body_surface(const IndicatorField& field, double level, std::span<const Vec3> points, double smallest_share) {
  TriMesh mesh = mesh::marching_cubes(field.value, level);
  for (Vec3& p : mesh.vertices) p = field.origin + field.side * p;
  return without_small_parts(std::move(mesh), points, smallest_share);
}

TriMesh without_small_parts(TriMesh mesh, std::span<const Vec3> points, double smallest_share) {
  std::uint32_t count = 0;
  const std::vector<std::uint32_t> part = mesh::components_of(mesh, count);
  if (count <= 1) return mesh;
  constexpr std::size_t samples = 4000;
  const std::size_t step = std::max<std::size_t>(1, points.size() / samples);
  std::vector<std::uint32_t> nearest((points.size() + step - 1) / step);
  const mesh::ClosestPoint closest(mesh);
  parallel_for(nearest.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) nearest[i] = part[closest(points[i * step]).triangle];
  });
  std::vector<std::size_t> speakers(count, 0);
  for (const std::uint32_t p : nearest) ++speakers[p];
  std::vector<std::uint8_t> kept(count, 0);
  const auto most = std::max_element(speakers.begin(), speakers.end()) - speakers.begin();
  for (std::size_t p = 0; p < count; ++p) kept[p] = speakers[p] >= smallest_share * nearest.size() && speakers[p] > 0;
  kept[most] = 1;
  std::vector<std::uint8_t> marks(part.size());
  for (std::size_t t = 0; t < part.size(); ++t) marks[t] = kept[part[t]];
  return mesh::submesh(mesh, marks);
}

namespace {

constexpr double nudge = 0.1;  // the field runs from -0.5 to 0.5

/// Looks for the body in fields from coarse to fine. Each `take_` says whether it found one; the last one stands.
class BodySearch {
 public:
  BodySearch(const std::vector<IndicatorField>& fields, std::span<const Vec3> points, const Options& options)
      : fields_(fields), points_(points), rule_(options.genus), share_(options.smallest_part_percent / 100) {}

  std::optional<Body> taken;

  /// The finest that is as asked for, else the simplest: coarse fields hold fewer handles, true or not.
  bool take_finest(const std::optional<BodyTopology>& wanted) {
    for (std::size_t i = fields_.size(); i > 0;) {
      --i;
      TriMesh mesh = surface(fields_[i], 0);
      if (mesh.triangles.empty()) continue;
      const BodyTopology kind = kind_of(mesh);
      const bool suits = rule_ == GenusRule::keep || (rule_ == GenusRule::zero && kind.genus == 0) ||
                         (rule_ == GenusRule::automatic && (!wanted || kind == *wanted) && is_firm(i, kind, 0, nudge));
      if (suits || !taken || kind.genus < taken->genus || (kind.genus == taken->genus && kind.parts < taken->parts))
        take(i, std::move(mesh), kind);
      if (suits) return true;
    }
    return false;
  }

  /// The finest from field `first` on that is of this kind at a level a little higher or lower.
  bool take_near(const BodyTopology& kind, std::size_t first) {
    for (std::size_t i = fields_.size(); i-- > first;)
      for (const double level : {0.0, -nudge, nudge, -2 * nudge, 2 * nudge}) {
        TriMesh mesh = surface(fields_[i], level);
        if (mesh.triangles.empty() || kind_of(mesh) != kind) continue;
        take(i, std::move(mesh), kind);
        return true;
      }
    return false;
  }

  /// The finest whose surface is firm at another level, the nearest one: noise breaks a thin wall in many places, but a
  /// little farther out it is whole.
  bool take_firm() {
    constexpr double step = 0.5 * nudge;
    for (std::size_t i = fields_.size(); i > 0;) {
      --i;
      for (int steps = 1; steps <= 6; ++steps)
        for (const double level : {-step * steps, step * steps}) {
          TriMesh mesh = surface(fields_[i], level);
          const BodyTopology kind = kind_of(mesh);
          if (mesh.triangles.empty() || !is_firm(i, kind, level, step)) continue;
          take(i, std::move(mesh), kind);
          return true;
        }
    }
    return false;
  }

  /// The kind of the body that is expected, else whichever is firm.
  bool take_as_asked(const std::optional<BodyTopology>& expected) {
    if (take_finest(expected)) return true;
    if (rule_ != GenusRule::automatic) return false;
    if (expected) {
      if (take_near(*expected, 0)) return true;
      taken.reset();
      if (take_finest({})) return true;
    }
    return take_firm();
  }

  /// A finer field may hold the same kind at another level.
  void refine() {
    if (taken) take_near({taken->parts, taken->genus}, from_ + 1);
  }

  /// Cut on a coarser lattice, where the two sides of a cut stand well apart.
  bool cut_handles() {
    IndicatorField cut = without_handles(fields_.size() > 1 ? fields_[fields_.size() - 2] : taken->field);
    TriMesh mesh = surface(cut, 0);
    const BodyTopology kind = kind_of(mesh);
    if (kind.genus != 0) return false;
    taken = Body{std::move(mesh), kind.parts, 0, true, std::move(cut)};
    return true;
  }

 private:
  TriMesh surface(const IndicatorField& field, double level) const {
    return body_surface(field, level, points_, share_);
  }
  void take(std::size_t i, TriMesh mesh, const BodyTopology& kind) {
    taken = Body{std::move(mesh), kind.parts, kind.genus, false, fields_[i]};
    from_ = i;
  }
  bool is_firm(std::size_t i, const BodyTopology& kind, double level, double width) const {
    std::array<std::uint8_t, 2> is_same{};
    parallel_for(2, 1, [&](std::size_t n, std::size_t) {
      is_same[n] = kind_of(surface(fields_[i], n == 0 ? level + width : level - width)) == kind;
    });
    return is_same[0] && is_same[1];
  }

  const std::vector<IndicatorField>& fields_;
  std::span<const Vec3> points_;
  GenusRule rule_;
  double share_;
  std::size_t from_ = 0;  // which field `taken` comes from
};

/// A body with negative volume is what it seems to be a cavity of: sides were found within something that was dropped
/// since, such as a floor. Its field is turned with it, so that directions outwards are right too.
void turn_outwards(Body& body) {
  if (mesh::volume_mm3(body.mesh) < 0) turn(body);
}

}  // namespace

void turn(Body& body) {
  for (auto& [a, b, c] : body.mesh.triangles) std::swap(b, c);
  for (float& v : body.field.value.values) v = -v;
}

void turn_upwards(Body& body) {
  constexpr double flat = 0.8, level = 0.3;
  const Vec3 facing = facing_of(body.mesh);
  if (facing.norm() > flat && facing[2] < -level * facing.norm()) turn(body);
}

Body choose_body(const std::vector<IndicatorField>& fields, std::span<const Vec3> points, const Options& options,
                 Notes& notes, const std::optional<BodyTopology>& expected) {
  const TraceStage noted("inside: body");
  BodySearch search(fields, points, options);
  bool as_asked = search.take_as_asked(expected);
  search.refine();
  if (search.taken && !as_asked && options.genus == GenusRule::zero) as_asked = search.cut_handles();
  if (!search.taken) throw InputError("the points of the cloud enclose nothing");
  Body body = std::move(*search.taken);
  turn_outwards(body);
  if (!as_asked)
    notes.push_back(
        {Severity::warning, "cloud.handles",
         "the points do not tell how many handles the surface has; it was given " + std::to_string(body.genus)});
  return body;
}

double firmness_of(std::span<const IndicatorField> fields, std::span<const Vec3> points, double smallest_share,
                   const BodyTopology& kind, double reach) {
  constexpr std::array<double, 5> levels{0, -0.1, 0.1, -0.2, 0.2};
  constexpr double most_passed_by = 0.02;
  enum class Says : std::uint8_t { same, other, nothing };
  std::vector<Says> says(levels.size() * std::min<std::size_t>(fields.size(), 2));
  parallel_for(says.size(), 1, [&](std::size_t n, std::size_t) {
    const IndicatorField& field = fields[fields.size() - 1 - n / levels.size()];
    const double level = levels[n % levels.size()];
    const TriMesh mesh = body_surface(field, level, points, smallest_share);
    if (!mesh.triangles.empty() && kind_of(mesh) == kind)
      says[n] = Says::same;
    else
      says[n] = share_passed_by(field, level, points, reach) > most_passed_by ? Says::nothing : Says::other;
  });
  const double same = std::count(says.begin(), says.end(), Says::same);
  const double other = std::count(says.begin(), says.end(), Says::other);
  return same + other > 0 ? same / (same + other) : 1;
}

double share_passed_by(const IndicatorField& field, double level, std::span<const Vec3> points, double reach) {
  constexpr std::size_t samples = 4000;
  std::vector<Vec3> probes;
  for (int a = 0; a < 3; ++a)
    for (const double to : {-reach, reach}) probes.push_back(to * Vec3::Unit(a));
  for (int n = 0; n < 8; ++n)
    probes.push_back(reach * Vec3(n & 1 ? 1 : -1, n & 2 ? 1 : -1, n & 4 ? 1 : -1).normalized());
  const std::size_t step = std::max<std::size_t>(1, points.size() / samples), asked = points.size() / step;
  const double passed_by = parallel_sum(asked, 256, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3& p = points[i * step];
      const bool is_inside = value_at(field, p) > level;
      sum += std::all_of(probes.begin(), probes.end(),
                         [&](const Vec3& probe) { return (value_at(field, p + probe) > level) == is_inside; });
    }
    return sum;
  });
  return asked > 0 ? passed_by / asked : 0;
}

}  // namespace dynasurf::cloud
