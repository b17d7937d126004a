#include <charconv>
#include <cmath>
#include <memory>
#include <optional>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/detail/lod_page.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "lod_levels.hpp"
#include "out_argument.hpp"
#include "result_job.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

struct LodArguments {
  std::vector<std::string> levels;
  std::string screen = "1920x1080", mesh_format = "ply";
  OutFolder out;
  cloud::Camera camera;
  cloud::LodRule rule;
  std::vector<double> from;
  std::optional<double> distance;
  int current = 0;  // 1-based; 0: none
  int steps = 3, instances = 200;
  bool json = false, quiet = false, with_names = false;
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

std::string summary_of(const std::vector<report::NamedLevel>& levels, const report::LodPlan& plan) {
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
                     : ": starts " + share(plan.distances[n].mean) + " of the diagonal off the coarse shape, at most " +
                           share(plan.distances[n].largest) + "\n");
  }
  return text;
}

/// Which level to draw at a distance (GEN-MIP (a)), when another one may stand there now.
std::string choice_at(const LodArguments& arguments, const report::LodPlan& plan) {
  if (!(*arguments.distance >= 0)) throw OptionError("--distance: expected a number from 0 on");
  if (arguments.current > static_cast<int>(plan.from.size()))
    throw OptionError("--current is " + std::to_string(arguments.current) + "; there are " +
                      std::to_string(plan.from.size()) + " levels");
  std::optional<std::size_t> current;
  if (arguments.current > 0) current = static_cast<std::size_t>(arguments.current - 1);
  const std::size_t level =
      cloud::level_for_distance(plan.from, *arguments.distance, current, arguments.rule.hysteresis_percent);
  return "at " + fixed(*arguments.distance, 4) + ": level " + std::to_string(level + 1) + "\n";
}

ExitCode run(LodArguments arguments, std::stop_token stop) {
  read_screen(arguments.screen, arguments.camera);
  check_options(arguments.camera, "camera");
  const std::vector<report::NamedLevel> levels = levels_of(arguments.levels, arguments.with_names);
  std::vector<TriMesh> meshes;
  meshes.reserve(levels.size());
  for (const report::NamedLevel& level : levels) meshes.push_back(level.mesh);
  report::LodPlan plan = report::plan_of(meshes, arguments.rule, arguments.camera, arguments.from);
  const std::string choice = arguments.distance ? choice_at(arguments, plan) : "";
  const auto json = [&] {
    nlohmann::ordered_json all = report::json_of(levels, plan, arguments.rule, arguments.camera);
    all["program"] = {{"name", "dynasurf"}, {"version", version()}, {"commit", commit()}};
    return io::json_text(all);
  };
  std::string written;
  if (arguments.out.is_asked()) {
    io::OutputFolder folder(arguments.out.path, arguments.out.existing(),
                            {arguments.levels.begin(), arguments.levels.end()});
    const io::MeshFormat format = mesh_formats_of({arguments.mesh_format}, "--mesh-format").front();
    report::write_transitions(plan, arguments.steps, format, folder.path() / "transitions");
    io::write_file(folder.path() / "lod.json", json());
    report::write_lod_page(meshes, plan.transitions,
                           {arguments.camera, arguments.rule, arguments.instances, plan.chain.largest_px},
                           folder.path() / "instances.html");
    if (stop.stop_requested()) throw Cancelled("stopped on request");
    folder.publish();
    written = "written: " + arguments.out.path + "\n" + line_of_moved(folder);
  }
  if (arguments.json)
    print(json());
  else if (!arguments.quiet)
    print(summary_of(levels, plan) + choice + written);
  return done;
}

}  // namespace

void add_lod(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<LodArguments>();
  CommandLine command(program, "lod",
                      "Which level of detail at which distance; the meshes between levels; a page of many instances");
  command.option("LEVELS", a->levels, "folder of a result of dynasurf cloud, or mesh files, finest first").required();
  add_out_folder(command, a->out, "folder for lod.json, transitions/ and instances.html");
  command.option("--screen", a->screen, "size of the picture in pixels (1920x1080)");
  command.option("--fov", a->camera.fov_deg, "vertical field of view, degrees (40)");
  command.option("--edge-px", a->rule.edge_px, "a level serves while its mean edge is no longer than this (8)");
  command.option("--hysteresis", a->rule.hysteresis_percent, "percent by which a limit must be passed (10)");
  command
      .option("--from", a->from,
              "distances from which the levels serve, finest first, such as 0,2.5,10, in place of those by --edge-px")
      .list();
  command.option("--distance", a->distance, "also tell which level serves at this distance");
  command.option("--current", a->current, "with --distance: the level that stands there now, which --hysteresis keeps")
      .within(1, 1000);
  command.option("--steps", a->steps, "meshes between two levels (3)").within(0, 1000);
  command.option("--instances", a->instances, "instances on the page (200)").within(1, 1000);
  command.option("--mesh-format", a->mesh_format, mesh_format_choices() + ", of the transitions (ply)");
  command.flag("--with-names,--with-phi", a->with_names,
               "record the names of mesh files, which may name a person, instead of level1, level2, ...");
  command.flag("--json", a->json, "print lod.json instead of the table");
  command.flag("--quiet", a->quiet, "print nothing but --json and errors");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
