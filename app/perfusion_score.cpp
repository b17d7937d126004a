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

ColumnValues column_values(const std::vector<std::string>& texts, const std::string& option) {
  ColumnValues values;
  for (const std::string& text : texts) {
    const std::size_t sign = text.find('=');
    if (sign == std::string::npos || sign == 0 || sign + 1 == text.size())
      throw OptionError(option + " is " + text + "; expected COLUMN=VALUE, such as sex=F");
    values.emplace_back(text.substr(0, sign), text.substr(sign + 1));
  }
  return values;
}

namespace {

using Json = nlohmann::ordered_json;

struct Scoring {
  std::string result, normals, edit, segments = "aha17";
  std::vector<std::string> group;
  OutFile out;
  bool json = false;
};

Json scores_json(const ventricle::SegmentScores& scores, ventricle::SegmentModel model,
                 const std::optional<ventricle::DefectMeasures>& defect, const report::ChosenNormals& normals) {
  Json json = Json::object();
  json["schema"] = "dynasurf.scores/1";
  json["use"] = "Research use only. Not for diagnosis.";
  json["normal_studies"] = normals.map ? Json(normals.map->studies) : Json();
  json["normals_are_of"] = normals.map ? Json(normals.of) : Json();
  json["summed_score"] = scores.sum;
  json["summed_percent"] = scores.percent();
  json["extent_percent"] = defect ? Json(defect->extent_percent) : Json();
  json["severity_sd"] = defect ? Json(defect->severity_sd) : Json();
  json["deficit_percent"] = defect ? Json(defect->deficit_percent) : Json();
  json["segments"] = Json::array();
  for (const ventricle::Segment& s : ventricle::segments_of(model)) {
    const std::size_t n = s.number - 1;
    json["segments"].push_back({{"number", s.number},
                                {"name", s.name},
                                {"score", scores.score[n] ? Json(*scores.score[n]) : Json()},
                                {"by_hand", static_cast<bool>(scores.by_hand[n])}});
  }
  return json;
}

ExitCode score(const Scoring& a) {
  const auto model =
      static_cast<ventricle::SegmentModel>(std::find(ventricle::names_of(ventricle::SegmentModel{}).begin(),
                                                     ventricle::names_of(ventricle::SegmentModel{}).end(), a.segments) -
                                           ventricle::names_of(ventricle::SegmentModel{}).begin());
  const report::PolarTable polar = report::read_polar(a.result);
  report::NormalGroups read;
  report::ChosenNormals chosen;
  if (!a.normals.empty()) {
    read = report::read_normal_groups(a.normals);
    chosen = report::normals_for(read, column_values(a.group, "--group"), a.normals);
  } else if (!a.group.empty()) {
    throw OptionError("--group belongs to --normals");
  }
  const ventricle::NormalMap* normal = chosen.map;
  // Without normals the result is held against its own kind, which always fits.
  report::require_same_perfusion(polar.perfusion_is, a.result, normal ? normal->perfusion_is : polar.perfusion_is,
                                 a.normals);
  ventricle::SegmentScores scores =
      ventricle::score_segments(model, polar.grid, polar.maps.perfusion_percent, polar.area_mm2, normal);
  if (!a.edit.empty()) report::read_scores(a.edit, scores);
  std::optional<ventricle::DefectMeasures> defect;
  if (normal) defect = ventricle::measure_defect(polar.maps.perfusion_percent, polar.area_mm2, *normal);
  const std::string json = io::json_text(scores_json(scores, model, defect, chosen));
  std::string moved;
  if (!a.out.path.empty()) {
    io::OutputFile output(a.out.path, a.out.existing());
    io::write_file(output.path(), json);
    output.publish();
    moved = line_of_moved(output);
  }
  if (a.json) {
    print(json);
    return done;
  }
  std::vector<std::vector<std::string>> rows{{"segment", "name", "score"}};
  for (const ventricle::Segment& s : ventricle::segments_of(model)) {
    const std::size_t n = s.number - 1;
    rows.push_back({std::to_string(s.number), std::string(s.name),
                    (scores.score[n] ? std::to_string(*scores.score[n]) : std::string("-")) +
                        (scores.by_hand[n] ? " by hand" : "")});
  }
  std::string text = table(rows) + "summed score " + std::to_string(scores.sum) + " of " + std::to_string(scores.most) +
                     " (" + fixed(scores.percent(), 1) + " %)\n";
  if (defect)
    text += "defect: extent " + fixed(defect->extent_percent, 1) + " % of the wall, severity " +
            fixed(defect->severity_sd, 1) + " SD, deficit " + fixed(defect->deficit_percent, 1) + " %\n";
  if (normal) text += "normals: " + chosen.of + "\n";
  print(text + moved + "Research use only. Not for diagnosis.\n");
  return done;
}

}  // namespace

void add_perfusion_score(CLI::App& perfusion, Command& chosen) {
  auto a = std::make_shared<Scoring>();
  CommandLine command(
      perfusion, "score",
      "Score the segments of a result from 0 (normal) to 4 (no uptake), with extent and severity of defects");
  command.option("RESULT", a->result, "folder written by dynasurf ventricle").required();
  command.option("--normals", a->normals,
                 "normal map written by dynasurf perfusion build; without one, by uptake alone");
  command.option("--group", a->group, "group of the study in a normal map --by groups: COLUMN=VALUE; may be repeated")
      .repeated();
  command.option("--edit", a->edit, "a person's scores, JSON: {\"17\": 2, \"4\": 0}");
  command.option("--segments", a->segments, "aha17 or segments20").one_of({"aha17", "segments20"});
  add_out_file(command, a->out, "write the scores to this file (JSON)");
  command.flag("--json", a->json, "print JSON instead of the table");
  command.run(chosen, [a](std::stop_token) { return score(*a); });
}

}  // namespace dynasurf::app
