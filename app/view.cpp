#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/program_page.hpp"

#include "cloud_names.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "option_arguments.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::string what, series, page, options;
  OutFile out;
};

/// dynasurf.html: where it is installed beside this program, or where ./dev web makes it.
fs::path find_page() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"../share/dynasurf/dynasurf.html", "../../web/dynasurf.html"})
    if (fs::is_regular_file(folder / place, error)) return (folder / place).lexically_normal();
  throw IoError("dynasurf.html is not installed beside this program; name it with --page (./dev web makes it)");
}

/// In a new folder that nobody else can look into.
fs::path temporary_page(const std::string& text) {
  std::string folder = (fs::temp_directory_path() / "dynasurf-view-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw IoError(folder + ": " + std::strerror(errno));
  fs::path page = fs::path(folder) / "study.html";
  try {
    io::write_file(page, text);
  } catch (...) {
    ::rmdir(folder.c_str());
    throw;
  }
  return page;
}

/// Hands a page to the browser, which outlives this program. Whether there was a program to hand it to.
bool open_page(const fs::path& page) {
  std::string opener = "xdg-open", file = fs::absolute(page).string();
  const std::array<char*, 3> words{opener.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  for (const int stream : {0, 1, 2}) ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, opener.c_str(), &actions, &attributes, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  return error == 0;
}

ExitCode show_page(const fs::path& page) {
  print((open_page(page) ? "opened in the browser: " : "open this page in a browser: ") + page.string() + "\n");
  return done;
}

std::vector<fs::path> files_of(const ViewArguments& a) {
  if (is_cloud(a.what)) return {a.what};
  return io::files_of_study(a.what, a.series);
}

/// The options of a former run, empty: none are given.
std::string options_text(const ViewArguments& a) {
  if (a.options.empty()) return {};
  if (is_cloud(a.what)) throw OptionError("--options: " + a.what + " is a cloud; expected a study");
  OptionArguments given;
  given.file = a.options;
  return io::options_to_text(options_of(given));
}

ExitCode run(const ViewArguments& a) {
  if (fs::is_regular_file(fs::path(a.what) / "report.html")) {
    if (!a.out.path.empty() || !a.options.empty())
      throw OptionError((a.options.empty() ? "--out: " : "--options: ") + a.what +
                        " is a result, which has its report.html; expected a study");
    return show_page(fs::path(a.what) / "report.html");
  }
  const fs::path page = a.page.empty() ? find_page() : fs::path(a.page);
  const std::string text = report::page_with_files(io::text_of_file(page), files_of(a), options_text(a));
  if (a.out.path.empty()) return show_page(temporary_page(text));
  io::OutputFile output(a.out.path, a.out.existing());
  io::write_file(output.path(), text);
  output.publish();
  print("page with the study inside: " + a.out.path + "\n" + line_of_moved(output));
  return done;
}

}  // namespace

void add_view(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<ViewArguments>();
  CommandLine command(program, "view", "Open a result, or a study in dynasurf.html, in the browser");
  command.option("WHAT", a->what, "folder of a result, a study, or a point cloud").required();
  add_series_argument(command, a->series);
  command.option("--options", a->options, "options of a former run of the study: the options.json of its result");
  command.option("--page", a->page, "dynasurf.html, where it is not installed beside the program");
  add_out_file(
      command, a->out,
      "write the page with the study inside to this file, and open nothing; it holds the study as it is, names "
      "too");
  command.run(chosen, [a](std::stop_token) { return run(*a); });
}

}  // namespace dynasurf::app
