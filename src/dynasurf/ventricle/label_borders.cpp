#include "dynasurf/ventricle/label_borders.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/ventricle/labels/detail/blood_pool.hpp"
#include "dynasurf/ventricle/labels/detail/bounding_boxes.hpp"
#include "dynasurf/ventricle/labels/detail/circle.hpp"
#include "dynasurf/ventricle/labels/detail/division_slice.hpp"
#include "dynasurf/ventricle/labels/detail/method.hpp"
#include "dynasurf/ventricle/labels/detail/mlc.hpp"

namespace dynasurf::ventricle {
namespace {

/// A border in a third of the directions is evidence of a cavity (a defect may hide the rest); in three quarters of
/// them it can bound its neighbours.
constexpr double ring_deg = 120, box_deg = 270;

/// Whether the robust readings of the method apply.
bool by_gradient(const Mlc& o) { return o.use_gradient && !o.strict_thesis; }

/// Whether edges may be cut where the wall changes sides before circles are sought among them.
bool cuts_by_gradient(const Labelling& o) {
  const Mlc* mlc = std::get_if<Mlc>(&o.method);
  return mlc ? by_gradient(*mlc) : o.circle.robust_fit;
}

/// Where the ventricle lies: everything of thesis 2.4.
struct Place {
  Axis axis;
  Circle circle;
  int big_slice = -1;
  std::vector<std::optional<Circle>> local;
};

Place find_place(const Image& image, const Mask& edges, const Labelling& o, const Circle& coarse, Notes& notes) {
  const int min_px = o.circle.min_component_px;
  SliceEdges found = find_components(clip(edges, {coarse.x_px, coarse.y_px, 0, 0}, coarse.radius_px), min_px);
  if (cuts_by_gradient(o)) {
    // Where the wall is open both its borders are one edge, which is no circle. Cut at a first guess of the axis it is.
    Notes first_guess;
    const Axis guess = find_axis(find_centre(found, image, o.circle, first_guess), o.circle);
    found = join(split_by_gradient(found, image, guess, min_px));
  }
  Place place;
  const Centre centre = find_centre(found, image, o.circle, notes);
  place.axis = find_axis(centre, o.circle);
  place.local = centre.local;
  const WidestEdge widest = find_widest_edge(found, image.grid, place.axis, o.circle, notes);
  place.big_slice = widest.slice;
  place.circle = {centre.x_px, centre.y_px,
                  widest.slice < 0 ? coarse.radius_px : widest.radius_px + o.circle.offset_px};
  return place;
}

std::vector<bool> slices_with(const SliceEdges& edges) {
  std::vector<bool> has;
  for (const auto& slice : edges) has.push_back(!slice.empty());
  return has;
}

/// Takes the inner border out of the division slice and everything below it.
void remove_endo_up_to(Mask& borders, int slice) {
  for (int k = 0; k <= slice; ++k)
    for (int j = 0; j < borders.grid.dims[1]; ++j)
      for (int i = 0; i < borders.grid.dims[0]; ++i) borders(i, j, k) &= ~Labels::endo_bit;
}

/// The longest run of slices for which something holds, as first and one past the last.
std::pair<int, int> longest_run(int slices, const std::function<bool(int)>& holds) {
  std::pair<int, int> longest{0, 0};
  for (int k = 0; k < slices; ++k) {
    const int first = k;
    while (k < slices && holds(k)) ++k;
    if (k - first > longest.second - longest.first) longest = {first, k};
  }
  return longest;
}

/// Blur brightens the tip of the cavity, so the centre profile ends it too early; noise in the cavity may end it
/// anywhere. The inner border is the better witness: the division slice goes to the lower end of its longest run.
int follow_cavity_down(int division, const Mask& borders, const Axis& axis, Notes& notes) {
  constexpr int least_run = 3;
  int slice = division;
  const auto both = [&](int k) { return count_borders(borders, k, axis, ring_deg) == 2; };
  const auto [first, past] = longest_run(borders.grid.dims[2], both);
  if (past - first >= least_run && first <= division)
    slice = first - 1;
  else if (slice + 1 < borders.grid.dims[2] && both(slice + 1))
    while (slice >= 0 && both(slice)) --slice;
  if (slice != division)
    notes.push_back({Severity::info, "slice_find.lowered",
                     "The inner border reaches below slice " + std::to_string(division + 2) +
                         ", where the cavity seemed to end: down to slice " + std::to_string(slice + 2) + ".",
                     -1, slice});
  return slice;
}

/// The end of the cavity by the wall under it, where that can be seen; else by the shape of the whole heart, where that
/// is known; else the lowest slice that showed the cavity, with what the rules of the thesis (`guess`) had to say.
int division_under(int seen, const LabelScene& scene, const std::vector<double>& profile, const Notes& guess,
                   Notes& notes) {
  constexpr double most_off_mm = 9;  // of the tip from where the whole heart has it; 2 to 3 where the wall is seen
  const double floor = scene.options.division.floor, slice_mm = scene.image.grid.spacing[2];
  const auto tip = find_wall_tip(profile, seen + 1, slice_mm, floor);
  const std::optional<double> expected = scene.expected_slice;
  if (expected && !(tip && std::abs(tip->slice - *expected) * slice_mm <= most_off_mm)) {
    const int slice = floor_int(*expected);
    notes.push_back({Severity::info, "slice_find.by_shape",
                     "The wall of the apex is not seen where the rest of the heart has it (a defect, or something hot "
                     "nearby); slice " +
                         std::to_string(slice + 1) + " was taken as the end of the cavity from its shape.",
                     -1, slice});
    return slice;
  }
  if (!tip) {
    notes.insert(notes.end(), guess.begin(), guess.end());
    return seen;
  }
  const int slice = floor_int(tip->slice);
  if (tip->brightness < floor)
    notes.push_back({Severity::warning, "slice_find.dim_tip",
                     "The wall under the cavity, in slice " + std::to_string(slice + 1) +
                         ", is dim (a defect of the apex looks so): the end of the cavity is uncertain.",
                     -1, slice});
  return slice;
}

ImageContrast detect_contrast(const LabelScene& scene, const Place& place) {
  const int min_px = std::max(1, scene.options.circle.min_component_px / 2);
  const SidedEdges sided = split_by_gradient(scene.inside, scene.image, scene.axis, min_px);
  return is_blood_pool(filling(scene.image, place.local), inner_share(sided)) ? ImageContrast::cavity
                                                                              : ImageContrast::wall;
}

/// What the methods found in an image of the blood pool, said as it is.
void read_as_pool(const Image& image, Labels& labels) {
  labels.borders = borders_of_pool(std::move(labels.borders));
  labels.division_slice = division_slice_of_pool(centre_profile(image, labels.axis));
  // What the methods say of walls, tips and division slices is about images with a bright wall.
  std::erase_if(labels.notes, [](const Note& n) {
    return n.code.starts_with("slice_") || n.code.starts_with("boxes.") || n.code == "labels.not_told_apart";
  });
  labels.notes.push_back({Severity::info, "labels.blood_pool",
                          "The cavity is bright and no wall is seen: an image of the blood pool. Its rim is the inner "
                          "border; there is no outer one."});
}

/// One note per slice that lacks a border though the slices below and above have it, and one per border found nowhere.
void note_missing(Labels& labels) {
  const int depth = labels.borders.grid.dims[2];
  for (const Border wall : {Border::endo, Border::epi}) {
    if (wall == Border::epi && labels.bright == ImageContrast::cavity) continue;
    const std::uint8_t bit = wall == Border::endo ? Labels::endo_bit : Labels::epi_bit;
    std::vector<int> with;
    for (int k = 0; k < depth; ++k)
      if (!pixels_of(labels.borders, k, bit).empty()) with.push_back(k);
    const std::string name(name_of(wall));
    if (with.empty())
      labels.notes.push_back(
          {Severity::failure, "labels.no_" + name, "The " + name + " border was found in no slice."});
    for (std::size_t n = 1; n < with.size(); ++n)
      for (int k = with[n - 1] + 1; k < with[n]; ++k)
        labels.notes.push_back({Severity::warning, "labels." + name + "_missing",
                                "The " + name + " border is absent in slice " + std::to_string(k + 1) +
                                    ", though slices above and below have it.",
                                -1, k});
  }
}

void require_same_grid(const Image& image, const image::EdgeMap& edges) {
  if (edges.edges.grid.dims != image.grid.dims)
    throw InputError("edge map and image have different sizes; expected the edges of this image");
}

}  // namespace

Mask label(const LabelScene& scene, const Mlc& method, Labels& labels) {
  const Grid& grid = scene.image.grid;
  const int min_px = std::max(1, scene.options.circle.min_component_px / 2);
  const auto refine = [&](int slice, const Mask& borders, double least_coverage_deg) {
    const auto count = [&](int k) { return count_borders(borders, k, scene.axis, least_coverage_deg); };
    return refine_division_slice(slice, grid.dims[2], count, labels.notes).slice;
  };
  const auto filter = [&](Mask borders) {
    return filter_by_boxes(std::move(borders), labels.big_slice, labels.division_slice, scene.axis,
                           method.box_margin_px, method.strict_thesis ? 0 : box_deg, labels.notes);
  };
  const std::vector<double> profile = centre_profile(scene.image, scene.axis);
  Notes guess;
  labels.division_slice = find_division_slice(profile, slices_with(scene.inside), scene.options.division, guess);
  if (!by_gradient(method)) {
    labels.notes.insert(labels.notes.end(), guess.begin(), guess.end());
    const Mask first = classify_by_gap(scene.inside, grid, scene.axis, labels.division_slice, method);
    labels.division_slice = refine(labels.division_slice, first, 0);
    return filter(classify_by_gap(scene.inside, grid, scene.axis, labels.division_slice, method));
  }
  const SidedEdges sided = split_by_gradient(scene.inside, scene.image, scene.axis, min_px);
  Mask borders = classify_by_gradient(sided, grid, scene.axis, min_px, labels.notes);
  labels.division_slice = follow_cavity_down(labels.division_slice, borders, scene.axis, labels.notes);
  labels.division_slice = refine(labels.division_slice, borders, ring_deg);
  remove_endo_up_to(borders, labels.division_slice);
  borders = filter(std::move(borders));
  labels.division_slice = division_under(labels.division_slice, scene, profile, guess, labels.notes);
  return borders;
}

void note_not_told_apart(Notes& notes) {
  notes.push_back({Severity::warning, "labels.not_told_apart",
                   "The method finds borders but cannot tell the inner from the outer one; each stands for both."});
}

bool Labels::has(Border w) const {
  const std::uint8_t bit = w == Border::endo ? endo_bit : epi_bit;
  return std::any_of(borders.values.begin(), borders.values.end(), [&](std::uint8_t v) { return v & bit; });
}

Labels label_borders(const Image& image, const image::EdgeMap& edges, const Labelling& options,
                     const LabelContext& context) {
  Labelling o = options;
  check_options(o, "labels");
  require_same_grid(image, edges);
  Labels labels;
  const Circle coarse = context.roi ? *context.roi : coarse_circle(image.grid, o.coarse);
  const Place place = find_place(image, edges.edges, o, coarse, labels.notes);
  labels.axis = place.axis;
  labels.circle = place.circle;
  labels.big_slice = place.big_slice;
  labels.local = place.local;

  LabelScene scene{image, o, coarse, place.axis, place.circle, {}, {}};
  scene.expected_slice = o.division.expected_slice ? o.division.expected_slice : context.expected_slice;
  scene.inside = find_components(clip(edges.edges, place.axis, place.circle.radius_px), o.circle.min_component_px);
  const auto has = slices_with(scene.inside);
  if (std::none_of(has.begin(), has.end(), [](bool h) { return h; }))
    labels.notes.push_back({Severity::failure, "components.empty",
                            "No edge of at least " + std::to_string(o.circle.min_component_px) +
                                " pixels lies inside the circle of " + std::to_string(place.circle.radius_px) +
                                " pixels around the ventricle."});

  labels.borders = std::visit([&](const auto& method) { return label(scene, method, labels); }, o.method);
  labels.bright = o.bright == ImageContrast::automatic ? context.bright : o.bright;
  if (labels.bright == ImageContrast::automatic) labels.bright = detect_contrast(scene, place);
  if (labels.bright == ImageContrast::cavity) read_as_pool(image, labels);
  note_missing(labels);
  return labels;
}

Image border_volume(const Labels& labels, Border wall) {
  const std::uint8_t bit = wall == Border::endo ? Labels::endo_bit : Labels::epi_bit;
  Image border(labels.borders.grid);
  for (std::size_t n = 0; n < border.values.size(); ++n)
    border.values[n] = labels.borders.values[n] & bit ? 1.0F : 0.0F;
  return border;
}

}  // namespace dynasurf::ventricle
