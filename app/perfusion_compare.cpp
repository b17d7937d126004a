#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/detail/comparison_page.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/report/normals.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "out_argument.hpp"
#include "print_page.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct CompareArguments {
  std::string rest, stress;
  OutFolder out;
  bool json = false, pdf = false, with_names = false;
};

/// The address of a study's report from the folder of the comparison; empty where there is none.
std::string report_from(const fs::path& study, const fs::path& out) {
  const fs::path report = fs::absolute(study) / "report.html";
  return fs::exists(report) ? address_of(report.lexically_relative(fs::absolute(out)).string()) : std::string();
}

ExitCode run(const CompareArguments& a, const std::stop_token& stop) {
  if (a.pdf && !a.out.is_asked()) throw OptionError("--pdf needs a folder to print to; expected --out");
  if (a.pdf) find_browser();  // before anything is computed
  report::ComparedStudy rest = report::read_compared_study(a.rest), stress = report::read_compared_study(a.stress);
  // Two blood pools are compared by their volumes alone.
  if (rest.polar.perfusion_is != stress.polar.perfusion_is)
    report::require_same_perfusion(rest.polar.perfusion_is, a.rest, stress.polar.perfusion_is, a.stress);
  const ventricle::Measures difference = report::difference_of(rest, stress);
  const Json json = report::comparison_json(rest, stress, difference);
  std::string moved;
  if (a.out.is_asked()) {
    io::OutputFolder folder(a.out.path, a.out.existing(), {a.rest, a.stress});
    const report::PolarKind kind{
        "difference", "Perfusion, rest less stress", "points", &ventricle::PolarMaps::perfusion_percent, -40, 40, false,
        true};
    if (a.with_names) {
      rest.report = report_from(a.rest, a.out.path);
      stress.report = report_from(a.stress, a.out.path);
    }
    io::write_file(folder.path() / "comparison.json", io::json_text(json));
    io::write_file(folder.path() / "comparison.html", report::comparison_html(rest, stress, json));
    if (rest.polar.perfusion_is != ventricle::Perfusion::none)
      io::write_file(folder.path() / "polar_difference.svg", report::polar_svg(difference, kind));
    if (a.pdf) print_page(folder.path() / "comparison.html", folder.path() / "comparison.pdf", stop, PageKind::plain);
    if (stop.stop_requested()) throw Cancelled("stopped on request");
    folder.publish();
    moved = line_of_moved(folder);
  }
  if (a.json) {
    print(io::json_text(json));
    return done;
  }
  const auto text = [&](const char* key) {
    const Json& value = json.at(key);
    return value.is_number_float() ? fixed(value.get<double>(), 2) : value.is_null() ? "-" : value.dump();
  };
  print(
      table({{"TID ratio", text("tid_ratio")},
             {"EDV stress / rest", text("edv_ratio")},
             {"ESV stress / rest", text("esv_ratio")},
             {"EF rest, %", text("ef_rest_percent")},
             {"EF stress, %", text("ef_stress_percent")},
             {"summed scores rest, stress, difference",
              text("summed_rest_score") + ", " + text("summed_stress_score") + ", " + text("summed_difference_score")}},
            {0}) +
      moved + "Research use only. Not for diagnosis.\n");
  return done;
}

}  // namespace

void add_perfusion_compare(CLI::App& perfusion, Command& chosen) {
  auto a = std::make_shared<CompareArguments>();
  CommandLine command(perfusion, "compare",
                      "Compare a rest and a stress result: TID ratio, volumes, scores, difference of the polar maps");
  command.option("REST", a->rest, "folder written by dynasurf ventricle").required();
  command.option("STRESS", a->stress, "the same of the stress study").required();
  add_out_folder(command, a->out,
                 "folder for comparison.json, comparison.html with both studies, and polar_difference.svg");
  command.flag("--pdf", a->pdf, "print the page to comparison.pdf, two A4 pages (needs Chromium)");
  command.flag("--with-names,--with-phi", a->with_names,
               "link the reports of both results; the names of their folders may name a person");
  command.flag("--json", a->json, "print JSON instead of the table");
  command.run(chosen, [a](std::stop_token stop) { return run(*a, stop); });
}

}  // namespace dynasurf::app
