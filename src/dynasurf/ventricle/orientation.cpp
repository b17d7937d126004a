#include "dynasurf/ventricle/detail/orientation.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/format.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/image/intensity.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double widest_voxel_mm = 4;
constexpr double whole_wall = 0.8;  // share of the directions in which it is seen
// Of 52 studies behind a camera without their order (base excursion 12 mm) hearts on their heads had +1.5 mm and more,
// others -7.8 and less; with an excursion of 1 to 5 mm both had -4 to +3.
constexpr double turning_mm = 1, convincing_mm = -5;
constexpr double room_across_mm = 38, room_along_mm = 28;  // around the middle of the wall

double degrees_between(const Vec3& a, const Vec3& b) {
  return own::acos(std::clamp(a.normalized().dot(b.normalized()), -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Angle between the stack's normal and the axis, whichever end comes first.
double tilt_of(const Study& study, const heart::LvShell& heart) {
  const double angle = degrees_between(study.grid().direction.col(2), heart.axis);
  return std::min(angle, 180 - angle);
}

/// Whether the slices are cut by the heart's axis.
bool is_followed(const heart::Location& heart, const Orientation& o) {
  return heart.is_pointed_at || heart.is_turned || heart.contrast >= o.least_contrast;
}

SliceOrder order_of(const Study& study, const heart::LvShell& heart) {
  return study.grid().direction.col(2).dot(heart.axis) > 0 ? SliceOrder::apex_to_base : SliceOrder::base_to_apex;
}

double voxel_of(const Study& study, const Orientation& o) {
  return o.voxel_mm.value_or(std::min(widest_voxel_mm, study.grid().spacing.minCoeff()));
}

Study cut_anew(const Study& study, const heart::Location& heart, const Orientation& o, Severity severity,
               const std::string& why) {
  Study result = reorient(study, heart.cup, voxel_of(study, o));
  result.notes.push_back(
      {severity, "orientation.reoriented",
       why + format("; cut anew on voxels of %.2f mm square to the long axis (%.3f, %.3f, %.3f)",
                    result.grid().spacing[0], heart.cup.axis[0], heart.cup.axis[1], heart.cup.axis[2])});
  return result;
}

/// A stack of which the file does not say that it is another view.
Study keep_unless_contradicted(const Study& study, const heart::Location& heart, const Orientation& o) {
  const bool is_clear = is_followed(heart, o);
  const double tilt = tilt_of(study, heart.cup);
  if (tilt > o.most_tilt_deg) {
    const std::string text = format("the slices lean by %.0f degrees from square to the long axis", tilt);
    if (is_clear)
      return cut_anew(study, heart, o, study.view == View::short_axis ? Severity::warning : Severity::info, text);
    Study kept = study;
    kept.notes.push_back(
        {Severity::warning, "orientation.uncertain",
         text + format(", but the wall is not clear (contrast %.2f); the stack was kept", heart.contrast)});
    return kept;
  }
  Study kept = is_clear ? with_finer_pixels(study, heart.cup, o.widest_pixel_mm) : study;
  const SliceOrder order = order_of(study, heart.cup);
  if (kept.slice_order == SliceOrder::unknown && is_clear && heart.other_end < 0.95) {
    kept.slice_order = order;
    kept.notes.push_back({Severity::info, "study.slice_order_found",
                          std::string("the file does not tell apex from base; the shape of the wall says ") +
                              std::string(name_of(order))});
  } else if (kept.slice_order != SliceOrder::unknown && kept.slice_order != order && is_clear &&
             heart.other_end < 0.8) {
    kept.notes.push_back({Severity::warning, "orientation.ends_disagree",
                          std::string("the file says ") + std::string(name_of(kept.slice_order)) +
                              ", the shape of the wall the opposite; the file was followed"});
  }
  return kept;
}

}  // namespace

std::optional<heart::Location> locate_upright(const Study& study, const heart::LocateHints& hints) {
  constexpr double alike = 0.95, along = 0.7;
  const Image mean = heart::mean_image(study.gates);
  std::optional<heart::Location> heart = heart::locate(mean, hints);
  if (!heart || hints.axis) return heart;
  const bool is_told = study.slice_order != SliceOrder::unknown;
  const double way = study.slice_order == SliceOrder::base_to_apex ? -1 : 1;
  const double told = is_told ? way * heart->cup.axis.dot(study.grid().direction.col(2)) : 0;
  if (told > along) return heart;
  const bool is_whole = heart->ridge_share >= whole_wall;
  if (!is_whole) heart->outward_mm = heart::outward_motion_mm(study.gates, to_grid(study.grid(), heart->cup));
  const double outward_mm = heart->outward_mm.value_or(0);
  const bool is_opposite_told = told < -along;
  const bool is_moving_outwards = heart->is_believed() && outward_mm > turning_mm;
  const bool is_file_followed =
      is_opposite_told && (heart->other_end >= alike || (!is_whole && outward_mm > convincing_mm));
  if (!is_moving_outwards && !is_file_followed) return heart;
  heart::LocateHints turned = hints;
  turned.axis = -heart->cup.axis;
  if (!turned.centre_mm) turned.centre_mm = heart->cup.middle();
  std::optional<heart::Location> other = heart::locate(mean, turned);
  if (!other) return heart;
  other->outward_mm = heart->outward_mm;
  other->is_turned = heart->is_believed();
  return other;
}

void note_ends(const Study& original, const heart::Location& heart, Notes& notes) {
  constexpr double most_of_wall = 0.75;
  if (heart.is_turned && original.slice_order == SliceOrder::unknown)
    notes.push_back(
        {Severity::warning, "orientation.ends_by_motion",
         "the wall's motion told apex from base: muscle moves towards the apex as it thickens; the shape of "
         "the wall says the opposite"});
  else if (original.slice_order == SliceOrder::unknown && heart.ridge_share < most_of_wall &&
           !(heart.outward_mm && *heart.outward_mm < convincing_mm))
    notes.push_back({Severity::warning, "orientation.ends_by_shape",
                     format("only the shape of the wall, of which %.0f %% are seen, tells apex from base",
                            100 * heart.ridge_share)});
}

std::vector<psf_fit::WallPoint> wall_points(const UserOverrides& manual, const Study& study) {
  std::vector<psf_fit::WallPoint> points;
  const Grid& grid = study.grid();
  const auto add = [&](const char* name, const std::vector<double>& numbers, bool is_outer) {
    const int count = numbers.size();
    if (count % 4 != 0)
      throw OptionError(
          format("option manual.%s holds %d numbers; expected four for each point: gate,x,y,z", name, count));
    const int gates = study.gates.size();
    for (int n = 0; n < count; n += 4) {
      const double gate = numbers[n];
      if (!(gate >= 1 && gate <= gates) || gate != std::floor(gate))
        throw OptionError(format("option manual.%s names gate %g; expected gates 1 to %d", name, gate, gates));
      const Vec3 place(numbers[n + 1], numbers[n + 2], numbers[n + 3]);
      const Index3 v = voxel_of(grid, to_grid(grid, place));
      if (!grid.contains(v[0], v[1], v[2]))
        throw OptionError(format("option manual.%s names the place (%g, %g, %g); expected one inside the volume", name,
                                 place[0], place[1], place[2]));
      const int index = gate - 1;
      points.push_back({index, is_outer, place});
    }
  };
  add("endo_points", manual.endo_points, false);
  add("epi_points", manual.epi_points, true);
  return points;
}

heart::LocateHints hints_of(const UserOverrides& m) {
  heart::LocateHints hints;
  if (m.center_mm) hints.centre_mm = Vec3(m.center_mm->data());
  if (m.axis) hints.axis = Vec3(m.axis->data());
  if (hints.axis && !(hints.axis->norm() > 0))
    throw OptionError("option manual.axis has no length; expected a direction");
  return hints;
}

Grid short_axis_grid(const heart::LvShell& heart, double voxel_mm) {
  Grid grid;
  const Vec3 k = heart.axis.normalized();
  // An axis that stands upright has no horizontal direction of its own.
  const Vec3 level = k.cross(Vec3::UnitZ());
  const Vec3 i = level.norm() > 1e-3 ? Vec3(level.normalized()) : Vec3(Vec3::UnitX());
  grid.direction.col(0) = (i - i.dot(k) * k).normalized();
  grid.direction.col(2) = k;
  grid.direction.col(1) = k.cross(grid.direction.col(0));
  grid.spacing.setConstant(voxel_mm);
  const double across = 2 * (heart.radius_mm + room_across_mm);
  const double along = heart.half_length_mm + heart.base_mm + 2 * room_along_mm;
  const int side = ceil_int(across / voxel_mm) + 1;
  grid.dims = {side, side, ceil_int(along / voxel_mm) + 1};
  // From the first voxel centre to the last: the middle of the grid is the middle of the heart.
  const Vec3 extent = (Vec3(grid.dims[0], grid.dims[1], grid.dims[2]) - Vec3::Ones()) * voxel_mm;
  grid.origin = heart.middle() - grid.direction * (extent / 2);
  return grid;
}

Study reorient(const Study& study, const heart::LvShell& heart, double voxel_mm) {
  Study result = study;
  const Grid grid = short_axis_grid(heart, voxel_mm);
  for (Image& image : result.gates) image = image::resample(image, grid);
  result.view = View::short_axis;
  result.slice_order = SliceOrder::apex_to_base;
  return result;
}

Study with_finer_pixels(const Study& study, const heart::LvShell& heart, double widest_mm) {
  const Grid& old = study.grid();
  const heart::LvShell cup = to_grid(old, heart);
  Grid grid = old;
  Vec3 corner = Vec3::Zero();  // grid frame of the old stack
  // Rounding makes no pixel too wide, and columns and rows are divided alike: edges want pixels that are square.
  constexpr double rounding = 1e-6;
  const int parts = ceil_int(std::max(old.spacing[0], old.spacing[1]) / widest_mm - rounding);
  if (parts <= 1) return study;
  for (const std::size_t a : {std::size_t{0}, std::size_t{1}}) {
    const double wide = old.spacing[a];
    // Room for the heart wherever its axis runs through the stack.
    const double reach = heart.radius_mm + room_across_mm + std::abs(cup.axis[a]) * heart.half_length_mm;
    const int first = std::clamp(floor_int((cup.middle()[a] - reach) / wide), 0, old.dims[a] - 1);
    const int last = std::clamp(ceil_int((cup.middle()[a] + reach) / wide), first, old.dims[a] - 1);
    grid.spacing[a] = wide / parts;
    grid.dims[a] = parts * (last - first + 1);
    corner[a] = first * wide - (wide - grid.spacing[a]) / 2;
  }
  grid.origin = to_world(old, corner);
  Study result = study;
  for (Image& image : result.gates) image = image::resample(image, grid);
  result.notes.push_back({Severity::info, "orientation.refined",
                          format("pixels of %.2f mm were divided into pixels of %.2f mm around the heart",
                                 old.spacing[0], grid.spacing[0])});
  return result;
}

Study orient(const Study& study, const std::optional<heart::Location>& heart, const Orientation& o) {
  const bool is_square = study.view == View::short_axis || study.view == View::unknown;
  if (o.method == OrientationMethod::header) {
    if (is_square) return study;
    throw InputError("the slices are " + std::string(name_of(study.view)) +
                     " ones; expected a short-axis stack, or orientation.method = auto or data");
  }
  if (!heart) {
    if (!is_square)
      throw InputError("the slices are " + std::string(name_of(study.view)) +
                       " ones and no ventricle was found in them; expected a short-axis stack, or manual.center_mm and "
                       "manual.axis");
    return study;
  }
  if (o.method == OrientationMethod::automatic && is_square) return keep_unless_contradicted(study, *heart, o);
  const bool is_clear = is_followed(*heart, o);
  Study result =
      cut_anew(study, *heart, o, Severity::info, "the slices are " + std::string(name_of(study.view)) + " ones");
  if (!is_clear || heart->other_end > 0.95)
    result.notes.push_back({Severity::warning, "orientation.uncertain",
                            format("the long axis is uncertain: contrast of the wall %.2f, the opposite direction "
                                   "explains the image %.2f times as well",
                                   heart->contrast, heart->other_end)});
  return result;
}

}  // namespace dynasurf::ventricle
