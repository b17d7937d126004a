#include "dynasurf/report/normals.hpp"

#include <algorithm>
#include <filesystem>
#include <memory>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"

#include "command.hpp"
#include "console.hpp"
#include "out_argument.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The results in a folder, by name.
std::vector<fs::path> results_in(const fs::path& folder) {
  std::error_code error;
  fs::directory_iterator entries(folder, error);
  if (error) throw IoError("cannot read the folder " + folder.string());
  std::vector<fs::path> results;
  for (const auto& entry : entries)
    if (fs::exists(entry.path() / "measures" / "polar.csv")) results.push_back(entry.path());
  std::sort(results.begin(), results.end());
  return results;
}

ExitCode build(const std::string& folder, const OutFile& out) {
  OutputFile output(out.path, out.existing());
  const std::vector<fs::path> results = results_in(folder);
  std::vector<PolarValues> maps;
  Perfusion kind = Perfusion::none;
  for (const fs::path& result : results) {
    const PolarTable polar = read_polar(result);
    if (maps.empty()) kind = polar.perfusion_is;
    require_same_perfusion(kind, results.front().string(), polar.perfusion_is, result.string());
    maps.push_back(polar.maps.perfusion_percent);
  }
  if (maps.size() < 3)
    throw InputError(folder + " holds " + std::to_string(maps.size()) +
                     " results with polar maps; expected at least 3");
  NormalMap normal = build_normal_map(maps, PolarGrid{});
  normal.perfusion_is = kind;
  write_file(output.path(), normals_text(normal));
  output.publish();
  print("normal map of " + std::to_string(maps.size()) + " studies: " + out.path + "\n" + line_of_moved(output));
  return done;
}

struct Scoring {
  std::string result, normals, edit, segments = "aha17";
  OutFile out;
  bool json = false;
};

Json scores_json(const SegmentScores& scores, SegmentModel model, const std::optional<DefectMeasures>& defect,
                 int studies) {
  Json json = Json::object();
  json["schema"] = "dynasurf.scores/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["normal_studies"] = studies > 0 ? Json(studies) : Json();
  json["summed_score"] = scores.sum;
  json["summed_percent"] = scores.percent();
  json["extent_percent"] = defect ? Json(defect->extent_percent) : Json();
  json["severity_sd"] = defect ? Json(defect->severity_sd) : Json();
  json["deficit_percent"] = defect ? Json(defect->deficit_percent) : Json();
  json["segments"] = Json::array();
  for (const Segment& s : segments_of(model)) {
    const auto n = static_cast<std::size_t>(s.number - 1);
    json["segments"].push_back({{"number", s.number},
                                {"name", s.name},
                                {"score", scores.score[n] ? Json(*scores.score[n]) : Json()},
                                {"by_hand", static_cast<bool>(scores.by_hand[n])}});
  }
  return json;
}

ExitCode score(const Scoring& a) {
  const auto model = static_cast<SegmentModel>(
      std::find(names_of(SegmentModel{}).begin(), names_of(SegmentModel{}).end(), a.segments) -
      names_of(SegmentModel{}).begin());
  const PolarTable polar = read_polar(a.result);
  std::optional<NormalMap> normal;
  if (!a.normals.empty()) normal = read_normals(a.normals);
  require_same_perfusion(polar.perfusion_is, a.result, normal ? normal->perfusion_is : polar.perfusion_is, a.normals);
  SegmentScores scores =
      score_segments(model, polar.grid, polar.maps.perfusion_percent, polar.area_mm2, normal ? &*normal : nullptr);
  if (!a.edit.empty()) read_scores(a.edit, scores);
  std::optional<DefectMeasures> defect;
  if (normal) defect = measure_defect(polar.maps.perfusion_percent, polar.area_mm2, *normal);
  const std::string json = json_text(scores_json(scores, model, defect, normal ? normal->studies : 0));
  std::string moved;
  if (!a.out.path.empty()) {
    OutputFile output(a.out.path, a.out.existing());
    write_file(output.path(), json);
    output.publish();
    moved = line_of_moved(output);
  }
  if (a.json) {
    print(json);
    return done;
  }
  std::vector<std::vector<std::string>> rows{{"segment", "name", "score"}};
  for (const Segment& s : segments_of(model)) {
    const auto n = static_cast<std::size_t>(s.number - 1);
    rows.push_back({std::to_string(s.number), std::string(s.name),
                    (scores.score[n] ? std::to_string(*scores.score[n]) : std::string("-")) +
                        (scores.by_hand[n] ? " by hand" : "")});
  }
  std::string text = table(rows) + "summed score " + std::to_string(scores.sum) + " of " + std::to_string(scores.most) +
                     " (" + fixed(scores.percent(), 1) + " %)\n";
  if (defect)
    text += "defect: extent " + fixed(defect->extent_percent, 1) + " % of the wall, severity " +
            fixed(defect->severity_sd, 1) + " SD, deficit " + fixed(defect->deficit_percent, 1) + " %\n";
  print(text + moved + "Research use only. Not for diagnosis.\n");
  return done;
}

}  // namespace

void add_normals(CLI::App& program, Command& chosen) {
  struct Arguments {
    std::string folder;
    OutFile out;
  };
  auto a = std::make_shared<Arguments>();
  CLI::App* command =
      program.add_subcommand("normals", "Build a normal map of perfusion from the results of normal studies");
  command->add_option("FOLDER", a->folder, "folder of results, each a folder written by dynasurf ventricle")
      ->required();
  add_out_file(*command, a->out, "file of the normal map (JSON)")->required();
  command->callback([a, &chosen] { chosen = [a](std::stop_token) { return build(a->folder, a->out); }; });
}

void add_scores(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<Scoring>();
  CLI::App* command = program.add_subcommand(
      "scores", "Score the segments of a result from 0 (normal) to 4 (no uptake), with extent and severity of defects");
  command->add_option("RESULT", a->result, "folder written by dynasurf ventricle")->required();
  command->add_option("--normals", a->normals, "normal map written by dynasurf normals; without one, by uptake alone");
  command->add_option("--edit", a->edit, "a person's scores, JSON: {\"17\": 2, \"4\": 0}");
  command->add_option("--segments", a->segments, "aha17 or segments20")->check(CLI::IsMember({"aha17", "segments20"}));
  add_out_file(*command, a->out, "write the scores to this file (JSON)");
  command->add_flag("--json", a->json, "print JSON instead of the table");
  command->callback([a, &chosen] { chosen = [a](std::stop_token) { return score(*a); }; });
}

}  // namespace dynasurf::app
