#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/gltf_scene.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::io {
namespace {

using detail::GltfJson;
using detail::GltfScene;
using detail::Rows3;

/// LPS to glTF's axes: x left, y up (superior), z to the front (anterior).
Vec3 to_gltf_axes(const Vec3& lps) { return {lps[0], lps[2], -lps[1]}; }

void check_surfaces(std::span<const AnimatedSurface> surfaces, double cycle_s, const std::string& what) {
  const auto fail = [&](const AnimatedSurface& s, const std::string& reason) {
    throw InputError("cannot write " + what + ": surface " + s.name + " " + reason);
  };
  if (surfaces.empty()) throw InputError("cannot write " + what + ": there is no surface");
  if (!(cycle_s > 0 && cycle_s < 1e6))
    throw OptionError("cannot write " + what + ": a cycle of " + std::to_string(cycle_s) +
                      " s; expected a positive number");
  for (const AnimatedSurface& s : surfaces) {
    if (s.cycle.empty()) fail(s, "has no mesh");
    for (const float c : s.colour)
      if (!(c >= 0 && c <= 1))
        throw OptionError("cannot write " + what + ": colour of " + s.name + " is not in 0 to 1");
    for (const TriMesh& mesh : s.cycle) {
      detail::check_writable(mesh, {}, what);
      if (mesh.triangles != s.cycle[0].triangles || mesh.vertices.size() != s.cycle[0].vertices.size())
        fail(s, "has meshes with different triangles; a cycle shares them");
    }
  }
}

Rows3 positions_m(const TriMesh& mesh) {
  Rows3 rows;
  rows.reserve(mesh.vertices.size());
  for (const Vec3& p : mesh.vertices) rows.push_back((to_gltf_axes(p) / 1000).cast<float>());
  return rows;
}

Rows3 normals(const TriMesh& mesh) {
  Rows3 rows = detail::normals_to_write(mesh);
  for (auto& n : rows) n = to_gltf_axes(n.cast<double>()).cast<float>();
  return rows;
}

Rows3 differences(const Rows3& to, const Rows3& from) {
  Rows3 rows(to.size());
  for (std::size_t i = 0; i < to.size(); ++i) rows[i] = to[i] - from[i];
  return rows;
}

int add_material(const AnimatedSurface& surface, GltfScene& scene) {
  const int index = scene.add_material(surface.name, 0.6);
  GltfJson& material = scene.document["materials"].back();
  if (surface.colour != std::array<float, 4>{1, 1, 1, 1})  // what glTF takes where none is told
    material["pbrMetallicRoughness"]["baseColorFactor"] =
        std::vector<double>(surface.colour.begin(), surface.colour.end());
  if (surface.colour[3] < 1) {
    material["alphaMode"] = "BLEND";
    material["doubleSided"] = true;
  }
  return index;
}

/// The first gate, and what each further one adds to it. Gives the number of its node.
int add_surface(const AnimatedSurface& surface, GltfScene& scene) {
  const Rows3 base = positions_m(surface.cycle[0]), base_normals = normals(surface.cycle[0]);
  GltfJson primitive = {{"attributes", GltfJson::object()}};
  primitive["material"] = add_material(surface, scene);
  primitive["attributes"]["POSITION"] = scene.add_rows(base, true);
  primitive["attributes"]["NORMAL"] = scene.add_rows(base_normals, false);
  primitive["indices"] = scene.add_triangles(surface.cycle[0]);
  GltfJson targets = GltfJson::array(), target_names = GltfJson::array();  // Blender and three.js show the names
  for (std::size_t gate = 1; gate < surface.cycle.size(); ++gate) {
    const int moved = scene.add_rows(differences(positions_m(surface.cycle[gate]), base), true);
    const int turned = scene.add_rows(differences(normals(surface.cycle[gate]), base_normals), false);
    targets.push_back({{"POSITION", moved}, {"NORMAL", turned}});
    target_names.push_back("gate " + std::to_string(gate + 1));
  }
  if (!targets.empty()) primitive["targets"] = std::move(targets);
  const int node = scene.add_node(surface.name, std::move(primitive), true);
  if (target_names.empty()) return node;
  GltfJson& mesh = scene.document["meshes"].back();
  mesh["weights"] = std::vector<double>(target_names.size(), 0.0);
  mesh["extras"] = {{"targetNames", std::move(target_names)}};
  return node;
}

/// Keyframe g of G+1 shows gate g alone; the last shows gate 0 again. Gate 0 is the base: all its weights are 0.
void animate(int node, std::size_t gates, double cycle_s, GltfJson& animation, GltfScene& scene) {
  std::vector<float> times, weights;
  for (std::size_t key = 0; key <= gates; ++key) {
    times.push_back(cycle_s * key / gates);
    for (std::size_t target = 1; target < gates; ++target) weights.push_back(key == target ? 1.0f : 0.0f);
  }
  GltfJson sampler = GltfJson::object(), channel = GltfJson::object();
  sampler["input"] = scene.add_numbers(times, true);
  sampler["output"] = scene.add_numbers(weights, false);
  sampler["interpolation"] = "LINEAR";
  channel["sampler"] = animation["samplers"].size();
  channel["target"] = {{"node", node}, {"path", "weights"}};
  animation["samplers"].push_back(std::move(sampler));
  animation["channels"].push_back(std::move(channel));
}

}  // namespace

void write_glb(std::span<const AnimatedSurface> surfaces, double cycle_s, const std::filesystem::path& path) {
  check_surfaces(surfaces, cycle_s, path.string());
  GltfScene scene;
  GltfJson beat = {{"samplers", GltfJson::array()}, {"channels", GltfJson::array()}};
  for (const AnimatedSurface& surface : surfaces) {
    const int node = add_surface(surface, scene);
    if (surface.cycle.size() > 1) animate(node, surface.cycle.size(), cycle_s, beat, scene);
  }
  if (!beat["channels"].empty()) {
    beat["name"] = "beat";
    scene.document["animations"] = GltfJson::array({std::move(beat)});
  }
  write_file(path, scene.encode(path.string()));
}

}  // namespace dynasurf::io
