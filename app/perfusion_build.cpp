#include <algorithm>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/detail/normal_groups.hpp"
#include "dynasurf/report/normals.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "normal_studies.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct Building {
  std::string folder;
  std::vector<std::string> by, where;
  int least = 20;  // the standard deviation is then known within -24 and +46 % (95 %, chi squared)
  OutFile out;
};

/// The results in a folder, by name.
NormalStudies results_in(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) throw IoError("cannot read the folder " + folder.string());
  NormalStudies found;
  for (const auto& entry : entries)
    if (fs::exists(entry.path() / "measures" / "polar.csv")) found.results.push_back(entry.path());
  std::sort(found.results.begin(), found.results.end());
  found.values.resize(found.results.size());
  return found;
}

NormalStudies studies_of(const Building& a) {
  if (is_cohort(a.folder)) return normal_studies_of(a.folder, a.by, column_values(a.where, "--where"));
  if (!a.by.empty() || !a.where.empty())
    throw OptionError(a.folder + ": is no cohort, whose table has columns; expected a folder of dynasurf batch");
  return results_in(a.folder);
}

std::string groups_text(const report::NormalGroups& normals, int left_out) {
  std::vector<std::vector<std::string>> rows{normals.columns};
  rows.front().insert(rows.front().end(), {"studies", "map"});
  for (const report::NormalGroups::Group& group : normals.groups) {
    rows.push_back(group.values);
    rows.back().insert(rows.back().end(), {std::to_string(group.studies), group.map ? "yes" : "that of all studies"});
  }
  std::string text = normals.groups.empty() ? "" : table(rows);
  if (left_out > 0) text += std::to_string(left_out) + " studies left out: no trustworthy result, or other values\n";
  return text;
}

ExitCode build(const Building& a) {
  io::OutputFile output(a.out.path, a.out.existing());
  const NormalStudies studies = studies_of(a);
  std::vector<report::GroupedMap> maps;
  ventricle::Perfusion kind = ventricle::Perfusion::none;
  for (std::size_t n = 0; n < studies.results.size(); ++n) {
    const report::PolarTable polar = report::read_polar(studies.results[n]);
    if (maps.empty()) kind = polar.perfusion_is;
    report::require_same_perfusion(kind, studies.results.front().string(), polar.perfusion_is,
                                   studies.results[n].string());
    maps.push_back({studies.values[n], polar.maps.perfusion_percent});
  }
  if (maps.size() < 3)
    throw InputError(a.folder + " holds " + std::to_string(maps.size()) +
                     " results with polar maps; expected at least 3");
  const report::NormalGroups normals = report::build_normal_groups(std::move(maps), a.by, a.least, kind);
  io::write_file(output.path(), a.by.empty() ? report::normals_text(normals.all) : report::normal_groups_text(normals));
  output.publish();
  print(groups_text(normals, studies.left_out) + "normal map of " + std::to_string(normals.all.studies) +
        " studies: " + a.out.path + "\n" + line_of_moved(output));
  return done;
}

}  // namespace

void add_perfusion_build(CLI::App& perfusion, Command& chosen) {
  auto a = std::make_shared<Building>();
  CommandLine command(perfusion, "build", "Build a normal map of perfusion from the results of normal studies");
  command
      .option("FOLDER", a->folder,
              "folder of results, each a folder written by dynasurf ventricle, or a cohort of dynasurf batch")
      .required();
  command.option("--by", a->by, "columns of the cohort, such as sex,tracer: a map for each of their groups as well")
      .list();
  command.option("--where", a->where, "studies of the cohort with this value alone: COLUMN=VALUE; may be repeated")
      .repeated();
  command.option("--least", a->least, "studies that a group needs for a map of its own (20)").within(3, 1000000);
  add_out_file(command, a->out, "file of the normal map (JSON)").required();
  command.run(chosen, [a](std::stop_token) { return build(*a); });
}

}  // namespace dynasurf::app
