#include "dynasurf/report/detail/page_motion.hpp"

#include <algorithm>
#include <cmath>

namespace dynasurf::report::detail {
namespace {

constexpr ventricle::Border walls[] = {ventricle::Border::endo, ventricle::Border::epi};

/// A part of a grid: its first voxel and how many.
struct Window {
  Index3 first{0, 0, 0}, count{0, 0, 0};
  std::size_t size() const { return size_of(count); }
};

/// The voxels above 0 with a margin in every direction.
Window window_around(const Image& border, int margin) {
  const Grid& g = border.grid;
  Index3 low = g.dims, high{-1, -1, -1};
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        if (!(border(i, j, k) > 0)) continue;
        const Index3 at{i, j, k};
        for (std::size_t axis = 0; axis < 3; ++axis)
          low[axis] = std::min(low[axis], at[axis]), high[axis] = std::max(high[axis], at[axis]);
      }
  Window w;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    w.first[axis] = std::max(0, low[axis] - margin);
    w.count[axis] = std::max(0, std::min(g.dims[axis] - 1, high[axis] + margin) + 1 - w.first[axis]);
  }
  return w;
}

/// Calls visit(n) with the number of each voxel of the window in the grid, i fastest.
template <class Visit>
void for_each(const Window& w, const Grid& grid, const Visit& visit) {
  for (int k = 0; k < w.count[2]; ++k)
    for (int j = 0; j < w.count[1]; ++j)
      for (int i = 0; i < w.count[0]; ++i) visit(grid.index(w.first[0] + i, w.first[1] + j, w.first[2] + k));
}

/// Directions as three bytes (0: -1, 127: 0, 254: 1), lengths as 16-bit parts of the longest.
void put_field(Json& json, const field::VectorField& field, const Window& w) {
  const auto vector_at = [&](std::size_t n) { return Vec3(field.x[n], field.y[n], field.z[n]); };
  double longest = 0;
  for_each(w, field.grid, [&](std::size_t n) { longest = std::max(longest, vector_at(n).norm()); });
  Bytes directions, lengths;
  for_each(w, field.grid, [&](std::size_t n) {
    const Vec3 v = vector_at(n);
    const double length = v.norm();
    for (int axis = 0; axis < 3; ++axis)
      directions.push_back(std::lround(127 + (length > 0 ? 127 * v[axis] / length : 0)));
    append<std::uint16_t>(lengths, std::lround(longest > 0 ? 65535 * length / longest : 0));
  });
  json["longest"] = longest;
  json["directions"] = packed(directions);
  json["lengths"] = packed(lengths);
}

/// At most `most` of `count` steps, evenly, the first and the last among them.
std::vector<std::size_t> chosen_steps(std::size_t count, std::size_t most) {
  std::vector<std::size_t> chosen;
  const std::size_t kept = std::min(count, most);
  for (std::size_t n = 0; n < kept; ++n) chosen.push_back(kept < 2 ? n : n * (count - 1) / (kept - 1));
  return chosen;
}

/// The way of one surface: places as 16-bit steps of the box; forces as 1 to 255 (128: none, 255: the strongest), 0 for
/// a particle that has stopped; distances from the border in 1/32 of a voxel, 128: none.
Json way_json(const ventricle::Motion& motion, const Box& box, const Grid& study) {
  constexpr std::size_t most_steps = 80;
  double strongest = 0;
  for (const dynamics::TrajectoryStep& step : motion.steps)
    for (const Vec3& pull : step.pulls) strongest = std::max(strongest, pull.cwiseAbs().maxCoeff());
  const double scale = strongest > 0 ? 127 / strongest : 0;
  Json numbers = Json::array();
  Bytes places, pulls, distances;
  for (const std::size_t n : chosen_steps(motion.steps.size(), most_steps)) {
    const dynamics::TrajectoryStep& step = motion.steps[n];
    numbers.push_back(step.step);
    const Bytes bytes = steps_of(step.places, box);
    places.insert(places.end(), bytes.begin(), bytes.end());
    for (std::size_t v = 0; v < step.pulls.size(); ++v)
      for (const double pull : step.pulls[v])
        pulls.push_back(step.stopped[v] != 0 ? 0 : 128 + std::round(pull * scale));
    for (const double voxels : motion.distances[n]) distances.push_back(byte_of(128 + std::round(32 * voxels)));
  }
  return {{"triangles", triangles_of({{}, motion.triangles})},
          {"steps", std::move(numbers)},
          {"places", packed(places)},
          {"pulls", packed(pulls)},
          {"distances", packed(distances)},
          {"strongest_n", strongest},
          {"around", surroundings_json(motion.border, motion.field, motion.drag ? &*motion.drag : nullptr, study)}};
}

/// The gate that the page tells of, and its number.
std::pair<const ventricle::EdgeSurfaces*, int> shown_gate(const ventricle::Result& result) {
  const int gate = result.leading.ed_gate.value_or(0);
  if (gate >= std::ssize(result.gates)) return {nullptr, gate};
  return {&result.gates[gate].edge_surfaces, gate};
}

double rounded(double v) { return std::round(1000 * v) / 1000; }

Json numbers_of(const std::vector<Vec2>& vectors) {
  Json json = Json::array();
  for (const Vec2& v : vectors) json.push_back(rounded(v[0])), json.push_back(rounded(v[1]));
  return json;
}

Json wall_json(const ventricle::WallContours& contours) {
  Json slices = Json::array();
  for (std::size_t k = 0; k < contours.slices.size(); ++k) {
    if (!contours.slices[k]) {
      slices.push_back(nullptr);
      continue;
    }
    slices.push_back({{"points", numbers_of(contours.slices[k]->points)},
                      {"pulls", numbers_of(contours.pulls[k])},
                      {"bends", numbers_of(contours.bends[k])}});
  }
  return {{"best_slice", contours.best_slice}, {"slices", std::move(slices)}};
}

}  // namespace

Json surroundings_json(const Image& border_volume, const field::VectorField& field, const Image* drag_map,
                       const Grid& study) {
  constexpr int margin = 6;
  constexpr std::size_t most_voxels = 1'000'000;
  const Grid& grid = border_volume.grid;
  const Window w = window_around(border_volume, margin);
  if (w.size() == 0 || w.size() > most_voxels || field.x.size() != grid.size()) return nullptr;
  const Vec3 shift = to_grid(study, grid.origin).cwiseQuotient(study.spacing);
  Json json = Json::object();
  json["first"] = {std::lround(shift[0]) + w.first[0], std::lround(shift[1]) + w.first[1],
                   std::lround(shift[2]) + w.first[2]};
  json["dims"] = w.count;
  Bytes border;
  for_each(w, grid, [&](std::size_t n) { border.push_back(border_volume.values[n] > 0 ? 1 : 0); });
  json["border"] = packed(border);
  put_field(json, field, w);
  json["drag"] = nullptr;
  if (drag_map == nullptr) return json;
  float most = 0;
  for_each(w, grid, [&](std::size_t n) { most = std::max(most, drag_map->values[n]); });
  Bytes drag;
  for_each(w, grid, [&](std::size_t n) {
    const double part = most > 0 ? drag_map->values[n] / double{most} : 0;
    drag.push_back(std::lround(255 * std::clamp(part, 0.0, 1.0)));
  });
  json["drag"] = {{"most_kg_s", most}, {"values", packed(drag)}};
  return json;
}

Json evolution_json(const ventricle::Result& result) {
  const auto [shown, gate] = shown_gate(result);
  if (shown == nullptr) return nullptr;
  const ventricle::EdgeSurfaces& surfaces = *shown;
  Box box;
  for (const ventricle::Border wall : walls)
    if (const auto& surface = surfaces.of(wall); surface && surface->motion)
      for (const dynamics::TrajectoryStep& step : surface->motion->steps)
        for (const Vec3& p : step.places) {
          box.low = box.low.cwiseMin(p);
          box.high = box.high.cwiseMax(p);
        }
  if (!(box.low[0] <= box.high[0])) return nullptr;
  Json json = Json::object();
  json["gate"] = gate;
  json["low_mm"] = {box.low[0], box.low[1], box.low[2]};
  json["high_mm"] = {box.high[0], box.high[1], box.high[2]};
  for (const ventricle::Border wall : walls) {
    const auto& surface = surfaces.of(wall);
    json[std::string(ventricle::name_of(wall))] =
        surface && surface->motion ? way_json(*surface->motion, box, result.study.grid()) : Json(nullptr);
  }
  return json;
}

Json contours_json(const ventricle::Result& result) {
  const auto [surfaces, gate] = shown_gate(result);
  if (surfaces == nullptr) return nullptr;
  Json json = Json::object();
  json["gate"] = gate;
  bool any = false;
  for (const ventricle::Border wall : walls) {
    const auto& surface = surfaces->of(wall);
    const bool has = surface && surface->contours;
    json[std::string(ventricle::name_of(wall))] = has ? wall_json(*surface->contours) : Json(nullptr);
    any = any || has;
  }
  return any ? json : Json(nullptr);
}

}  // namespace dynasurf::report::detail
