#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/byte_source.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/solid_io.hpp"
#include "dynasurf/ventricle/measures/wall_solid.hpp"

#include "command.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::string result, out;
  int gate = 1;
  bool edges = false;
  WallSolidSize size;
};

Json results_of(const fs::path& folder) {
  const fs::path path = folder / "results.json";
  Json json = Json::parse(text_of_file(path), nullptr, false);
  if (!json.is_object() || !json.contains("measures"))
    throw InputError(path.string() + " is no result of this version of dynasurf ventricle");
  if (!json["measures"].is_object() || json["measures"]["thickness_is"].is_null())
    throw InputError(path.string() + ": no wall was measured");
  return json;
}

Vec3 vector_in(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

TriMesh surface_of(const Arguments& a, const std::string& wall) {
  const std::string name = wall + (a.gate < 10 ? "_g0" : "_g") + std::to_string(a.gate);
  for (const char* ending : {".ply", ".obj", ".off", ".stl"})
    if (const fs::path path = fs::path(a.result) / "meshes" / (name + ending); fs::exists(path)) return read_mesh(path);
  throw InputError(a.result + " holds no " + wall + " surface of gate " + std::to_string(a.gate) +
                   " as PLY, OBJ, OFF or STL");
}

Vec3 middle_of(const TriMesh& mesh) {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : mesh.vertices) sum += p / static_cast<double>(mesh.vertices.size());
  return sum;
}

SolidFormat format_of(const fs::path& path) {
  const std::string ending = path.extension().string();
  for (std::size_t n = 0; n < names_of(SolidFormat{}).size(); ++n)
    if (ending == "." + std::string(names_of(SolidFormat{})[n])) return static_cast<SolidFormat>(n);
  throw OptionError("--out " + path.string() + ": expected a name that ends with .vtu, .msh or .inp");
}

/// Walls freed of the blur are the muscle's; those of the edges are taken where there are no others, or on demand.
bool is_fitted(const Json& results, const Arguments& a) {
  return !a.edges && results.contains("readings") && results["readings"]["unbiased"].is_object();
}

const Json& gate_of(const Json& results, const Arguments& a) {
  const Json& gates = is_fitted(results, a) ? results["readings"]["unbiased"]["gates"] : results["gates"];
  return gates.at(static_cast<std::size_t>(a.gate - 1));
}

ExitCode run(const Arguments& a) {
  const SolidFormat format = format_of(a.out);
  const Json results = results_of(a.result);
  if (a.gate > static_cast<int>(results["gates"].size()))
    throw OptionError("--gate " + std::to_string(a.gate) + "; expected 1 to " +
                      std::to_string(results["gates"].size()));
  const Json& gate = gate_of(results, a);
  const std::string fitted = is_fitted(results, a) ? "fit_" : "";
  const TriMesh endo = surface_of(a, fitted + "endo"), epi = surface_of(a, fitted + "epi");
  std::optional<BasePlane> plane;
  if (gate.contains("base_plane") && gate["base_plane"].is_object()) {
    plane.emplace();
    plane->point = vector_in(gate["base_plane"]["point_mm"]);
    plane->normal = vector_in(gate["base_plane"]["normal"]);
  }
  if (results["heart"].is_null()) throw InputError(a.result + ": the heart's axis was not found");
  const auto axes = axes_of(endo, epi, middle_of(endo), vector_in(results["heart"]["axis"]),
                            vector_in(results["measures"]["anterior"]["direction"]), plane);
  const auto solid = axes ? wall_solid(endo, epi, *axes, a.size) : std::nullopt;
  if (!solid)
    throw InputError("the wall of gate " + std::to_string(a.gate) +
                     " cannot be filled: its surfaces cross, or are not seen from the axis");
  const std::vector<VertexScalar> scalars{{"ring", {solid->ring.begin(), solid->ring.end()}},
                                          {"layer", {solid->layer.begin(), solid->layer.end()}}};
  write_solid(solid->mesh, a.out, format, scalars);
  print(table({{"surfaces", fitted.empty() ? "classic edge" : "fitted through the blur"},
               {"tetrahedra", std::to_string(solid->quality.count)},
               {"not positive", std::to_string(solid->quality.not_positive)},
               {"volume_ml", fixed(solid->volume_ml, 3)},
               {"between the surfaces_ml", fixed(solid->surfaces_ml, 3)},
               {"moved to hold it_mm", fixed(solid->moved_mm, 3)},
               {"ends below the valve plane_mm", fixed(solid->lowered_mm, 1)},
               {"shape_min", fixed(solid->quality.shape_min, 3)},
               {"shape_mean", fixed(solid->quality.shape_mean, 3)}},
              {0}));
  return solid->quality.not_positive == 0 ? done : not_trustworthy;
}

}  // namespace

void add_solid(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command =
      program.add_subcommand("solid", "Fill the wall of one gate of a result with tetrahedra, for mechanics");
  command->add_option("RESULT", a->result, "folder written by dynasurf ventricle")->required();
  command->add_option("--gate", a->gate, "from 1")->check(CLI::Range(1, 1000));
  command->add_flag("--edges", a->edges, "the surfaces of the edges, also where walls were fitted through the blur");
  command->add_option("--out", a->out, "wall.vtu (VTK), wall.msh (gmsh 2.2) or wall.inp (Abaqus)")->required();
  command->add_option("--rings", a->size.rings, "from apex to base")->check(CLI::Range(2, 500));
  command->add_option("--sectors", a->size.sectors, "around the axis")->check(CLI::Range(3, 1000));
  command->add_option("--layers", a->size.layers, "through the wall")->check(CLI::Range(1, 50));
  command->callback([a, &chosen] { chosen = [a](std::stop_token) { return run(*a); }; });
}

}  // namespace dynasurf::app
