#include "dynasurf/show/show.hpp"

#include <memory>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "lod_levels.hpp"
#include "option_arguments.hpp"
#include "out_argument.hpp"
#include "result_job.hpp"

namespace dynasurf::app {
namespace {

struct ShowArguments {
  show::ShowRequest request;
  std::string input, wall = "epi";
  OutFile out;
  OptionArguments options;
  int threads = 0;
  bool quiet = false;
};

ExitCode run(ShowArguments& a, const std::stop_token& stop) {
  if (a.wall != "endo" && a.wall != "epi") throw OptionError("--wall " + a.wall + "; expected endo or epi");
  const show::DrawingFormat format = show::drawing_format_of(a.out.path);
  a.request.input = a.input;
  a.request.wall = a.wall == "endo" ? ventricle::Border::endo : ventricle::Border::epi;
  a.request.options = options_of(a.options);
  const bool is_film = show::is_film(a.request.what);
  if (is_film && format != show::DrawingFormat::png)
    throw OptionError("--out " + a.out.path + ": expected a name that ends with .png for " + a.request.what);
  if (a.request.what == "instances" && std::filesystem::is_directory(a.input))
    for (report::NamedLevel& level : levels_of({a.input}, false)) a.request.levels.push_back(std::move(level.mesh));
  const ThreadLimit limit(a.threads);
  io::OutputFile output(a.out.path, a.out.existing());
  run_with_progress(a.quiet, stop, [&](const Progress& progress) {
    if (is_film)
      show::write_film(show::draw_film(a.request, progress), output.path());
    else
      show::write_drawing(show::draw_picture(a.request, progress), output.path(), format);
  });
  output.publish();
  if (!a.quiet) print("picture: " + a.out.path + "\n" + line_of_moved(output));
  return done;
}

}  // namespace

void add_show(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<ShowArguments>();
  CommandLine command(program, "show", "Draw what a study, a result or a mesh passed through as PNG or SVG");
  std::string words;
  for (const show::PictureKind& kind : show::picture_kinds())
    words += (words.empty() ? "" : "; ") + std::string(kind.name) + ": " + std::string(kind.says);
  command.option("INPUT", a->input, "study, folder written by dynasurf ventricle or cloud, or mesh").required();
  command.option("WHAT", a->request.what, words).required();
  add_out_file(command, a->out, "picture.png or picture.svg").required();
  command.option("--gate", a->request.gate, "from 1").within(1, 1000);
  command.option("--wall", a->wall, "endo or epi");
  command.option("--slice", a->request.slice, "from 1 at the apex; 0: through the middle of the border")
      .within(0, 10000);
  command.option("--row", a->request.row, "of the profile, from 1; 0: through the middle of the border")
      .within(0, 10000);
  command.option("--steps", a->request.steps, "of the evolution: steps,... (eight of them, 32 in its film)").list();
  add_series_argument(command, a->request.series);
  add_option_arguments(command, a->options);
  command.option("--threads", a->threads, "threads at most; the picture is the same (0: all)").within(0, 1024);
  command.flag("--quiet", a->quiet, "print nothing");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
