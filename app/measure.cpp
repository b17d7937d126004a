#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/repair.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

using Json = nlohmann::ordered_json;

struct MeasureArguments {
  std::string mesh;
  bool json = false;
};

Json measures_of(const TriMesh& mesh) {
  const mesh::Topology surface = mesh::topology(mesh);
  const mesh::SurfaceCheck check = mesh::check_surface(mesh);
  const mesh::TriangleQuality quality = mesh::triangle_quality(mesh);
  Json json = Json::object();
  json["vertices"] = surface.vertices;
  json["edges"] = surface.edges;
  json["triangles"] = surface.triangles;
  json["components"] = surface.components;
  json["euler"] = surface.euler;
  json["boundary_edges"] = surface.boundary_edges;
  json["non_manifold_edges"] = surface.non_manifold_edges;
  json["misoriented_edges"] = surface.misoriented_edges;
  json["closed"] = surface.closed();
  json["manifold"] = check.manifold;
  json["oriented"] = surface.oriented();
  json["self_intersections"] = check.self_intersections;
  json["flat_triangles"] = check.flat_triangles;
  // Only a closed, oriented surface bounds something.
  json["volume_ml"] = surface.closed() && surface.oriented() ? Json(mesh::volume_mm3(mesh) / 1000) : Json();
  json["volume_by_quadrature_ml"] =
      surface.closed() && surface.oriented() ? Json(mesh::volume_mm3_quadrature(mesh) / 1000) : Json();
  json["area_mm2"] = mesh::area_mm2(mesh);
  json["triangle_area_min_mm2"] = quality.area_min;
  json["triangle_area_mean_mm2"] = quality.area_mean;
  json["triangle_area_max_mm2"] = quality.area_max;
  json["triangle_shape_min"] = quality.shape_min;
  json["triangle_shape_mean"] = quality.shape_mean;
  json["smallest_angle_deg"] = quality.smallest_angle_deg;
  return json;
}

ExitCode run(const MeasureArguments& arguments) {
  const Json json = measures_of(io::read_mesh(arguments.mesh));
  if (arguments.json) {
    print(io::json_text(json));
    return done;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : json.items())
    rows.push_back({name, value.is_null() ? "- (the surface is not closed and oriented)" : value.dump()});
  print(table(rows, {0, 1}));
  return done;
}

}  // namespace

void add_measure(CLI::App& program, Command& chosen) {
  auto arguments = std::make_shared<MeasureArguments>();
  CommandLine command(program, "measure",
                      "Measure a triangle mesh: volume, area, topology, self-intersections, triangles");
  command.option("MESH", arguments->mesh, "PLY, STL, OBJ or OFF file, in mm").required();
  command.flag("--json", arguments->json, "print JSON");
  command.run(chosen, [arguments](std::stop_token) { return run(*arguments); });
}

}  // namespace dynasurf::app
