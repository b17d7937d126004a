#include "dynasurf/cloud/lod.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/detail/lod_page.hpp"

#include "command.hpp"
#include "console.hpp"
#include "out_argument.hpp"
#include "result_job.hpp"
#include "utf8.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Arguments {
  std::vector<std::string> levels;
  std::string screen = "1920x1080", mesh_format = "ply";
  OutFolder out;
  cloud::Camera camera;
  cloud::LodRule rule;
  int steps = 3, instances = 200;
  bool json = false, quiet = false, with_names = false;
};

struct Level {
  std::string name;
  TriMesh mesh;
};

/// "1920x1080".
void read_screen(const std::string& text, cloud::Camera& camera) {
  const char* const end = text.data() + text.size();
  const auto [x, first_error] = std::from_chars(text.data(), end, camera.width_px);
  const bool has_x = first_error == std::errc{} && x != end && *x == 'x';
  const auto [rest, second_error] =
      has_x ? std::from_chars(x + 1, end, camera.height_px) : std::from_chars_result{x, std::errc::invalid_argument};
  if (second_error != std::errc{} || rest != end)
    throw OptionError("--screen is '" + text + "'; expected WIDTHxHEIGHT in pixels, such as 1920x1080");
}

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
std::vector<Level> levels_of_result(const fs::path& folder) {
  const std::vector<std::string> names = level_names_of(folder);
  std::vector<Level> levels;
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

std::vector<Level> levels_of(const Arguments& arguments) {
  if (arguments.levels.size() == 1 && fs::is_directory(arguments.levels[0]))
    return levels_of_result(arguments.levels[0]);
  std::vector<Level> levels;
  for (const fs::path path : arguments.levels) {
    const std::string neutral = "level" + std::to_string(levels.size() + 1);
    levels.push_back({arguments.with_names ? valid_utf8(path.stem().string()) : neutral, io::read_mesh(path)});
  }
  for (std::size_t n = 1; n < levels.size(); ++n)
    if (levels[n].mesh.triangles.size() > levels[n - 1].mesh.triangles.size())
      throw InputError(arguments.levels[n] + ": has more triangles than the level before; expected the finest first");
  return levels;
}

struct Plan {
  cloud::LodChain chain;
  std::vector<double> from;                       // distance from which each level serves
  std::vector<cloud::LodTransition> transitions;  // level n out of level n + 1
};

Plan plan_of(const std::vector<TriMesh>& meshes, const Arguments& arguments) {
  Plan plan;
  plan.chain = cloud::lod_chain(meshes, arguments.rule);
  plan.from = cloud::switch_distances(plan.chain, arguments.camera);
  for (std::size_t n = 0; n + 1 < meshes.size(); ++n)
    plan.transitions.push_back(cloud::lod_transition(meshes[n + 1], meshes[n]));
  return plan;
}

Json json_of(const std::vector<Level>& levels, const Plan& plan, const Arguments& arguments) {
  Json json = Json::object();
  json["schema"] = "dynasurf.lod/1";
  json["screen_px"] = {arguments.camera.width_px, arguments.camera.height_px};
  json["fov_deg"] = arguments.camera.fov_deg;
  json["edge_px"] = arguments.rule.edge_px;
  json["hysteresis_percent"] = arguments.rule.hysteresis_percent;
  json["diagonal"] = plan.chain.diagonal;
  json["levels"] = Json::array();
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const bool last = n + 1 == levels.size();
    const double px = plan.chain.largest_px[n];
    json["levels"].push_back({{"level", n + 1},
                              {"name", levels[n].name},
                              {"triangles", levels[n].mesh.triangles.size()},
                              {"from_distance", plan.from[n]},
                              {"to_distance", last ? Json() : Json(plan.from[n + 1])},
                              {"largest_screen_px", std::isfinite(px) ? Json(px) : Json()}});
  }
  json["transitions"] = Json::array();
  for (std::size_t n = 0; n < plan.transitions.size(); ++n)
    json["transitions"].push_back({{"from_level", n + 2},
                                   {"to_level", n + 1},
                                   {"exact", plan.transitions[n].exact},
                                   {"start_distance", plan.transitions[n].start_distance},
                                   {"largest_start_distance", plan.transitions[n].largest_start_distance}});
  json["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
  return json;
}

/// t runs over (0, 1) in equal steps; its ends are the levels themselves.
void write_transitions(const Plan& plan, const Arguments& arguments, const fs::path& folder) {
  const io::MeshFormat format = mesh_formats_of({arguments.mesh_format}, "--mesh-format").front();
  for (std::size_t n = 0; n < plan.transitions.size(); ++n)
    for (int step = 0; step <= arguments.steps + 1; ++step) {
      const double t = static_cast<double>(step) / (arguments.steps + 1);
      const std::string name = "level" + std::to_string(n + 2) + "_to_level" + std::to_string(n + 1) + "_" +
                               std::to_string(step) + "." + std::string(word_of(format));
      io::write_mesh(cloud::at_transition(plan.transitions[n], t), folder / "transitions" / name, format);
    }
}

std::string summary_of(const std::vector<Level>& levels, const Plan& plan) {
  std::vector<std::vector<std::string>> rows{{"level", "triangles", "from distance", "to distance", "size on screen"}};
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const bool last = n + 1 == levels.size();
    const double px = plan.chain.largest_px[n];
    rows.push_back({std::to_string(n + 1), std::to_string(levels[n].mesh.triangles.size()),
                    fixed(plan.from[n] / plan.chain.diagonal, 2) + " diagonals",
                    last ? "-" : fixed(plan.from[n + 1] / plan.chain.diagonal, 2) + " diagonals",
                    std::isfinite(px) ? "up to " + fixed(px, 0) + " px" : "any"});
  }
  std::string text = table(rows) + "diagonal: " + fixed(plan.chain.diagonal, 4) + "\n";
  for (std::size_t n = 0; n < plan.transitions.size(); ++n) {
    const cloud::LodTransition& t = plan.transitions[n];
    const auto share = [&](double length) { return fixed(100 * length / plan.chain.diagonal, 3) + " %"; };
    text += "level " + std::to_string(n + 2) + " to " + std::to_string(n + 1) +
            (t.exact ? ": starts from the very shape\n"
                     : ": starts " + share(t.start_distance) + " of the diagonal off the coarse shape, at most " +
                           share(t.largest_start_distance) + "\n");
  }
  return text;
}

ExitCode run(Arguments arguments, std::stop_token stop) {
  read_screen(arguments.screen, arguments.camera);
  check_options(arguments.camera, "camera");
  const std::vector<Level> levels = levels_of(arguments);
  std::vector<TriMesh> meshes;
  meshes.reserve(levels.size());
  for (const Level& level : levels) meshes.push_back(level.mesh);
  const Plan plan = plan_of(meshes, arguments);
  const std::string json = io::json_text(json_of(levels, plan, arguments));
  std::string written;
  if (arguments.out.is_asked()) {
    io::OutputFolder folder(arguments.out.path, arguments.out.existing(),
                            {arguments.levels.begin(), arguments.levels.end()});
    io::write_file(folder.path() / "lod.json", json);
    write_transitions(plan, arguments, folder.path());
    report::write_lod_page(meshes, plan.transitions, {arguments.camera, arguments.rule, arguments.instances},
                           folder.path() / "instances.html");
    if (stop.stop_requested()) throw Cancelled("stopped on request");
    folder.publish();
    written = "written: " + arguments.out.path + "\n" + line_of_moved(folder);
  }
  if (arguments.json)
    print(json);
  else if (!arguments.quiet)
    print(summary_of(levels, plan) + written);
  return done;
}

}  // namespace

void add_lod(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Arguments>();
  CLI::App* command = program.add_subcommand(
      "lod", "Which level of detail at which distance; the meshes between levels; a page of many instances");
  command->add_option("LEVELS", a->levels, "folder of a result of dynasurf cloud, or mesh files, finest first")
      ->required();
  add_out_folder(*command, a->out, "folder for lod.json, transitions/ and instances.html");
  command->add_option("--screen", a->screen, "size of the picture in pixels (1920x1080)");
  command->add_option("--fov", a->camera.fov_deg, "vertical field of view, degrees (40)");
  command->add_option("--edge-px", a->rule.edge_px, "a level serves while its mean edge is no longer than this (8)");
  command->add_option("--hysteresis", a->rule.hysteresis_percent, "percent by which a limit must be passed (10)");
  command->add_option("--steps", a->steps, "meshes between two levels (3)")->check(CLI::Range(0, 1000));
  command->add_option("--instances", a->instances, "instances on the page (200)")->check(CLI::Range(1, 1000));
  command->add_option("--mesh-format", a->mesh_format, mesh_format_choices() + ", of the transitions (ply)");
  command->add_flag("--with-names,--with-phi", a->with_names,
                    "record the names of mesh files, which may name a person, instead of level1, level2, ...");
  command->add_flag("--json", a->json, "print lod.json instead of the table");
  command->add_flag("--quiet", a->quiet, "print nothing but --json and errors");
  command->callback([a, &chosen] { chosen = [a](std::stop_token stop) { return run(*a, stop); }; });
}

}  // namespace dynasurf::app
