#include "lod_levels.hpp"

#include <algorithm>
#include <filesystem>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"

#include "utf8.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The names of the levels that results.json tells, each the name of a file in meshes/.
std::vector<std::string> level_names_of(const fs::path& folder) {
  constexpr std::size_t most_levels = 1000;
  const fs::path file = io::file_inside(folder, "results.json");
  const Json json = io::read_json(file);
  const io::JsonNode results = io::root_of(json, file.string());
  if (io::text_in(results, "schema") != "dynasurf.cloud/1")
    throw InputError(file.string() + ": expected the schema dynasurf.cloud/1");
  const io::JsonNode levels = io::list_in(results, "levels");
  if (io::size_of(levels) == 0 || io::size_of(levels) > most_levels)
    io::refuse_value(levels, "a list of 1 to " + std::to_string(most_levels));
  std::vector<std::string> names;
  for (std::size_t n = 0; n < io::size_of(levels); ++n) {
    const io::JsonNode level = io::object_of(levels, n);
    names.push_back(io::text_in(level, "name"));
    if (!io::is_plain_file_name(names.back()) ||
        std::find(names.begin(), names.end() - 1, names.back()) != names.end() - 1)
      throw InputError(level.file + ": " + level.path + ".name: expected the name of a file, each level its own");
  }
  return names;
}

/// The meshes of a result folder, finest first: in the first format of its files that can be read, else those of
/// levels.glb, which holds them with 32 bits a number.
std::vector<report::NamedLevel> levels_of_result(const fs::path& folder) {
  const std::vector<std::string> names = level_names_of(folder);
  std::vector<report::NamedLevel> levels;
  for (const std::string& name : names) {
    fs::path mesh;
    for (const char* ending : {".ply", ".obj", ".off", ".stl"})
      if (const fs::path file = io::file_inside(folder, fs::path("meshes") / (name + ending));
          mesh.empty() && fs::exists(file))
        mesh = file;
    if (!mesh.empty()) levels.push_back({name, io::read_mesh(mesh)});
  }
  if (levels.empty())
    for (io::LodSurface& level : io::read_lod_glb(io::file_inside(folder, "levels.glb")))
      levels.push_back({std::move(level.name), std::move(level.mesh)});
  if (levels.size() != names.size())
    throw InputError(folder.string() + ": " + std::to_string(levels.size()) + " levels have a mesh; expected the " +
                     std::to_string(names.size()) + " that results.json names");
  return levels;
}

}  // namespace

std::vector<report::NamedLevel> levels_of(const std::vector<std::string>& paths, bool with_names) {
  if (paths.size() == 1 && fs::is_directory(paths[0])) return levels_of_result(paths[0]);
  std::vector<report::NamedLevel> levels;
  for (const fs::path path : paths) {
    const std::string neutral = "level" + std::to_string(levels.size() + 1);
    levels.push_back({with_names ? valid_utf8(path.stem().string()) : neutral, io::read_mesh(path)});
  }
  for (std::size_t n = 1; n < levels.size(); ++n)
    if (levels[n].mesh.triangles.size() > levels[n - 1].mesh.triangles.size())
      throw InputError(paths[n] + ": has more triangles than the level before; expected the finest first");
  return levels;
}

}  // namespace dynasurf::app
