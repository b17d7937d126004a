#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/detail/page_parts.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "option_arguments.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

struct InfoArguments {
  std::string study, series;
  bool json = false, picture = false;
};

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// The studies of a folder that holds more than one.
std::optional<io::StudySearch> several_in(const InfoArguments& a, const std::stop_token& stop) {
  if (!a.series.empty() || !fs::is_directory(a.study)) return std::nullopt;
  io::StudySearch found = io::search_studies(a.study, {{}, stop});
  return found.studies.size() > 1 ? std::optional(std::move(found)) : std::nullopt;
}

constexpr const char* damaged = "damaged: reading it tells what is wrong";

Json json_of(const io::StudySearch& found, const fs::path& folder) {
  Json json{{"studies", Json::array()}, {"left_out", found.left_out.size()}};
  for (const auto& [files, what, examination] : found.studies) {
    Json names = Json::array();
    for (const fs::path& file : files) names.push_back(valid_utf8(file.lexically_relative(folder).generic_string()));
    json["studies"].push_back({{"files", names},
                               {"what", what.empty() ? damaged : what},
                               {"examination", examination > 0 ? Json(examination) : Json()}});
  }
  return json;
}

std::string text_of(const io::StudySearch& found, const fs::path& folder) {
  std::vector<std::vector<std::string>> rows;
  for (const auto& [files, what, examination] : found.studies) {
    std::string place = valid_utf8(files.front().lexically_relative(folder).string());
    // A line break in a name would begin another row.
    std::replace_if(
        place.begin(), place.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
    if (files.size() > 1) place += " and " + std::to_string(files.size() - 1) + " more";
    rows.push_back({place, what.empty() ? damaged : what});
  }
  std::string text = std::to_string(found.studies.size()) + " studies\n" + table(rows, {0, 1});
  if (!found.left_out.empty()) text += std::to_string(found.left_out.size()) + " other files\n";
  return text;
}

/// The slice that shows most of what is bright, in the mean of all gates: 8-bit gray.
Json picture_of(const Study& study) {
  const Index3& n = study.grid().dims;
  const auto pixels = n[0] * static_cast<std::size_t>(n[1]);
  std::vector<float> mean(study.grid().size(), 0.0F);
  for (const Image& gate : study.gates)
    for (std::size_t v = 0; v < mean.size(); ++v) mean[v] += gate.values[v];
  const auto [low, high] = std::minmax_element(mean.begin(), mean.end());
  const float least = *low, range = std::max(*high - *low, 1e-30F);
  const auto bright_in = [&](std::size_t slice) {
    return std::count_if(mean.begin() + static_cast<std::ptrdiff_t>(slice * pixels),
                         mean.begin() + static_cast<std::ptrdiff_t>((slice + 1) * pixels),
                         [&](float v) { return v - least > 0.5F * range; });
  };
  std::size_t best = 0;
  for (std::size_t slice = 1; slice < mean.size() / pixels; ++slice)
    if (bright_in(slice) > bright_in(best)) best = slice;
  report::detail::Bytes gray;
  for (std::size_t p = 0; p < pixels; ++p)
    gray.push_back(static_cast<std::uint8_t>(255 * (mean[best * pixels + p] - least) / range));
  return {{"width", n[0]}, {"height", n[1]}, {"gray", report::detail::base64(gray)}};
}

ExitCode run(const InfoArguments& arguments, const std::stop_token& stop) {
  if (arguments.picture && !arguments.json) throw OptionError("--picture: stands in JSON alone; expected --json too");
  if (const auto found = several_in(arguments, stop)) {
    print(arguments.json ? io::json_text(json_of(*found, arguments.study)) : text_of(*found, arguments.study));
    return done;
  }
  const Study study = io::read_study(arguments.study, arguments.series);
  const io::StudyFacts facts = io::facts_of(arguments.study, study, arguments.series);
  if (arguments.json) {
    Json json = Json::object();
    for (const auto& [name, value] : facts.rows) json[name] = value;
    json["notes"] = Json::array();
    for (const Note& note : study.notes) json["notes"].push_back({{"code", note.code}, {"message", note.message}});
    if (arguments.picture) json["picture"] = picture_of(study);
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
  CommandLine command(program, "info",
                      "Tell what a study or a folder of studies holds, and what would be done with it");
  command.option("STUDY", arguments->study, "DICOM file, NIfTI or NRRD file, or a folder").required();
  add_series_argument(command, arguments->series);
  command.flag("--json", arguments->json, "print JSON");
  command.flag("--picture", arguments->picture,
               "with --json: the slice that shows most of the heart, 8-bit gray in base64");
  command.run(chosen, [arguments](std::stop_token stop) { return run(*arguments, stop); });
}

}  // namespace dynasurf::app
