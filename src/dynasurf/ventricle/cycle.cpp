#include "dynasurf/ventricle/detail/cycle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/format.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/ventricle/labels/detail/circle.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double room_mm = 22;  // from the middle of the wall to the coarse circle: half a thick wall and the blur
constexpr double outer_apex_mm = 14;  // from the middle of the wall at the apex to where its edge may lie
constexpr double half_wall_mm = 3;    // from the middle of the apical wall, as it is seen, to the cavity
constexpr double plane_smoothing_mm = 2.5;
// The wall thickens in systole and so gets brighter, but thins towards the valve, where it hardly does: half of its own
// systolic brightness is reached some millimetres before the muscle ends. So its end is looked for against the
// brightness of the relaxed wall, a little under the half.
constexpr double end_level = 0.45;
constexpr double least_rim_share = 0.7;

/// Brightness of the relaxed wall: that of a dim gate, and not the dimmest, which may lack counts.
double relaxed_level(std::vector<double> walls) {
  const std::size_t quarter = walls.size() / 4;
  return of_rank(std::move(walls), quarter);
}

std::string list_of(const std::vector<bool>& marked) {
  std::string text;
  for (std::size_t g = 0; g < marked.size(); ++g)
    if (marked[g]) text += (text.empty() ? "" : ", ") + std::to_string(g + 1);
  return text;
}

/// The range with what a person says about it.
SliceRange as_set(SliceRange range, const UserOverrides& manual, int slices) {
  if (manual.first_slice) range.first = std::min(*manual.first_slice - 1, slices - 1);
  if (manual.last_slice) range.last = std::min(*manual.last_slice - 1, slices - 1);
  return range;
}

/// What a slice shows around a centre: how far out its outermost edges lie, and how bright it gets, by direction.
struct RingLook {
  double seen = 0;  // share of the directions with an edge
  double radius = 0, spread = 0;
  double brightness = 0;
};

RingLook look_around(const Image& image, const Mask& edges, const Circle& circle, int k) {
  constexpr int directions = 32;
  RingLook look;
  std::vector<double> radii;
  for (int d = 0; d < directions; ++d) {
    const double angle = 2 * std::numbers::pi * d / directions;
    double outermost = 0;
    float brightest = 0;
    for (double r = 1; r <= circle.radius_px; r += 0.5) {
      const int i = round_int(circle.x_px + r * own::cos(angle));
      const int j = round_int(circle.y_px + r * own::sin(angle));
      if (!image.grid.contains(i, j, k)) break;
      brightest = std::max(brightest, image(i, j, k));
      if (edges(i, j, k) != 0) outermost = r;
    }
    look.brightness += double{brightest} / directions;
    if (outermost > 0) radii.push_back(outermost);
  }
  look.seen = 1.0 * radii.size() / directions;
  for (const double r : radii) look.radius += r / radii.size();
  for (const double r : radii) look.spread += (r - look.radius) * (r - look.radius) / radii.size();
  look.spread = std::sqrt(look.spread);
  return look;
}

}  // namespace

std::vector<double> slice_scores(const Image& image, const Mask& edges, const CoarseCircle& coarse) {
  const Circle circle = coarse_circle(image.grid, coarse);
  std::vector<RingLook> looks;
  double best = 0;
  for (int k = 0; k < image.grid.dims[2]; ++k) {
    looks.push_back(look_around(image, edges, circle, k));
    best = std::max(best, looks.back().brightness);
  }
  std::vector<double> scores;
  for (const RingLook& look : looks) {
    const double round = look.radius > 0 ? std::max(0.0, 1 - 2 * look.spread / look.radius) : 0;
    scores.push_back(best > 0 ? look.seen * round * std::min(1.0, look.brightness / (0.5 * best)) : 0);
  }
  return scores;
}

std::optional<SliceRange> longest_run(std::span<const double> scores, double least) {
  std::optional<SliceRange> longest;
  const int count = scores.size();
  for (int k = 0; k < count; ++k) {
    const int first = k;
    while (k < count && scores[k] >= least) ++k;
    if (k > first && (!longest || k - first > longest->last - longest->first + 1)) longest = SliceRange{first, k - 1};
  }
  return longest;
}

SliceRange scored_slices(const Study& study, const image::EdgeOptions& edges, const CoarseCircle& coarse,
                         const UserOverrides& manual) {
  Notes notes;
  const Image mean = image::normalise(heart::mean_image(study.gates), notes);
  const std::vector<double> scores = slice_scores(mean, image::detect_edges(mean, edges).edges, coarse);
  const int slices = mean.grid.dims[2];
  return as_set(longest_run(scores).value_or(SliceRange{0, slices - 1}), manual, slices);
}

void require_inside(const UserOverrides& manual, const Study& original, const Study& study) {
  if (const std::optional<Vec3> centre = hints_of(manual).centre_mm) {
    const Index3 v = voxel_of(original.grid(), to_grid(original.grid(), *centre));
    if (!original.grid().contains(v[0], v[1], v[2]))
      throw OptionError(format("option manual.center_mm is (%g, %g, %g); expected a place inside the volume",
                               (*centre)[0], (*centre)[1], (*centre)[2]));
  }
  wall_points(manual, original);
  const int slices = study.grid().dims[2];
  const auto require_slice = [&](const char* name, const std::optional<int>& slice) {
    if (slice && *slice > slices)
      throw OptionError(
          format("option manual.%s is %d; expected a slice of the short-axis stack, 1 to %d", name, *slice, slices));
  };
  require_slice("first_slice", manual.first_slice);
  require_slice("last_slice", manual.last_slice);
  if (manual.first_slice && manual.last_slice && *manual.first_slice > *manual.last_slice)
    throw OptionError(
        format("option manual.first_slice is %d and manual.last_slice %d; expected the first, nearer to "
               "the apex, not to lie after the last",
               *manual.first_slice, *manual.last_slice));
  const double top_mm = (slices - 1) * study.grid().spacing[2];
  if (manual.base_plane_mm && (*manual.base_plane_mm < 0 || *manual.base_plane_mm > top_mm))
    throw OptionError(format("option manual.base_plane_mm is %g; expected a height in the short-axis stack, 0 to %g mm",
                             *manual.base_plane_mm, top_mm));
}

CoarseCircle circle_around(const Study& study, const std::optional<heart::Location>& heart, const UserOverrides& manual,
                           CoarseCircle asked) {
  const double pixel = study.grid().spacing[0];
  if (heart) {
    const Vec3 middle = to_grid(study.grid(), heart->cup).middle();
    if (!asked.x_px) asked.x_px = middle[0] / pixel;
    if (!asked.y_px) asked.y_px = middle[1] / study.grid().spacing[1];
    if (!asked.radius_px) asked.radius_px = (heart->cup.radius_mm + room_mm) / pixel;
  } else if (const std::optional<Vec3> centre = hints_of(manual).centre_mm) {
    const Vec3 middle = to_grid(study.grid(), *centre);
    if (!asked.x_px) asked.x_px = middle[0] / pixel;
    if (!asked.y_px) asked.y_px = middle[1] / study.grid().spacing[1];
  }
  if (manual.radius_mm) asked.radius_px = *manual.radius_mm / pixel;
  return asked;
}

std::optional<double> expected_cavity_end(const Study& study, const std::optional<heart::Location>& heart) {
  if (!heart || !heart->is_believed()) return std::nullopt;
  const heart::LvShell cup = to_grid(study.grid(), heart->cup);
  if (cup.axis[2] <= 0) return std::nullopt;
  return (cup.apex() + half_wall_mm * cup.axis)[2] / study.grid().spacing[2];
}

heart::BasePlane level_plane(const Grid& grid, double height_mm) {
  const Vec3 middle((grid.dims[0] - 1) * grid.spacing[0] / 2, (grid.dims[1] - 1) * grid.spacing[1] / 2, height_mm);
  return to_world(grid, heart::BasePlane{middle, Vec3::UnitZ(), 0, 1});
}

namespace {

/// The valve planes that the images show, smooth over the beat; none where they are not seen.
std::vector<std::optional<heart::BasePlane>> seen_planes(const Study& study, const heart::Location& heart,
                                                         Notes& notes) {
  std::vector<std::optional<heart::BasePlane>> planes(study.gates.size());
  const heart::LvShell cup = to_grid(study.grid(), heart.cup);
  std::vector<heart::WallProfiles> walls(planes.size());
  parallel_for(planes.size(), 1, [&](std::size_t g, std::size_t) {
    walls[g] = heart::look_at_wall(image::smooth_gaussian(study.gates[g], plane_smoothing_mm), cup);
  });
  std::vector<double> over;
  over.reserve(walls.size());
  for (const heart::WallProfiles& wall : walls) over.push_back(wall.over_surroundings());
  const double relaxed = relaxed_level(over);
  for (std::size_t g = 0; g < planes.size(); ++g) {
    const double share = over[g] > 0 ? std::clamp(relaxed / over[g], least_rim_share, 1.0) : 1;
    planes[g] = heart::find_base_plane(walls[g], end_level * share);
  }
  const std::optional<heart::PlaneCycle> cycle = heart::smooth_over_cycle(planes, cup.axis);
  if (!cycle) {
    notes.push_back({Severity::warning, "base.plane_missing",
                     "the end of the wall was not seen in half of the gates; surfaces end at a slice"});
    planes.assign(planes.size(), std::nullopt);
    return planes;
  }
  const std::string followers = list_of(cycle->outlier);
  if (!followers.empty())
    notes.push_back({Severity::info, "base.gate_follows",
                     "the valve plane of gates " + followers + " was taken from the other gates"});
  for (std::size_t g = 0; g < planes.size(); ++g) planes[g] = to_world(study.grid(), cycle->planes[g]);
  return planes;
}

}  // namespace

std::vector<std::optional<heart::BasePlane>> valve_planes(const Study& study,
                                                          const std::optional<heart::Location>& heart,
                                                          const UserOverrides& manual, Notes& notes) {
  std::vector<std::optional<heart::BasePlane>> planes(study.gates.size());
  if (manual.base_plane_mm)
    planes.assign(planes.size(), level_plane(study.grid(), *manual.base_plane_mm));
  else if (heart)
    planes = seen_planes(study, *heart, notes);
  if (!manual.base_shift_mm) return planes;
  for (auto& plane : planes)
    if (plane) plane->point += *manual.base_shift_mm * study.grid().direction.col(2);
  if (std::none_of(planes.begin(), planes.end(), [](const auto& plane) { return plane.has_value(); }))
    notes.push_back({Severity::warning, "base.shift_without_plane",
                     "option manual.base_shift_mm had no effect: no valve plane was found"});
  return planes;
}

SliceRange useful_slices(const Study& study, const std::optional<heart::Location>& heart,
                         const std::vector<std::optional<heart::BasePlane>>& planes, const UserOverrides& manual) {
  const Grid& grid = study.grid();
  const auto slice_at = [&](double z_mm) { return std::clamp(round_int(z_mm / grid.spacing[2]), 0, grid.dims[2] - 1); };
  SliceRange range{0, grid.dims[2] - 1};
  if (heart) {
    const heart::LvShell cup = to_grid(grid, heart->cup);
    const double way = cup.axis[2] > 0 ? 1 : -1;
    range.first = slice_at(cup.apex()[2] - way * outer_apex_mm);
    double top = cup.base()[2] + 2 * outer_apex_mm;
    for (const auto& plane : planes)
      if (plane) top = std::max(top, to_grid(grid, *plane).point[2] + outer_apex_mm);
    range.last = slice_at(top);
  }
  return as_set(range, manual, grid.dims[2]);
}

void clear_outside(Mask& edges, const SliceRange& range) {
  for (int k = 0; k < edges.grid.dims[2]; ++k) {
    if (k >= range.first && k <= range.last) continue;
    const auto begin = edges.values.begin() + edges.grid.index(0, 0, k);
    std::fill(begin, begin + edges.grid.index(0, 0, 1), std::uint8_t{0});
  }
}

}  // namespace dynasurf::ventricle
