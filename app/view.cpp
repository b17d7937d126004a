#include <filesystem>
#include <memory>
#include <stdexcept>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/study_io.hpp"

#include "cloud_names.hpp"
#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "live_page.hpp"
#include "open_page.hpp"
#include "option_arguments.hpp"
#include "out_argument.hpp"
#include "rerun_parts.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct ViewArguments {
  std::string what, series, page, options;
  std::vector<std::string> inputs;  // of a result
  OutFile out;
};

/// The study or the scan, with the options of a former run where they are given.
std::vector<report::PageFile> files_of(const ViewArguments& a) {
  if (!a.inputs.empty()) throw OptionError("--study: " + a.what + " is no result; expected nothing");
  std::vector<report::PageFile> files;
  const std::vector<fs::path> study =
      is_cloud(a.what) ? std::vector<fs::path>{a.what} : io::files_of_study(a.what, a.series);
  files.reserve(study.size() + 1);
  for (const fs::path& file : study) files.push_back({file.filename().string(), file});
  if (a.options.empty()) return files;
  if (is_cloud(a.what)) throw OptionError("--options: " + a.what + " is a cloud; expected a study");
  OptionArguments given;
  given.file = a.options;
  options_of(given);  // refuses what the page would refuse
  files.push_back({"options.json", a.options});
  return files;
}

/// A result, and what it was made from. Throws InputError, IoError where that is not found.
std::vector<report::PageFile> files_of_run(const ViewArguments& a) {
  const RerunRecord record = rerun_record_of(a.what);
  RerunArguments arguments;
  arguments.result = a.what;
  arguments.inputs = a.inputs;
  const fs::path folder = fs::weakly_canonical(a.what);
  std::vector<report::PageFile> files = files_of_result(a.what, folder.filename().string());
  std::vector<fs::path> inputs;
  if (record.schema == "dynasurf.cloud/1")
    inputs = find_clouds(arguments, record);
  else
    inputs = io::files_of_study(find_study(arguments, record), record.series);
  if (const fs::path mask = find_given(arguments, record.mask_hash, "", "mask"); !mask.empty()) inputs.push_back(mask);
  for (const fs::path& file : inputs) files.push_back({file.filename().string(), file});
  return files;
}

std::string page_with(const ViewArguments& a, const std::vector<report::PageFile>& files) {
  return report::page_with_files(io::text_of_file(a.page.empty() ? installed_page() : fs::path(a.page)), files);
}

/// Opens a page with files inside, or writes it where that is asked for.
ExitCode show(const ViewArguments& a, const std::string& page) {
  if (a.out.path.empty()) return show_page(temporary_page(page));
  io::OutputFile output(a.out.path, a.out.existing());
  io::write_file(output.path(), page);
  output.publish();
  print("page with the study inside: " + a.out.path + "\n" + line_of_moved(output));
  return done;
}

/// A result is its report alone without the page, without its study, or where a page cannot hold both; where more is
/// asked for that is refused.
ExitCode show_result(const ViewArguments& a) {
  for (const auto& [name, value] : {std::pair("--options", &a.options), std::pair("--series", &a.series)})
    if (!value->empty())
      throw OptionError(std::string(name) + ": " + a.what + " is a result, which has its own; expected a study");
  const bool is_asked = !a.out.path.empty() || !a.inputs.empty() || !a.page.empty();
  const fs::path report = fs::path(a.what) / "report.html";
  if (!is_asked && find_page().empty()) return show_page(report);
  std::string page;
  try {
    page = page_with(a, files_of_run(a));
  } catch (const std::runtime_error& error) {
    if (is_asked) throw;
    print(std::string(error.what()) + "; this is the report alone\n");
    return show_page(report);
  }
  return show(a, page);
}

ExitCode run(const ViewArguments& a) {
  return fs::is_regular_file(fs::path(a.what) / "report.html") ? show_result(a) : show(a, page_with(a, files_of(a)));
}

}  // namespace

void add_view(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<ViewArguments>();
  CommandLine command(program, "view",
                      "Open a result with its study, a study, or a scan in dynasurf.html, in the browser");
  command.option("WHAT", a->what, "folder of a result, a study, or a point cloud").required();
  command.option(
      "--study,--input", a->inputs,
      "the study or the files of the cloud of a result, when they are neither beside it nor in the working folder");
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
