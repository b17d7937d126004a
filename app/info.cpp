#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/study_io.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "option_arguments.hpp"

namespace dynasurf::app {
namespace {

struct InfoArguments {
  std::string study, series;
  bool json = false;
};

ExitCode run(const InfoArguments& arguments) {
  const Study study = io::read_study(arguments.study, arguments.series);
  const io::StudyFacts facts = io::facts_of(arguments.study, study, arguments.series);
  if (arguments.json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for (const auto& [name, value] : facts.rows) json[name] = value;
    json["notes"] = nlohmann::ordered_json::array();
    for (const Note& note : study.notes) json["notes"].push_back({{"code", note.code}, {"message", note.message}});
    print(io::json_text(json));
    return done;
  }
  std::vector<std::vector<std::string>> rows;
  for (const auto& [name, value] : facts.rows) rows.push_back({name, value});
  std::string text = table(rows, {0, 1});
  for (const Note& note : study.notes) text += line_of(note) + "\n";
  print(text);
  return done;
}

}  // namespace

void add_info(CLI::App& program, Command& chosen) {
  auto arguments = std::make_shared<InfoArguments>();
  CommandLine command(program, "info", "Tell what a study holds, and what would be done with it");
  command.option("STUDY", arguments->study, "DICOM file or folder, NIfTI or NRRD file").required();
  add_series_argument(command, arguments->series);
  command.flag("--json", arguments->json, "print JSON");
  command.run(chosen, [arguments](std::stop_token) { return run(*arguments); });
}

}  // namespace dynasurf::app
