#include <cmath>

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/detail/json_parts.hpp"
#include "dynasurf/report/detail/page_motion.hpp"
#include "dynasurf/report/detail/page_pictures.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::report {
namespace {

using detail::Json;

/// All of it, as it is: `read_location` makes the same of it.
Json location_json(const std::optional<heart::Location>& heart) {
  if (!heart) return nullptr;
  const auto list = [](const Vec3& v) { return Json{v[0], v[1], v[2]}; };
  return {{"centre_mm", list(heart->cup.centre)},
          {"axis", list(heart->cup.axis)},
          {"radius_mm", heart->cup.radius_mm},
          {"half_length_mm", heart->cup.half_length_mm},
          {"base_mm", heart->cup.base_mm},
          {"contrast", heart->contrast},
          {"ridge_share", heart->ridge_share},
          {"spread_mm", heart->spread_mm},
          {"runner_up", heart->runner_up},
          {"runner_up_mm", heart->runner_up_mm ? list(*heart->runner_up_mm) : Json(nullptr)},
          {"outside", heart->outside},
          {"other_end", heart->other_end},
          {"is_pointed_at", heart->is_pointed_at},
          {"outward_mm", heart->outward_mm ? Json(*heart->outward_mm) : Json(nullptr)},
          {"is_turned", heart->is_turned}};
}

Vec3 vector_in(const io::JsonNode& object, std::string_view key) {
  const std::vector<double> numbers = io::numbers_in(object, key);
  if (numbers.size() != 3) io::refuse_value(object, std::string(key) + " of three numbers");
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

std::string borders_json(const ventricle::BorderResult& result, int gate, std::size_t most_voxels) {
  using namespace detail;
  const ventricle::GateBorders& found = result.gates.at(gate);
  const Grid& grid = result.study.grid();
  const auto around = [&](const std::optional<ventricle::BorderField>& wall) {
    return wall ? surroundings_json(wall->border, wall->field, nullptr, grid) : Json(nullptr);
  };
  const int bin = bin_of(result.study, most_voxels);
  return Json({{"gate", gate + 1},
               {"heart", location_json(result.heart)},
               {"grid", grid_json(grid)},
               {"bin", bin},
               {"marks", packed(mark_bytes(grid, found.labels.borders, found.edges.edges, bin))},
               {"endo", around(found.endo)},
               {"epi", around(found.epi)},
               {"notes", placed_notes_json(result.notes)}})
             .dump() +
         "\n";
}

std::optional<heart::Location> read_location(const std::filesystem::path& path) {
  const Json json = io::read_json(path);
  const io::JsonNode root = io::root_of(json, path.string());
  if (!io::has(root, "heart")) return std::nullopt;
  const io::JsonNode node = io::object_in(root, "heart");
  const auto positive = [&](std::string_view key) {
    const double value = io::number_in(node, key);
    if (!(value > 0)) io::refuse_value(node, std::string(key) + " > 0");
    return value;
  };
  heart::Location heart;
  heart.cup = {vector_in(node, "centre_mm"), vector_in(node, "axis"), positive("radius_mm"), positive("half_length_mm"),
               io::number_in(node, "base_mm")};
  // Numbers are written with all their digits, so an axis of another length was not written by this program.
  if (!(std::abs(heart.cup.axis.norm() - 1) < 1e-6)) io::refuse_value(node, "an axis of length 1");
  heart.contrast = io::number_in(node, "contrast");
  heart.ridge_share = io::number_in(node, "ridge_share");
  heart.spread_mm = io::number_in(node, "spread_mm");
  heart.runner_up = io::number_in(node, "runner_up");
  if (io::has(node, "runner_up_mm")) heart.runner_up_mm = vector_in(node, "runner_up_mm");
  heart.outside = io::number_in(node, "outside");
  heart.other_end = io::number_in(node, "other_end");
  heart.is_pointed_at = io::flag_in(node, "is_pointed_at");
  if (io::has(node, "outward_mm")) heart.outward_mm = io::number_in(node, "outward_mm");
  heart.is_turned = io::flag_in(node, "is_turned");
  return heart;
}

}  // namespace dynasurf::report
