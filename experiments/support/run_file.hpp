#pragma once
// What an experiment runs: the tables of its run.json, or of a file of the same form that the user gives.
//
//     {"TABLE": {"common": {OPTIONS}, "rows": [{"name": "…", "published": "…", "options": {OPTIONS}}, …]}, …}
//
// Options of a row stand over those common to its table, and these over the defaults. Unknown keys are refused.
#include <cstdio>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/mesh/shapes.hpp"

namespace dynasurf::experiments {

/// One evolution of a sphere of a level (or of what `start` says) onto a border.
struct MeshRun {
  int level = 3;
  mesh::Placement start;
  dynamics::Evolution evolution;
};
void describe(auto& visit, MeshRun& o) {
  visit("level", o.level, OptionInfo{"2, 3, 4: 162, 642, 2562 vertices", "", 0, 6});
  visit("start", o.start, OptionInfo{"what the surface starts from"});
  visit("evolution", o.evolution, OptionInfo{"the deformable model"});
}

template <class Options>
struct Row {
  std::string name, published;
  Options options;
};

using RunFile = nlohmann::ordered_json;

template <class Options>
std::vector<Row<Options>> rows_of(const RunFile& file, const std::string& table) {
  if (!file.contains(table)) throw InputError("run file: no table '" + table + "'; expected one");
  std::vector<Row<Options>> rows;
  for (const auto& row : file.at(table).at("rows")) {
    for (const auto& [key, value] : row.items())
      if (key != "name" && key != "published" && key != "options")
        throw InputError("run file: a row of '" + table + "' has '" + key + "'; expected name, published or options");
    Options options;
    if (file.at(table).contains("common")) io::options_from_json(file.at(table).at("common"), options, table);
    if (row.contains("options")) io::options_from_json(row.at("options"), options, table);
    rows.push_back({row.at("name"), row.value("published", ""), options});
  }
  return rows;
}

inline TriMesh start_of(const MeshRun& run, const Image& border) {
  return mesh::start_mesh(border, run.level, run.start);
}

/// Reads the file named on the command line and hands it to `print`. Errors go to the user in one line.
template <class Print>
int run_tables(int count, char** arguments, Print print) {
  try {
    if (count != 2) throw OptionError("expected one argument, the file with the runs (run.json of the experiment)");
    std::ifstream stream(arguments[1]);
    if (!stream) throw InputError("cannot open " + std::string(arguments[1]) + "; expected a file with runs");
    const RunFile file = RunFile::parse(stream);
    std::printf("# Results\n\n");
    print(file);
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}

}  // namespace dynasurf::experiments
