#include <sstream>

#include <tiny_gltf.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/gltf_buffer.hpp"
#include "dynasurf/io/mesh_formats.hpp"

namespace dynasurf {
namespace {

using io_detail::Rows3;
using Buffer = io_detail::GltfBuffer;

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
      io_detail::check_writable(mesh, {}, what);
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
  Rows3 rows = io_detail::vertex_normals(mesh);
  for (auto& n : rows) n = to_gltf_axes(n.cast<double>()).cast<float>();
  return rows;
}

Rows3 differences(const Rows3& to, const Rows3& from) {
  Rows3 rows(to.size());
  for (std::size_t i = 0; i < to.size(); ++i) rows[i] = to[i] - from[i];
  return rows;
}

tinygltf::Material material_of(const AnimatedSurface& surface) {
  tinygltf::Material material;
  material.name = surface.name;
  material.pbrMetallicRoughness.baseColorFactor.assign(surface.colour.begin(), surface.colour.end());
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.6;
  if (surface.colour[3] < 1) {
    material.alphaMode = "BLEND";
    material.doubleSided = true;
  }
  return material;
}

tinygltf::Mesh mesh_of(const AnimatedSurface& surface, int material, Buffer& buffer) {
  const Rows3 base = positions_m(surface.cycle[0]), base_normals = normals(surface.cycle[0]);
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  primitive.attributes["POSITION"] = buffer.add_rows(base, true);
  primitive.attributes["NORMAL"] = buffer.add_rows(base_normals, false);
  primitive.indices = buffer.add_triangles(surface.cycle[0]);

  tinygltf::Mesh mesh;
  mesh.name = surface.name;
  std::vector<tinygltf::Value> target_names;  // Blender and three.js show them
  for (std::size_t gate = 1; gate < surface.cycle.size(); ++gate) {
    const int moved = buffer.add_rows(differences(positions_m(surface.cycle[gate]), base), true);
    const int turned = buffer.add_rows(differences(normals(surface.cycle[gate]), base_normals), false);
    primitive.targets.push_back({{"POSITION", moved}, {"NORMAL", turned}});
    target_names.emplace_back("gate " + std::to_string(gate + 1));
    mesh.weights.push_back(0);
  }
  if (!target_names.empty()) mesh.extras = tinygltf::Value({{"targetNames", tinygltf::Value(target_names)}});
  mesh.primitives.push_back(primitive);
  return mesh;
}

/// Keyframe g of G+1 shows gate g alone; the last shows gate 0 again. Gate 0 is the base: all its weights are 0.
void animate(int node, std::size_t gates, double cycle_s, tinygltf::Animation& animation, Buffer& buffer) {
  std::vector<float> times, weights;
  for (std::size_t key = 0; key <= gates; ++key) {
    times.push_back(static_cast<float>(cycle_s * static_cast<double>(key) / static_cast<double>(gates)));
    for (std::size_t target = 1; target < gates; ++target) weights.push_back(key == target ? 1.0f : 0.0f);
  }
  tinygltf::AnimationSampler sampler;
  sampler.input = buffer.add_numbers(times, true);
  sampler.output = buffer.add_numbers(weights, false);
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size());
  channel.target_node = node;
  channel.target_path = "weights";
  animation.samplers.push_back(sampler);
  animation.channels.push_back(channel);
}

}  // namespace

void write_glb(std::span<const AnimatedSurface> surfaces, double cycle_s, const std::filesystem::path& path) {
  check_surfaces(surfaces, cycle_s, path.string());
  tinygltf::Model model;
  model.asset.version = "2.0";
  model.asset.generator = "Dynasurf";
  tinygltf::Scene scene;
  tinygltf::Animation beat;
  beat.name = "beat";
  Buffer buffer(model);
  for (const AnimatedSurface& surface : surfaces) {
    const int index = static_cast<int>(model.nodes.size());
    model.materials.push_back(material_of(surface));
    model.meshes.push_back(mesh_of(surface, index, buffer));
    tinygltf::Node node;
    node.name = surface.name;
    node.mesh = index;
    model.nodes.push_back(node);
    scene.nodes.push_back(index);
    if (surface.cycle.size() > 1) animate(index, surface.cycle.size(), cycle_s, beat, buffer);
  }
  if (!beat.channels.empty()) model.animations.push_back(beat);
  model.scenes.push_back(scene);
  model.defaultScene = 0;

  std::ostringstream bytes;
  if (!tinygltf::TinyGLTF().WriteGltfSceneToStream(&model, bytes, false, true))
    throw IoError("cannot write " + path.string() + ": glTF could not be put together");
  write_file(path, bytes.str());
}

}  // namespace dynasurf
