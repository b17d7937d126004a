#include "result_walls.hpp"

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/byte_source.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json results_of(const fs::path& folder) {
  const fs::path path = folder / "results.json";
  Json json = Json::parse(text_of_file(path), nullptr, false);
  if (!json.is_object() || !json.contains("measures"))
    throw InputError(path.string() + " is no result of this version of dynasurf ventricle");
  if (!json["measures"].is_object() || json["measures"]["thickness_is"].is_null())
    throw InputError(path.string() + ": no wall was measured");
  if (json["heart"].is_null()) throw InputError(folder.string() + ": the heart's axis was not found");
  return json;
}

Vec3 vector_in(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

TriMesh surface_of(const fs::path& folder, int gate, const std::string& wall) {
  const std::string name = wall + (gate < 10 ? "_g0" : "_g") + std::to_string(gate);
  for (const char* ending : {".ply", ".obj", ".off", ".stl"})
    if (const fs::path path = folder / "meshes" / (name + ending); fs::exists(path)) return read_mesh(path);
  throw InputError(folder.string() + " holds no " + wall + " surface of gate " + std::to_string(gate) +
                   " as PLY, OBJ, OFF or STL");
}

Vec3 middle_of(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : mesh.vertices) sum += p / static_cast<double>(mesh.vertices.size());
  return sum;
}

}  // namespace

ResultWalls read_result_walls(const fs::path& folder, int gate, bool edges) {
  const Json results = results_of(folder);
  if (gate < 1 || gate > static_cast<int>(results["gates"].size()))
    throw OptionError("--gate " + std::to_string(gate) + "; expected 1 to " + std::to_string(results["gates"].size()));
  ResultWalls walls;
  walls.is_fitted = !edges && results.contains("readings") && results["readings"]["unbiased"].is_object();
  const Json& gates = walls.is_fitted ? results["readings"]["unbiased"]["gates"] : results["gates"];
  const Json& of_gate = gates.at(static_cast<std::size_t>(gate - 1));
  const std::string fitted = walls.is_fitted ? "fit_" : "";
  walls.endo = surface_of(folder, gate, fitted + "endo"), walls.epi = surface_of(folder, gate, fitted + "epi");
  std::optional<BasePlane> plane;
  if (of_gate.contains("base_plane") && of_gate["base_plane"].is_object()) {
    plane.emplace();
    plane->point = vector_in(of_gate["base_plane"]["point_mm"]);
    plane->normal = vector_in(of_gate["base_plane"]["normal"]);
  }
  walls.axes = axes_of(walls.endo, walls.epi, middle_of(walls.endo), vector_in(results["heart"]["axis"]),
                       vector_in(results["measures"]["anterior"]["direction"]), plane);
  return walls;
}

}  // namespace dynasurf::app
