#include "dynasurf/show/detail/inputs.hpp"

#include <algorithm>
#include <cstdio>
#include <limits>

#include <nlohmann/json.hpp>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::show {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr ventricle::Border walls[] = {ventricle::Border::endo, ventricle::Border::epi};

void check_gate(int gate, std::size_t gates) {
  if (gate < 1 || static_cast<std::size_t>(gate) > gates)
    throw OptionError("--gate " + std::to_string(gate) + "; expected 1 to " + std::to_string(gates));
}

std::string gate_name(std::size_t gate) { return (gate < 9 ? "g0" : "g") + std::to_string(gate + 1); }

Image image_in(const fs::path& file) {
  Study study = io::read_study(file);
  if (study.gates.size() != 1) throw InputError(file.string() + ": expected one volume");
  return std::move(study.gates[0]);
}

/// A number of particles for each distance, step after step: "1,0,0,0,642" under a head.
std::vector<std::array<int, 4>> histories_in(const fs::path& file) {
  constexpr std::size_t most = 1'000'000;
  constexpr std::uintmax_t most_bytes = 60 * most;  // a line of five numbers of nine digits has 50
  if (!fs::is_regular_file(file) || fs::file_size(file) > most_bytes)
    throw InputError(file.string() + ": expected a file of at most a million lines");
  TextInput in(io::text_of_file(file));
  std::vector<std::array<int, 4>> histories;
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::array<int, 4> counts{};
    int step = 0;
    int end = 0;
    // Nine digits fit an int; what sscanf makes of a number that does not is undefined. What is left of a longer one is
    // more than five numbers.
    if (std::sscanf(line.c_str(), "%9d,%9d,%9d,%9d,%9d %n", &step, &counts[0], &counts[1], &counts[2], &counts[3],
                    &end) != 5 ||
        line.begin() + end != line.end() || step != static_cast<int>(histories.size()) + 1)
      throw InputError(file.string() + ": line " + std::to_string(histories.size() + 2) + ": expected five numbers");
    histories.push_back(counts);
  }
  return histories;
}

std::optional<ShownWall> take(const ventricle::WallStages& stages) {
  if (stages.border == nullptr) return std::nullopt;
  ShownWall wall{*stages.border, stages.edge_map != nullptr ? *stages.edge_map : *stages.border, {}, {}, {}};
  if (stages.start != nullptr) wall.start = *stages.start;
  if (stages.evolved != nullptr) wall.evolved = stages.evolved->mesh, wall.histories = stages.evolved->histories;
  return wall;
}

/// A mesh of a stage, in the frame of a grid. Throws InputError for one that lies far from it.
TriMesh mesh_near(const fs::path& file, const Grid& grid) {
  TriMesh mesh = to_grid(grid, io::read_mesh(file));
  const Vec3 middle = 0.5 * centre_of(grid, grid.dims);
  const double reach = 100 * (1 + middle.norm());
  for (const Vec3& p : mesh.vertices)
    if (!((p - middle).norm() <= reach)) throw InputError(file.string() + ": a vertex lies far from the border's grid");
  return mesh;
}

/// Result folders pass between people, so stages are looked at like any input: parts that do not fit together would be
/// drawn wrong, or end the drawing.
std::optional<ShownWall> wall_in(const fs::path& folder, const std::string& prefix, ventricle::Border which) {
  const std::string ending = "_" + std::string(ventricle::name_of(which));
  const auto file = [&](const std::string& name) {
    return io::file_inside(folder, fs::path("stages") / (prefix + name));
  };
  const fs::path border = file("_border" + ending + ".nrrd"), map = file("_edge_map" + ending + ".nrrd"),
                 start = file("_start" + ending + ".ply"), evolved = file("_evolved" + ending + ".ply"),
                 history = file("_history" + ending + ".csv");
  if (!fs::exists(border)) return std::nullopt;
  ShownWall wall;
  wall.border = image_in(border);
  wall.map = fs::exists(map) ? image_in(map) : wall.border;
  if (!(wall.map.grid == wall.border.grid)) throw InputError(map.string() + ": lies on another grid than its border");
  if (std::none_of(wall.border.values.begin(), wall.border.values.end(), [](float v) { return v > 0; }))
    throw InputError(border.string() + ": holds no border voxel");
  if (fs::exists(start)) wall.start = mesh_near(start, wall.border.grid);
  if (fs::exists(evolved)) wall.evolved = mesh_near(evolved, wall.border.grid);
  if (fs::exists(history)) wall.histories = histories_in(history);
  return wall;
}

/// The schema of the result, and its gates.
io::JsonNode gates_in(const io::JsonNode& results) {
  if (io::text_in(results, "schema") != "dynasurf.ventricle/3")
    throw InputError(results.file + ": expected a result of dynasurf ventricle (schema dynasurf.ventricle/3)");
  return io::list_in(results, "gates");
}

std::optional<TriMesh> surface_in(const fs::path& folder, std::size_t gate, ventricle::Border wall) {
  const std::string name = std::string(ventricle::name_of(wall)) + "_" + gate_name(gate);
  for (const char* ending : {".ply", ".obj", ".off", ".stl"})
    if (const fs::path path = io::file_inside(folder, fs::path("meshes") / (name + ending)); fs::exists(path))
      return io::read_mesh(path);
  return std::nullopt;
}

}  // namespace

ShownGate gate_of_result(const fs::path& folder, int gate) {
  const fs::path file = io::file_inside(folder, "results.json");
  const Json json = io::read_json(file);
  const io::JsonNode results = io::root_of(json, file.string());
  check_gate(gate, io::size_of(gates_in(results)));
  const std::string prefix = gate_name(gate - 1);
  const fs::path image = io::file_inside(folder, fs::path("stages") / (prefix + "_image.nrrd"));
  if (!fs::exists(image))
    throw InputError(image.string() + ": is not there; expected a result of dynasurf ventricle --keep-stages");
  ShownGate shown;
  shown.gate = gate - 1;
  try {
    io::options_from_json(*io::object_in(io::object_in(results, "provenance"), "options").json, shown.options);
  } catch (const OptionError& error) {
    // The options were not typed by who calls: a wrong one is a fault of the file.
    throw InputError(file.string() + ": " + error.what());
  }
  shown.image = image_in(image);
  shown.labels = image_in(io::file_inside(folder, fs::path("stages") / (prefix + "_labels.nrrd")));
  shown.endo = wall_in(folder, prefix, ventricle::Border::endo);
  shown.epi = wall_in(folder, prefix, ventricle::Border::epi);
  return shown;
}

ShownGate gate_of_study(const Study& study, ventricle::Options options, int gate, const Progress& progress) {
  check_gate(gate, study.gates.size());
  // Pictures show what a run passes through before the fit.
  options.fit.run = false;
  ShownGate shown;
  const auto keep = [&](const ventricle::Intermediates& stages) {
    if (stages.gate != gate - 1) return;
    shown.image = *stages.image;
    shown.labels = Image(stages.labels->borders.grid);
    std::copy(stages.labels->borders.values.begin(), stages.labels->borders.values.end(), shown.labels.values.begin());
    shown.endo = take(stages.endo);
    shown.epi = take(stages.epi);
  };
  ventricle::reconstruct(study, options, progress, {.keep = keep});
  shown.gate = gate - 1;
  shown.options = std::move(options);
  return shown;
}

ShownBeat beat_of_result(const fs::path& folder) {
  const fs::path file = io::file_inside(folder, "results.json");
  const Json json = io::read_json(file);
  const io::JsonNode results = io::root_of(json, file.string());
  const io::JsonNode gates = gates_in(results);
  ShownBeat beat;
  for (std::size_t g = 0; g < io::size_of(gates); ++g) {
    const io::JsonNode gate = io::object_of(gates, g);
    if (io::has(gate, "time_ms")) beat.time_ms.push_back(io::number_in(gate, "time_ms"));
    for (std::size_t w = 0; w < 2; ++w) {
      const std::string key = std::string(ventricle::name_of(walls[w])) + "_ml";
      beat.surfaces[w].push_back(surface_in(folder, g, walls[w]));
      beat.volume_ml[w].push_back(io::has(gate, key) ? io::number_in(gate, key) : nothing);
      double half = nothing;
      if (io::has(gate, key + "_90"))
        if (const std::vector<double> ends = io::numbers_in(gate, key + "_90"); ends.size() == 2)
          half = (ends[1] - ends[0]) / 2;
      beat.half_width_ml[w].push_back(half);
    }
  }
  if (beat.time_ms.size() != io::size_of(gates)) beat.time_ms.clear();  // an axis needs all
  return beat;
}

ShownBeat beat_of_study(const Study& study, const ventricle::Options& options, const Progress& progress) {
  ventricle::Result result = ventricle::reconstruct(study, options, progress);
  ShownBeat beat;
  beat.time_ms = result.study.time_ms;
  for (ventricle::Gate& gate : result.gates)
    for (std::size_t w = 0; w < 2; ++w) {
      const auto& surface = gate.surfaces.of(walls[w]);
      beat.surfaces[w].push_back(surface ? std::optional(surface->mesh) : std::nullopt);
      beat.volume_ml[w].push_back(surface ? surface->volume_ml.value : nothing);
      const bool is_sure = surface && surface->volume_ml.has_interval();
      beat.half_width_ml[w].push_back(is_sure ? surface->volume_ml.high() - surface->volume_ml.value : nothing);
    }
  return beat;
}

}  // namespace dynasurf::show
