#include "dynasurf/cloud/detail/support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dynasurf/cloud/detail/feet.hpp"
#include "dynasurf/cloud/detail/unfaced.hpp"
#include "dynasurf/cloud/detail/words.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t samples = 20000, sample_grain = 256;

// What right results of the bank (experiments/cloud_bank) stay within.
constexpr double most_made_up = 0.01, farthest_made_up = 0.05, most_points_off = 0.02, most_left_out = 0.001,
                 most_turned = 0.01, most_thin = 0.02, most_biased = 0.02, least_firm = 0.55;

/// How many times farther apart than usual the points are around one of them, from 1 to 4.
double sparseness(const KdTree& cloud, const Vec3& point, double spacing) {
  constexpr double most = 4;
  return spacing > 0 ? std::clamp(spacing_around(cloud, point) / spacing, 1.0, most) : 1;
}

double confidence_of(const Vec3& place, const SupportingPoints& of, double& distance) {
  const KdTree::Found nearest = of.tree.nearest(place);
  distance = std::sqrt(nearest.distance2);
  const double usual = supported_within(of.facts);
  if (distance <= usual) return 1;
  const double within = usual * sparseness(of.tree, of.points[nearest.index], of.facts.spacing);
  return std::min(1.0, within / distance);
}

void measure_area(const TriMesh& mesh, const SupportingPoints& of, CloudSupport& support) {
  const std::vector<mesh::SurfaceSample> places = mesh::sample_surface(mesh, samples);
  if (places.empty()) return;
  std::vector<double> confidence(places.size()), distance(places.size());
  parallel_for(places.size(), sample_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      confidence[i] = confidence_of(mesh::position_of(mesh, places[i]), of, distance[i]);
  });
  const double count = places.size();
  support.made_up = std::count_if(confidence.begin(), confidence.end(), [](double c) { return c < 1; }) / count;
  if (of.facts.diagonal > 0)
    support.made_up_largest = *std::max_element(distance.begin(), distance.end()) / of.facts.diagonal;
}

/// What the finest triangles themselves may leave out between a curved surface and its chords.
double chord_of(const TriMesh& mesh, double area) {
  constexpr double of_edge = 0.1;
  return of_edge * std::sqrt(area / std::max<std::size_t>(1, mesh.triangles.size()));
}

/// `feet` are those of every `step`-th point.
void measure_points(const Level& level, const SupportingPoints& of, std::span<const Foot> feet, std::size_t step,
                    const mesh::ClosestPoint& closest, CloudSupport& support) {
  constexpr double left_out = 0.02;  // of the diagonal
  const std::size_t asked = feet.size();
  const Facts& f = of.facts;
  const double chord = chord_of(level.mesh, level.certificate.area);
  const double explained = 3 * f.noise + 0.5 * f.spacing + 2 * chord;
  const auto share_beyond = [&](double limit) {
    const auto is_beyond = [&](const Foot& foot) { return std::abs(foot.distance) > limit; };
    return 1.0 * std::count_if(feet.begin(), feet.end(), is_beyond) / asked;
  };
  support.points_off = share_beyond(explained);
  const double limit = std::max(left_out * f.diagonal, explained);
  std::vector<std::size_t> far;
  for (std::size_t i = 0; i < asked; ++i)
    if (std::abs(feet[i].distance) > limit) far.push_back(i * step);
  support.points_left_out = 1.0 * left_out_of(far, asked, of, closest, limit) / asked;
  double sum = 0;
  for (const Foot& foot : feet) sum += std::abs(foot.distance);
  support.points_off_mean = sum / asked / std::max(0.8 * f.noise + 0.1 * f.spacing + chord, 1e-300);
}

/// A point off the surface, in the patch of the surface that it is nearest to.
struct Off {
  std::uint64_t patch;
  double distance;  // positive outside
};

/// Patches are what lies in a cube of the place's lattice and faces the same way.
std::uint64_t patch_of(const Vec3& place, const Vec3& normal, double side) {
  std::uint64_t key = 0;
  for (int a = 0; a < 3; ++a) {
    const std::int64_t cell = std::floor(place[a] / side);
    key = key * 4096 + (cell & 4095);
  }
  std::uint64_t axis = 0;
  normal.cwiseAbs().maxCoeff(&axis);
  return key * 6 + 2 * axis + (normal[axis] < 0);
}

/// Noise lies on both sides of the surface; a wall or cavity that was lost on one.
void measure_bias(std::span<const Foot> feet, const Facts& facts, CloudSupport& support) {
  constexpr double of_diagonal = 0.003, side = 0.08, sure = 3;
  constexpr std::size_t fewest = 6;
  std::vector<Off> off;
  off.reserve(feet.size());
  for (const Foot& f : feet) off.push_back({patch_of(f.place, f.normal, side * facts.diagonal), f.distance});
  std::stable_sort(off.begin(), off.end(), [](const Off& a, const Off& b) { return a.patch < b.patch; });
  std::size_t biased = 0;
  for (std::size_t first = 0, last = 0; first < off.size(); first = last) {
    double sum = 0, squares = 0;
    for (last = first; last < off.size() && off[last].patch == off[first].patch; ++last) {
      sum += off[last].distance;
      squares += off[last].distance * off[last].distance;
    }
    const double count = last - first;
    const double mean = sum / count, spread = std::sqrt(std::max(0.0, squares / count - mean * mean));
    if (last - first >= fewest && std::abs(mean) > of_diagonal * facts.diagonal + sure * spread / std::sqrt(count))
      biased += last - first;
  }
  support.biased = 1.0 * biased / feet.size();
}

/// The other side of the surface lies nearer than the points, their noise or the lattice tell apart: through the body,
/// as of a wall, or through the space outside, as of a gap.
void measure_thin(const Level& level, const SupportingPoints& of, const mesh::ClosestPoint& closest,
                  CloudSupport& support) {
  constexpr double of_noise = 4, of_spacing = 1.5, of_cell = 1.5;
  enum class Other : std::uint8_t { none, inside, outside };
  const TriMesh& mesh = level.mesh;
  const double thin = std::max({of_noise * of.facts.noise, of_spacing * of.facts.spacing, of_cell * support.cell});
  const std::vector<mesh::SurfaceSample> places = mesh::sample_surface(mesh, samples / 4);
  if (places.empty()) return;
  std::vector<Other> others(places.size(), Other::none);
  parallel_for(places.size(), sample_grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Vec3 facing = normal_of(mesh, places[i].triangle), place = mesh::position_of(mesh, places[i]);
      const auto faces_another = [&](double along) {  // from half way the other side is the nearer one
        const mesh::SurfacePoint other = closest(place + along * facing);
        return other.distance2 < 0.9 * along * along && normal_of(mesh, other.triangle).dot(facing) < -0.5;
      };
      others[i] = faces_another(0.5 * thin) ? Other::outside : faces_another(-0.5 * thin) ? Other::inside : Other::none;
    }
  });
  const double count = places.size(), walls = std::count(others.begin(), others.end(), Other::inside);
  support.gaps = std::count(others.begin(), others.end(), Other::outside) / count;
  support.thin = support.gaps + walls / count;
}

}  // namespace

std::span<const std::string_view> names_of(Verdict) {
  static constexpr std::array<std::string_view, 3> names{"ok", "check", "fail"};
  return names;
}

double supported_within(const Facts& facts) { return 3 * facts.spacing + 3 * facts.noise; }

std::vector<float> confidences(const TriMesh& mesh, const SupportingPoints& cloud) {
  std::vector<float> values(mesh.vertices.size());
  parallel_for(values.size(), sample_grain, [&](std::size_t begin, std::size_t end) {
    double distance = 0;
    for (std::size_t v = begin; v < end; ++v) values[v] = confidence_of(mesh.vertices[v], cloud, distance);
  });
  return values;
}

void measure_support(std::span<Level> levels, const SupportingPoints& cloud, CloudSupport& support) {
  const Level& finest = levels.front();
  support.within = supported_within(cloud.facts);
  if (finest.mesh.triangles.empty() || cloud.points.empty()) return;
  const mesh::ClosestPoint closest(finest.mesh);
  const std::size_t step = std::max<std::size_t>(1, cloud.points.size() / samples);
  const std::vector<Foot> feet = feet_of(cloud.points, step, finest.mesh, closest);
  measure_area(finest.mesh, cloud, support);
  measure_points(finest, cloud, feet, step, closest, support);
  measure_bias(feet, cloud.facts, support);
  measure_thin(finest, cloud, closest, support);
  if (finest.certificate.boundary_loops > 0) return;  // its ends are open
  const double spacing = cloud.facts.spacing * std::sqrt(1.0 * step);
  const UnfacedParts unfaced = unfaced_parts(finest.mesh, feet, spacing, cloud.facts.noise);
  support.unfaced_points = unfaced.points;
  for (Level& level : levels) doubt_unfaced(unfaced, level.mesh, level.confidence);
}

bool is_watertight(const Result& result) {
  return !result.levels.empty() && std::all_of(result.levels.begin(), result.levels.end(),
                                               [](const Level& level) { return level.certificate.watertight(); });
}

bool is_sound(const Result& result, const Level& level) {
  const Certificate& c = level.certificate;
  return result.facts.boundary == BoundaryRule::close ? c.watertight() : c.sound_open();
}

Verdict verdict_of(const Result& result) {
  const auto has = [&](Severity severity) {
    return std::any_of(result.notes.begin(), result.notes.end(), [&](const Note& n) { return n.severity == severity; });
  };
  const bool all_sound =
      !result.levels.empty() && std::all_of(result.levels.begin(), result.levels.end(),
                                            [&](const Level& level) { return is_sound(result, level); });
  if (!all_sound || has(Severity::failure)) return Verdict::fail;
  return has(Severity::warning) ? Verdict::check : Verdict::ok;
}

std::size_t left_out_of(std::span<const std::size_t> far, std::size_t asked, const SupportingPoints& cloud,
                        const mesh::ClosestPoint& closest, double limit) {
  constexpr std::size_t neighbours = 6, enough = 3;
  constexpr double near_by = 5, surface = 0.005;
  const double within = near_by * cloud.facts.spacing + 3 * cloud.facts.noise;
  enum class Company : std::uint8_t { none, loose, close };
  std::vector<Company> companies(far.size());
  parallel_for(far.size(), sample_grain, [&](std::size_t begin, std::size_t end) {
    std::array<KdTree::Found, 1 + neighbours> found;  // itself first
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t n = cloud.tree.nearest(cloud.points[far[i]], found);
      std::size_t as_far = 0, close = 0;
      for (std::size_t k = 1; k < n; ++k) {
        if (!(closest(cloud.points[found[k].index]).distance2 > limit * limit)) continue;
        ++as_far;
        close += found[k].distance2 <= within * within;
      }
      companies[i] = close >= enough ? Company::close : as_far >= enough ? Company::loose : Company::none;
    }
  });
  const std::size_t close = std::count(companies.begin(), companies.end(), Company::close),
                    loose = std::count(companies.begin(), companies.end(), Company::loose);
  return close + loose > surface * asked ? close + loose : close;
}

Notes doubts_of(const CloudSupport& s, bool is_open) {
  Notes notes;
  const auto warn = [&](bool is_doubtful, const char* code, const std::string& message) {
    if (is_doubtful) notes.push_back({Severity::warning, code, message});
  };
  warn(s.made_up > most_made_up || s.made_up_largest > farthest_made_up, "cloud.holes",
       "the surface goes as far as " + percent(s.made_up_largest) + " of the diagonal away from all points; " +
           percent(s.made_up) + " of it has none nearby and is made up");
  warn(s.points_off > most_points_off, "cloud.points_off",
       percent(s.points_off) + " of the points lie farther from the surface than noise and triangles explain");
  warn(s.points_left_out > most_left_out, "cloud.left_out",
       percent(s.points_left_out) +
           " of the points lie farther than 2.0 % of the diagonal from the surface, which "
           "leaves them out");
  warn(s.biased > most_biased, "cloud.biased",
       percent(s.biased) + " of the points lie together on one side of the surface: walls or cavities are lost");
  warn(s.turned > most_turned, "cloud.directions",
       "the surface runs against the direction found for " + percent(s.turned) + " of the points");
  warn(s.unfaced_points >= UnfacedParts::fewest_points, "cloud.cut_off",
       "a part of the surface that ought to hold " + std::to_string(std::lround(s.unfaced_points)) +
           " points has none that faces its way: a limb or a rim may be cut off there");
  const bool has_gaps = s.gaps > most_thin;
  warn(
      has_gaps, "cloud.gaps",
      percent(s.gaps) +
          " of the surface has another part of it nearer than the points tell apart, across a gap: the two may be one");
  // Of a closed wall the points show both sides; what came out open may be a thin body that is closed.
  if (s.thin > most_thin && !has_gaps)
    notes.push_back({is_open ? Severity::warning : Severity::info, "cloud.thin",
                     percent(s.thin) + " of the surface has its other side nearer than the points tell apart: " +
                         (is_open ? "the body may be closed and thin" : "walls there are thin")});
  warn(s.firm < least_firm, "cloud.handles",
       "only " + percent(s.firm) + " of the surfaces around the chosen one have its parts and handles");
  return notes;
}

}  // namespace dynasurf::cloud
