#include "dynasurf/cloud/reconstruct_cloud.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dynasurf/cloud/detail/body.hpp"
#include "dynasurf/cloud/detail/deform_start.hpp"
#include "dynasurf/cloud/detail/dimension.hpp"
#include "dynasurf/cloud/detail/flat_lids.hpp"
#include "dynasurf/cloud/detail/free_sides.hpp"
#include "dynasurf/cloud/detail/holes.hpp"
#include "dynasurf/cloud/detail/kept_stages.hpp"
#include "dynasurf/cloud/detail/level_chain.hpp"
#include "dynasurf/cloud/detail/levels.hpp"
#include "dynasurf/cloud/detail/open_surface.hpp"
#include "dynasurf/cloud/detail/prepare.hpp"
#include "dynasurf/cloud/detail/support.hpp"
#include "dynasurf/cloud/detail/thesis_recipe.hpp"
#include "dynasurf/cloud/detail/triangle_marks.hpp"
#include "dynasurf/cloud/detail/words.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/intersections.hpp"

namespace dynasurf::cloud {
namespace {

/// The frame the levels are made in: the cloud's diagonal is 1, its middle 0.
struct UnitFrame {
  Vec3 middle;
  double diagonal;
  explicit UnitFrame(const std::vector<Vec3>& points) {
    Eigen::AlignedBox3d box;
    for (const Vec3& p : points) box.extend(p);
    middle = box.center();
    diagonal = box.diagonal().norm();
  }
  Vec3 in(const Vec3& p) const { return (p - middle) / diagonal; }
  Vec3 out(const Vec3& p) const { return middle + diagonal * p; }
};

/// Bodies of the experiments reach 2.3 with noise of 1 % of the diagonal and 2.55 with 3 %; points at random 2.75.
void check_surface(std::span<const Vec3> points, Notes& notes) {
  constexpr double most = 2.65;
  const double dimension = smallest_dimension(points);
  if (dimension > most)
    notes.push_back({Severity::failure, "cloud.no_surface",
                     "the points fill space (dimension " + std::to_string(dimension).substr(0, 4) +
                         ") instead of lying on a surface (2); the meshes are made up"});
}

/// As fine as the points allow and the triangles ask for.
int cells_for(const Facts& facts, const std::vector<Vec3>& points, const Options& options, int triangles) {
  if (options.cells) return *options.cells;
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points) box.extend(p);
  const double finest = std::max(1.4 * facts.spacing, 2 * facts.noise);
  const double useful = std::clamp(1.2 * std::sqrt(triangles), 64.0, 256.0);
  return std::clamp(box.sizes().maxCoeff() / std::max(finest, 1e-300), 16.0, std::floor(useful));
}

void tell(const HoleFill& fill, LidRule lid, Notes& notes) {
  std::string what = "parts of the surface lie far from all points: ";
  if (fill.holes > 0)
    what += number(fill.holes, "hole was", "holes were") + (lid == LidRule::flat ? " closed flat" : " closed smoothly");
  if (fill.holes > 0 && fill.joined > 0) what += ", ";
  if (fill.joined > 0) what += number(fill.joined, "pair of open ends was", "pairs of open ends were") + " joined";
  notes.push_back({Severity::info, "cloud.holes", what});
}

/// What the inside is found from. Noise is taken off first: within four times its size most of the points around are of
/// the same side of a wall, and many enough to tell a plane.
OrientedPoints oriented_points(const PreparedCloud& p, const Options& options, double cell) {
  constexpr double wide = 4;
  constexpr std::size_t fewest = 16, most = 100;
  PointCloud thin = voxel_downsample(p.cloud, cell);
  if (!is_noisy(p.facts)) return orient(thin, options.use_normals);
  const double around = std::numbers::pi * own::pow(wide * p.facts.noise / p.facts.spacing, 2);
  const std::size_t ring = std::clamp<double>(around, fewest, most);
  project_to_local_planes(thin, p.cloud.points, p.neighbours, ring);
  OrientedPoints oriented = orient(voxel_downsample(thin, cell), options.use_normals, 14);
  smooth_normals(oriented);
  return oriented;
}

OpenSurface cut_open(const PreparedCloud& p, const IndicatorField& field, const OrientedPoints& fill, double reach,
                     const Options& options) {
  return open_surface(
      field, {p.cloud.points, p.neighbours, p.facts}, fill,
      {.reach = reach, .margin = 0.5 * p.facts.spacing, .smallest_share = options.smallest_part_percent / 100});
}

/// The surface that is open where the points end, as `rule` says; nothing where they hold all of it.
std::optional<Body> open_body(const PreparedCloud& p, IndicatorField field, const OrientedPoints& fill, double reach,
                              BoundaryRule rule, bool has_directions, const Options& options, Result& result) {
  const OpenSurface open = cut_open(p, field, fill, reach, options);
  if (open.loops == 0) {
    if (options.boundary != BoundaryRule::automatic)
      result.notes.push_back({Severity::info, "cloud.boundary", "the points hold all of the surface: it is closed"});
    return std::nullopt;
  }
  result.facts.boundary = rule;
  result.facts.boundary_loops = open.loops;
  Body body{open.mesh, open.parts, open.genus, false, std::move(field)};
  if (!has_directions) turn_upwards(body);
  return body;
}

/// Puts flat lids in the place of smooth ones. False, and the body is as it was, where they would cross the surface or
/// change its parts or handles.
bool put_flat_lids(FoundBody& found, const HoleFill& fill, const PreparedCloud& p, double reach,
                   const Options& options) {
  OrientedPoints points = first_of(fill.points, fill.on_tubes);
  const OpenSurface open = cut_open(p, found.body.field, points, reach, options);
  if (open.parts != found.body.parts || open.genus != found.body.genus) return false;
  ClosedSurface closed = with_flat_lids(open.mesh);
  if (!mesh::self_intersections(closed.mesh).free()) return false;
  append(points, closed.added);
  found.body.mesh = std::move(closed.mesh);
  found.fill = std::move(points);
  return true;
}

void tell_choice(double one_way, bool is_open, Notes& notes) {
  notes.push_back({Severity::info, "cloud.boundary",
                   std::string("boundary=auto took ") + (is_open ? "keep, an open surface" : "close") +
                       ": what the points face adds up to " + percent(one_way) +
                       " of their area (0 % for a closed body, 100 % for a plane), " + (is_open ? "not" : "and") +
                       " less than " + percent(open_from)});
}

/// The directions of the points, the fields that they lead to, and what closes those fields' holes.
struct Inside {
  OrientedPoints oriented;
  std::vector<IndicatorField> fields;
  std::optional<HoleFill> fill;
  bool is_open() const { return fill && fill->is_open; }
};

FoundBody find_body(const PreparedCloud& p, const Options& options, int cells, Result& result,
                    const Progress& progress) {
  Eigen::AlignedBox3d box;
  for (const Vec3& q : p.cloud.points) box.extend(q);
  const double side = box.sizes().maxCoeff() / cells;
  const bool noisy = is_noisy(p.facts);
  const double thin_cell = std::max(0.5 * side, noisy ? 2 * p.facts.noise : 0);
  const double reach = 2.5 * std::max(p.facts.spacing, thin_cell) + 2 * p.facts.noise;
  const auto look_inside = [&](OrientedPoints points) {
    progress.check();
    Inside in{std::move(points), {}, {}};
    in.fields = solve_indicator(in.oriented, {.cells = cells}, progress);
    if (options.boundary != BoundaryRule::trim)
      in.fill = fill_holes(in.fields.back(), in.oriented,
                           {.reach = reach,
                            .spacing = 0.7 * side,
                            .smallest_share = options.smallest_part_percent / 100,
                            .may_join = options.genus != GenusRule::zero,
                            .boundary = options.boundary});
    return in;
  };
  Inside in = look_inside(oriented_points(p, options, thin_cell));
  const bool has_directions = (options.use_normals && !p.cloud.normals.empty()) || in.oriented.is_seen;
  if (options.boundary == BoundaryRule::automatic && in.is_open() && !has_directions)
    if (auto turned = turned_to_free_sides(in.oriented, 2 * thin_cell))
      if (Inside other = look_inside(std::move(*turned)); !other.is_open()) in = std::move(other);
  auto& [oriented, fields, fill] = in;
  result.facts.cells = cells;
  result.support.cell = side;
  if (fill && options.boundary == BoundaryRule::automatic) tell_choice(fill->one_way, fill->is_open, result.notes);
  const bool gets_flat_lids = options.lid == LidRule::flat && fill && !fill->is_open && fill->holes > 0;
  if (fill && (!fill->is_open || fill->holes > 0)) {
    if (!gets_flat_lids) tell(*fill, LidRule::smooth, result.notes);
    append(oriented, fill->points);
    progress.check();
    fields = solve_indicator(oriented, {.cells = cells}, progress);
  }
  result.support.turned = share_turned(oriented, fields.back());
  const bool is_asked = options.boundary == BoundaryRule::keep || options.boundary == BoundaryRule::trim;
  if (is_asked || (fill && fill->is_open)) {
    const BoundaryRule rule = options.boundary == BoundaryRule::trim ? BoundaryRule::trim : BoundaryRule::keep;
    const OrientedPoints& in_holes = fill ? fill->points : OrientedPoints{};
    if (auto body = open_body(p, fields.back(), in_holes, reach, rule, has_directions, options, result))
      return {std::move(*body), in_holes, side, {}};
  }
  const std::optional<BodyTopology> expected = fill && !fill->is_open ? std::optional(fill->kind) : std::nullopt;
  // Shares are of the scanned points: thinned ones stand for areas, and few strays on a wide floor for a large one.
  Body body = choose_body(fields, p.cloud.points, options, result.notes, expected);
  FoundBody found{std::move(body), fill ? fill->points : OrientedPoints{}, side, std::move(fields)};
  if (gets_flat_lids) {
    const bool are_flat = put_flat_lids(found, *fill, p, reach, options);
    tell(*fill, are_flat ? LidRule::flat : LidRule::smooth, result.notes);
    if (!are_flat)
      result.notes.push_back({Severity::warning, "cloud.lid",
                              "flat lids would cross the surface or change its parts or handles; smooth ones were "
                              "taken"});
  }
  return found;
}

/// The mesh that becomes the levels, in the frame of `fine`, the surface that was found.
TriMesh started(const TriMesh& fine, int genus, CloudStart start, bool is_open, Notes& notes,
                const Progress& progress) {
  if (start == CloudStart::automatic || start == CloudStart::field) return fine;
  if (is_open) {
    notes.push_back({Severity::warning, "cloud.start", "an open surface starts from the field's own surface only"});
    return fine;
  }
  if (genus > 0)
    notes.push_back({Severity::warning, "cloud.start",
                     "the points show " + number(genus, "handle", "handles") + ", and a start of shape " +
                         std::string(word_of(start)) + " has none"});
  TriMesh mesh = deform_start(fine, start, progress);
  if (mesh::self_intersections(mesh).free()) return mesh;
  notes.push_back({Severity::warning, "cloud.start",
                   "the starts around the parts of the body run into each other; the field's surface was taken"});
  return fine;
}

/// The points lie farther off the surface that was found than noise and lattice explain: of a wall about as thin as the
/// noise one side may be lost, and with it the cavity behind.
void tell_lost(const Fitting& fitting, double side, Notes& notes) {
  constexpr std::size_t samples = 5000;
  const std::size_t step = std::max<std::size_t>(1, fitting.scanned.size() / samples);
  std::vector<double> off(fitting.scanned.size() / step);
  parallel_for(off.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) off[i] = std::sqrt(fitting.on_fine(fitting.scanned[i * step]).distance2);
  });
  const double noise = fitting.facts.noise / fitting.facts.diagonal;
  // Normal noise leaves points 0.8 deviations off on the mean; what noise hides of the surface itself adds little.
  const double mean_limit = 1.3 * 0.8 * noise;
  const double mean = std::accumulate(off.begin(), off.end(), 0.0) / off.size();
  if (is_noisy(fitting.facts) && mean > mean_limit)
    notes.push_back({Severity::warning, "cloud.left_out",
                     "the points lie " + percent(mean) +
                         " of the diagonal off the surface on the mean, more than their noise explains: thin walls or "
                         "cavities are lost"});
  constexpr double far_share = 0.05;
  const double limit = (2.5 * fitting.facts.noise + side) / fitting.facts.diagonal;
  const auto far = std::count_if(off.begin(), off.end(), [&](double d) { return d > limit; });
  const double share = 1.0 * far / off.size();
  if (!is_noisy(fitting.facts) && share > far_share)
    notes.push_back({Severity::warning, "cloud.left_out",
                     percent(share) + " of the points lie farther than " + percent(limit) +
                         " of the diagonal from the surface: thin walls or cavities are lost"});
}

/// Points without surface nearby: a component too small to keep, clustered outliers, or strays among points.
void tell_left_out(const SupportingPoints& of, Result& result) {
  constexpr double far = 0.05;  // of the diagonal
  const Level& finest = result.levels.front();
  const double limit = far * finest.certificate.cloud_diagonal;
  if (finest.certificate.cloud_to_mesh_largest <= limit) return;
  const mesh::ClosestPoint closest(finest.mesh);
  std::vector<std::uint8_t> is_far(of.points.size());
  parallel_for(is_far.size(), 1024, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) is_far[i] = closest(of.points[i]).distance2 > limit * limit;
  });
  std::vector<std::size_t> far_off;
  for (std::size_t i = 0; i < is_far.size(); ++i)
    if (is_far[i]) far_off.push_back(i);
  const int together = left_out_of(far_off, of.points.size(), of, closest, limit);
  if (together > 0)
    result.notes.push_back({Severity::warning, "cloud.left_out",
                            number(together, "point lies", "points lie") + " farther than " + percent(far) +
                                " of the diagonal from the surface, which leaves them out"});
  note_outliers(far_off.size() - together, result.notes);
}

void add(MeasuredLevel made, Result& result) {
  result.levels.push_back(std::move(made.level));
  result.notes.insert(result.notes.end(), made.notes.begin(), made.notes.end());
}

/// The body that was kept of the same, or that is found.
FoundBody body_of(const PreparedCloud& p, const Options& options, KeptStages* kept, Result& result,
                  const Progress& progress) {
  const int cells = cells_for(p.facts, p.cloud.points, options, options.triangles.front());
  if (kept == nullptr) return find_body(p, options, cells, result, progress);
  BodyStage stage = kept->body(options_up_to(Stage::body, options) + std::to_string(cells), [&] {
    Result told = result;
    FoundBody found = find_body(p, options, cells, told, progress);
    return BodyStage{std::move(found), told.facts, told.support, std::move(told.notes)};
  });
  result.facts = stage.facts;
  result.support = stage.support;
  result.notes = std::move(stage.notes);
  return std::move(stage.found);
}

void reconstruct_fitted(const PreparedCloud& p, const Options& options, const std::vector<int>& triangles,
                        KeptStages* kept, Result& result, const Progress& progress) {
  FoundBody found = body_of(p, options, kept, result, progress);
  const Body& body = found.body;
  result.facts.parts = body.parts;
  result.facts.genus = body.genus;
  const UnitFrame frame(p.cloud.points);
  const std::size_t most = options.max_error_percent ? most_triangles_within_error : triangles.front();
  const std::size_t step = step_of_fit(plan_of(options, p.facts, most), p.cloud.points.size(), most);
  const std::size_t scanned = (p.cloud.points.size() + step - 1) / step;
  TriMesh fine = body.mesh;
  for (Vec3& v : fine.vertices) v = frame.in(v);
  using mesh::SurfaceEditor;
  const auto boundary = is_open(result.facts) ? SurfaceEditor::Boundary::kept : SurfaceEditor::Boundary::none;
  SurfaceEditor surface(started(fine, body.genus, options.start, is_open(result.facts), result.notes, progress),
                        boundary);
  std::vector<Vec3> points(scanned + found.fill.points.size()), normals(points.size());
  std::optional<mesh::ClosestPoint> on_fine;
  // One processor collapses edges, while the others look how firm the body is and prepare what the fit asks for.
  parallel_for(2, 1, [&](std::size_t task, std::size_t) {
    if (task == 0) {
      if (options.max_error_percent) return;
      lighten_for_level(surface, most, plan_of(options, p.facts, most));
      surface = SurfaceEditor(surface.mesh(), boundary);  // without the places of what is gone
      return;
    }
    if (!found.fields.empty())
      result.support.firm = firmness_of(found.fields, p.cloud.points, options.smallest_part_percent / 100,
                                        {body.parts, body.genus}, 1.5 * std::max(found.side, 2 * p.facts.noise));
    found.fields = {};
    on_fine.emplace(fine);
    parallel_for(points.size(), 1024, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const Vec3& place = i < scanned ? p.cloud.points[i * step] : found.fill.points[i - scanned];
        points[i] = frame.in(place);
        normals[i] = outwards(body.field, place);
      }
    });
  });
  const Fitting fitting{fine, *on_fine, {points, normals}, std::span(points).first(scanned), options, p.facts};
  tell_lost(fitting, found.side, result.notes);
  const auto measure = [&](TriMesh mesh, int asked) {
    for (Vec3& v : mesh.vertices) v = frame.out(v);
    return measure_level(p, result.facts, asked, std::move(mesh));
  };
  if (options.max_error_percent) {
    progress("levels", 0, 1);
    const int fewest = fewest_within(surface, fitting, *options.max_error_percent / 100, result.notes, progress);
    add(measure(surface.mesh(), fewest), result);
    progress("levels", 1, 1);
    return;
  }
  for (MeasuredLevel& made : make_levels(std::move(surface), fitting, triangles, measure, progress))
    add(std::move(made), result);
}

}  // namespace

Result reconstruct(PointCloud cloud, const Options& options, const Progress& progress, StageCache* cache) {
  check(options);
  const std::vector<int>& triangles = options.triangles;
  KeptStages* const kept = cache == nullptr ? nullptr : &cache->kept();
  if (kept != nullptr) kept->begin(cloud);
  progress("points", 0, 1);
  const auto prepare_points = [&] {
    return std::make_shared<PreparedCloud>(prepare(std::move(cloud), options, progress));
  };
  const std::shared_ptr<PreparedCloud> prepared =
      kept == nullptr ? prepare_points() : kept->points(options_up_to(Stage::points, options), prepare_points);
  progress("points", 1, 1);
  Result result;
  result.facts = prepared->facts;
  result.notes = prepared->notes;
  check_surface(prepared->cloud.points, result.notes);
  if (options.method == CloudMethod::thesis) {
    std::vector<TriMesh> meshes =
        thesis_meshes(prepared->cloud.points, triangles, options.start, result.notes, progress);
    for (std::size_t i = 0; i < meshes.size(); ++i)
      add(measure_level(*prepared, result.facts, triangles[i], std::move(meshes[i])), result);
  } else {
    reconstruct_fitted(*prepared, options, triangles, kept, result, progress);
  }
  const SupportingPoints used{prepared->cloud.points, prepared->neighbours, prepared->facts};
  tell_left_out(used, result);
  measure_support(result.levels, used, result.support);
  const Notes doubts = doubts_of(result.support, is_open(result.facts));
  result.notes.insert(result.notes.end(), doubts.begin(), doubts.end());
  result.used = kept == nullptr ? std::move(prepared->cloud) : prepared->cloud;
  return result;
}

}  // namespace dynasurf::cloud
