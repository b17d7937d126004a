#include "dynasurf/ventricle/detail/contour_pipeline.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"
#include "dynasurf/field/gvf.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr std::array<std::string_view, 3> force_names{"potential", "flow", "both"};
constexpr std::array<std::string_view, 2> end_names{"slice_centre", "slice_face"};
// The automatic circle encloses the outer wall; the cavity is about half as wide.
constexpr double inner_start = 0.5;

/// What the search in the slices of one wall needs.
struct Search {
  const Image& image;
  const Labels& labels;
  Border wall;
  const ContourPipeline& options;
  const WallContours* outer;

  Vec2 centre(int k) const { return {labels.axis.x_at(k), labels.axis.y_at(k)}; }
};

/// Slope of the image along the ray from the axis, of the sign that the wall has, from 0 to 1.
Image border_strength(const Search& s, int k) {
  const Image plane = dynamics::smoothed_plane(dynamics::plane_of(s.image, k), s.options.sigma_px);
  const field::VectorField slope = dynamics::force_of(plane, s.wall == Border::epi ? 1 : -1);
  const Contour* bound = nullptr;
  if (s.outer && s.outer->slices[k]) bound = &*s.outer->slices[k];
  Image strength(plane.grid);
  float highest = 0;
  for (int j = 0; j < plane.grid.dims[1]; ++j)
    for (int i = 0; i < plane.grid.dims[0]; ++i) {
      const Vec2 ray = Vec2(i, j) - s.centre(k);
      const double distance = ray.norm();
      if (distance == 0 || distance > s.labels.circle.radius_px) continue;
      // The inner wall lies within the outer one, whatever slopes there are beyond.
      if (bound && !encloses(*bound, Vec2(i, j))) continue;
      const std::size_t at = plane.grid.index(i, j, 0);
      const Vec2 falling(double{slope.x[at]}, double{slope.y[at]});
      strength.values[at] = std::max(0.0, falling.dot(ray) / distance);
      highest = std::max(highest, strength.values[at]);
    }
  if (highest > 0)
    for (float& v : strength.values) v /= highest;
  return strength;
}

field::VectorField flow_of(const Search& s, const Image& strength) {
  return dynamics::scaled_to_one(field::flow_field(strength, field::SteadyGvf{.mu = s.options.mu}).field);
}

field::VectorField slope_of(const Image& strength) { return dynamics::scaled_to_one(dynamics::force_of(strength, -1)); }

/// A contour that came to rest, and the field that pulled it last.
struct SliceContour {
  dynamics::ContourResult rest;
  field::VectorField field;
};

SliceContour contour_in_slice(const Search& s, int k, const Contour& start) {
  const Image strength = border_strength(s, k);
  SliceContour found{{start, dynamics::StopReason::at_rest, 0}, {}};
  const auto evolve = [&](field::VectorField field) {
    const int before = found.rest.steps;
    found.field = std::move(field);
    found.rest = dynamics::evolve_contour(found.rest.contour, found.field, s.options.model);
    found.rest.steps += before;
  };
  if (s.options.force != ContourForce::potential) evolve(flow_of(s, strength));
  if (s.options.force != ContourForce::flow && found.rest.reason != dynamics::StopReason::diverged)
    evolve(slope_of(strength));
  return found;
}

std::vector<Vec2> pulls_on(const Contour& contour, const field::VectorField& field) {
  std::vector<Vec2> pulls;
  for (const Vec2& p : contour.points) pulls.push_back(dynamics::force_at(field, p));
  return pulls;
}

double area_of(const Contour& c) { return std::abs(signed_area(c)); }

/// Mean slope of the smoothed image along a contour: how clearly the slice shows the wall.
double clarity(const Search& s, int k, const Contour& c) {
  const Image plane = dynamics::smoothed_plane(dynamics::plane_of(s.image, k), s.options.sigma_px);
  const field::VectorField slope = dynamics::force_of(plane);
  double sum = 0;
  for (const Vec2& p : c.points) sum += dynamics::force_at(slope, p).norm();
  return sum / c.size();
}

Contour automatic_start(const Search& s, int k) {
  const double share = s.wall == Border::epi ? 1 : inner_start;
  return circle_contour(s.centre(k), share * s.labels.circle.radius_px, s.options.model.edge_px);
}

bool usable(const dynamics::ContourResult& r, const ContourPipeline& o) {
  return r.reason != dynamics::StopReason::diverged && area_of(r.contour) >= o.least_area_px2;
}

void keep(WallContours& all, int k, const SliceContour& found) {
  const dynamics::ContourResult& r = found.rest;
  all.slices[k] = r.contour;
  all.pulls[k] = pulls_on(r.contour, found.field);
  all.bends[k] = dynamics::curvature_force(r.contour, dynamics::curvature_frame(r.contour));
  all.steps += r.steps;
  ++all.found;
  if (r.reason == dynamics::StopReason::at_rest) ++all.at_rest;
}

/// The slice asked for, or the clearest of all slices in the middle half, each with a contour of its own.
std::optional<SliceContour> begin(const Search& s, int first, int last, WallContours& all) {
  if (s.options.best_slice) {
    const int asked = *s.options.best_slice - 1;
    all.best_slice = std::clamp(asked, first, last);
    if (all.best_slice != asked)
      all.notes.push_back({Severity::info, "contour.best_slice",
                           "slice " + std::to_string(asked + 1) + " has no " + std::string(name_of(s.wall)) +
                               "cardial border; its contours begin in slice " + std::to_string(all.best_slice + 1),
                           -1, all.best_slice});
    return contour_in_slice(s, all.best_slice, automatic_start(s, all.best_slice));
  }
  const int margin = (last - first) / 4;
  std::optional<SliceContour> best;
  double clearest = -1;
  for (int k = first + margin; k <= last - margin; ++k) {
    SliceContour found = contour_in_slice(s, k, automatic_start(s, k));
    if (!usable(found.rest, s.options)) continue;
    if (const double c = clarity(s, k, found.rest.contour); c > clearest)
      clearest = c, best = std::move(found), all.best_slice = k;
  }
  return best;
}

/// A ventricle changes its area little from slice to slice, or goes on narrowing as it did.
bool is_jump(double area, double former, std::optional<double> before_that, double limit) {
  const double line = before_that ? std::max(0.0, 2 * former - *before_that) : former;
  const double low = std::min(former, line), high = std::max(former, line);
  return area < low - limit * former || area > high + limit * former;
}

void sweep(const Search& s, int to, int direction, WallContours& all) {
  const auto slice = [&](int k) -> std::optional<Contour>& { return all.slices[k]; };
  for (int k = all.best_slice + direction; direction * k <= direction * to; k += direction) {
    const Contour& former = *slice(k - direction);
    SliceContour found = contour_in_slice(s, k, former);
    dynamics::ContourResult& r = found.rest;
    std::optional<double> before_that;
    if (k - 2 * direction >= 0 && k - 2 * direction < std::ssize(all.slices) && slice(k - 2 * direction))
      before_that = area_of(*slice(k - 2 * direction));
    const double area = area_of(r.contour), former_area = area_of(former);
    if (r.reason == dynamics::StopReason::diverged || is_jump(area, former_area, before_that, s.options.jump)) {
      all.notes.push_back({Severity::info, "contour.jump",
                           "the " + std::string(name_of(s.wall)) + "cardial contour jumped from " +
                               std::to_string(std::lround(former_area)) + " to " + std::to_string(std::lround(area)) +
                               " px2; the neighbour's is used",
                           -1, k});
      // One slice that fails must not wreck those behind it (C3D-PROP).
      r.contour = former;
      r.reason = dynamics::StopReason::max_steps;
      // The contour has shrunk to nothing: no slice behind it holds one.
    } else if (area < s.options.least_area_px2) {
      return;
    }
    keep(all, k, found);
  }
}

/// Slices in which the wall is looked for; none when first > last.
std::pair<int, int> range_of(const Labels& labels, Border wall, int base_slice) {
  const std::uint8_t bit = wall == Border::endo ? Labels::endo_bit : Labels::epi_bit;
  const Grid& g = labels.borders.grid;
  const std::size_t plane = g.slice_size();
  const auto found = std::find_if(labels.borders.values.begin(), labels.borders.values.end(),
                                  [bit](std::uint8_t v) { return (v & bit) != 0; });
  int first = (found - labels.borders.values.begin()) / plane;
  if (wall == Border::endo && labels.division_slice >= 0) first = std::max(first, labels.division_slice + 1);
  return {first, std::min(base_slice, g.dims[2] - 1)};
}

}  // namespace

std::span<const std::string_view> names_of(ContourForce) { return force_names; }
std::span<const std::string_view> names_of(StackEnds) { return end_names; }

WallContours propagate_contours(const Image& image, const Labels& labels, Border wall, int base_slice,
                                const ContourPipeline& requested, const WallContours* outer) {
  ContourPipeline options = requested;
  check_options(options, "contour");
  const int slices = image.grid.dims[2];
  if (options.best_slice && *options.best_slice > slices)
    throw OptionError("option contour.best_slice is " + std::to_string(*options.best_slice) +
                      "; expected a slice of the short-axis stack, 1 to " + std::to_string(slices));
  WallContours all;
  all.slices.resize(slices);
  all.pulls.resize(all.slices.size());
  all.bends.resize(all.slices.size());
  const Search search{image, labels, wall, options, outer};
  const auto [first, last] = range_of(labels, wall, base_slice);
  std::optional<SliceContour> start;
  if (first <= last && labels.circle.radius_px > 0) start = begin(search, first, last, all);
  if (!start || !usable(start->rest, options)) {
    all.notes.push_back({Severity::warning, "contour.none",
                         "no slice shows a " + std::string(name_of(wall)) + "cardial contour to begin with"});
    all.best_slice = -1;
    return all;
  }
  keep(all, all.best_slice, *start);
  sweep(search, last, 1, all);
  sweep(search, first, -1, all);
  return all;
}

std::optional<ContourSurface> contour_surface(const WallContours& contours, const Grid& grid,
                                              const ContourPipeline& requested) {
  ContourPipeline options = requested;
  check_options(options, "contour");
  const Vec2 pixel(grid.spacing.x(), grid.spacing.y());
  const double thickness = grid.spacing.z();
  mesh::ContourStack stack;
  for (std::size_t k = 0; k < contours.slices.size(); ++k) {
    if (!contours.slices[k]) continue;
    Contour c = *contours.slices[k];
    for (Vec2& p : c.points) p = p.cwiseProduct(pixel);
    stack.contours.push_back(std::move(c));
    stack.z_mm.push_back(k * thickness);
  }
  if (stack.contours.size() < 2) return std::nullopt;
  mesh::CapHeights caps;
  if (options.ends == StackEnds::slice_face) {
    caps.below_mm = thickness / 2;
    stack.contours.push_back(stack.contours.back());
    stack.z_mm.push_back(stack.z_mm.back() + thickness / 2);
  }
  ContourSurface surface;
  surface.volumes = mesh::volumes_of(stack, options.tessellation, caps);
  surface.evolved.mesh = mesh::tessellate(stack, options.tessellation, caps);
  if (options.smooth.sweeps > 0) mesh::smooth(surface.evolved.mesh, options.smooth, grid.spacing.minCoeff());
  surface.evolved.steps = contours.steps;
  surface.evolved.stopped_fraction = 1.0 * contours.at_rest / contours.found;
  surface.evolved.reason =
      contours.at_rest == contours.found ? dynamics::StopReason::at_rest : dynamics::StopReason::max_steps;
  surface.evolved.notes = contours.notes;
  return surface;
}

}  // namespace dynasurf::ventricle
