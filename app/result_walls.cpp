#include "result_walls.hpp"

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Throws InputError unless something was measured on the walls, and the heart's axis was found.
void check_measured(const io::JsonNode& results) {
  if (!io::has(results, "measures") || !io::has(io::object_in(results, "measures"), "thickness_is"))
    throw InputError(results.file + ": no wall was measured; expected a result of dynasurf ventricle with walls");
  if (!io::has(results, "heart")) throw InputError(results.file + ": the heart's axis was not found");
}

/// A place or a direction of three numbers.
Vec3 vector_in(const io::JsonNode& object, const char* key) {
  constexpr double farthest = 1e9;
  const std::vector<double> v = io::numbers_in(object, key);
  const bool is_near = std::all_of(v.begin(), v.end(), [](double x) { return std::abs(x) <= farthest; });
  if (v.size() != 3 || !is_near)
    throw InputError(object.file + ": " + object.path + "." + key +
                     ": expected three numbers of a place or a direction");
  return {v[0], v[1], v[2]};
}

Vec3 direction_in(const io::JsonNode& object, const char* key) {
  Vec3 v = vector_in(object, key);
  if (v.norm() < 1e-3 || v.norm() > 1e3)
    throw InputError(object.file + ": " + object.path + "." + key + ": expected a direction, about 1 long");
  return v;
}

TriMesh surface_of(const fs::path& folder, int gate, const std::string& wall) {
  const std::string name = wall + (gate < 10 ? "_g0" : "_g") + std::to_string(gate);
  for (const char* ending : {".ply", ".obj", ".off", ".stl"})
    if (const fs::path path = io::file_inside(folder, fs::path("meshes") / (name + ending)); fs::exists(path))
      return io::read_mesh(path);
  throw InputError(folder.string() + " holds no " + wall + " surface of gate " + std::to_string(gate) +
                   " as PLY, OBJ, OFF or STL");
}

}  // namespace

ResultWalls read_result_walls(const fs::path& folder, int gate, bool edges) {
  const fs::path file = io::file_inside(folder, "results.json");
  const Json json = io::read_json(file);
  const io::JsonNode results = io::root_of(json, file.string());
  check_measured(results);
  const std::size_t count = io::size_of(io::list_in(results, "gates"));
  if (count == 0) throw InputError(file.string() + ": gates: empty; expected at least one");
  if (gate < 1 || static_cast<std::size_t>(gate) > count)
    throw OptionError("--gate " + std::to_string(gate) + "; expected 1 to " + std::to_string(count));
  ResultWalls walls;
  const std::string reading = io::text_in(results, "reading");
  if (reading != "psf_corrected" && reading != "edge")
    throw InputError(file.string() + ": reading: expected psf_corrected or edge");
  const bool has_fit = reading == "psf_corrected";
  walls.is_fitted = has_fit && !edges;
  const io::JsonNode leading = io::object_of(io::list_in(results, "gates"), gate - 1);
  const io::JsonNode of_gate = walls.is_fitted ? leading : io::object_in(leading, "edge");
  // Where fitted walls lead, the surfaces of the edges have names of their own.
  const std::string prefix = has_fit && edges ? "edge_" : "";
  walls.endo = surface_of(folder, gate, prefix + "endo"), walls.epi = surface_of(folder, gate, prefix + "epi");
  std::optional<heart::BasePlane> plane;
  if (io::has(of_gate, "base_plane")) {
    const io::JsonNode base = io::object_in(of_gate, "base_plane");
    plane.emplace();
    plane->point = vector_in(base, "point_mm");
    plane->normal = direction_in(base, "normal");
  }
  const Vec3 axis = direction_in(io::object_in(results, "heart"), "axis");
  const Vec3 anterior = direction_in(io::object_in(io::object_in(results, "measures"), "anterior"), "direction");
  walls.axes = ventricle::axes_of(walls.endo, walls.epi, mean_point(walls.endo.vertices), axis, anterior, plane);
  return walls;
}

}  // namespace dynasurf::app
