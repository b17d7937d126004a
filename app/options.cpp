#include "dynasurf/ventricle/options.hpp"

#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/organ/organ.hpp"
#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/synthetic/terrain.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"

namespace dynasurf::app {
namespace {

using Json = nlohmann::ordered_json;

struct OptionsArguments {
  std::string subject = "ventricle", kind, preset;
  bool json = false, markdown = false;
};

std::vector<OptionRow> rows_of(const OptionsArguments& arguments) {
  const auto preset_or = [&](const char* usual) { return arguments.preset.empty() ? usual : arguments.preset; };
  if (arguments.subject == "ventricle") {
    if (!arguments.kind.empty()) throw OptionError("'" + arguments.kind + "' follows 'ventricle'; expected nothing");
    return option_table(ventricle::preset(preset_or("psf_corrected")));
  }
  if (arguments.subject == "cloud") {
    if (!arguments.kind.empty()) throw OptionError("'" + arguments.kind + "' follows 'cloud'; expected nothing");
    return option_table(cloud::preset(preset_or("shaped")));
  }
  if (arguments.subject == "organ") {
    if (!arguments.kind.empty()) throw OptionError("'" + arguments.kind + "' follows 'organ'; expected nothing");
    return option_table(organ::preset(preset_or("ct")));
  }
  if (arguments.subject != "phantom")
    throw OptionError("no options are known of '" + arguments.subject +
                      "'; choices: ventricle, cloud, organ, phantom KIND");
  if (arguments.kind == "cloud") return option_table(synthetic::CloudPhantom{});
  if (arguments.kind == "terrain") return option_table(synthetic::Terrain{});
  if (arguments.kind == synthetic::CameraPhantom::name) return option_table(synthetic::CameraPhantom{});
  if (arguments.kind == "patients")
    return option_table(synthetic::VirtualPatient{});  // what --set says to each of them
  synthetic::PhantomOptions phantom;
  const ChoiceRef kinds = choice_of(phantom);
  return option_table(kinds.choose(position_of(kinds.methods, arguments.kind, "KIND")));
}

std::string limits_of(const OptionRow& row) { return row.choices.empty() ? row.range : row.choices; }

/// The path with the method in brackets where the option belongs to one of several.
std::string path_of(const OptionRow& row) { return row.path + (row.method.empty() ? "" : " (" + row.method + ")"); }

std::string as_text(const std::vector<OptionRow>& rows) {
  std::vector<std::vector<std::string>> cells{{"option", "default", "unit", "range or choices", "meaning"}};
  for (const OptionRow& row : rows)
    cells.push_back({path_of(row), row.default_value, row.unit, limits_of(row), row.doc});
  return table(cells, {0, 1, 2, 3, 4});
}

std::string as_markdown(const std::vector<OptionRow>& rows) {
  const auto cell = [](std::string text) {
    for (std::size_t bar = text.find('|'); bar != std::string::npos; bar = text.find('|', bar + 2))
      text.insert(bar, "\\");
    return " " + text + (text.empty() ? "|" : " |");
  };
  std::string text = "| option | default | unit | range or choices | meaning |\n|---|---|---|---|---|\n";
  for (const OptionRow& row : rows)
    text += "|" + cell("`" + row.path + "`" + (row.method.empty() ? "" : " (" + row.method + ")")) +
            cell(row.default_value) + cell(row.unit) + cell(limits_of(row)) + cell(row.doc) + "\n";
  return text;
}

std::string as_json(const std::vector<OptionRow>& rows) {
  Json json = Json::array();
  for (const OptionRow& row : rows)
    json.push_back({{"path", row.path},
                    {"method", row.method.empty() ? Json() : Json(row.method)},
                    {"default", row.default_value},
                    {"unit", row.unit},
                    {"range", row.range},
                    {"choices", row.choices},
                    {"meaning", row.doc}});
  return io::json_text(json);
}

ExitCode run(const OptionsArguments& arguments) {
  const std::vector<OptionRow> rows = rows_of(arguments);
  print(arguments.json ? as_json(rows) : arguments.markdown ? as_markdown(rows) : as_text(rows));
  return done;
}

}  // namespace

void add_options(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<OptionsArguments>();
  CommandLine command(program, "options", "The manual of all options, for --set and --options");
  command.option("SUBJECT", a->subject, "ventricle (the default), cloud, organ or phantom");
  command.option("KIND", a->kind, "kind of phantom");
  command.option("--preset", a->preset, "show the values of a preset of the ventricle or the cloud");
  command.flag("--json", a->json, "print JSON");
  command.flag("--markdown", a->markdown, "print a Markdown table").without("--json");
  command.run(chosen, [a](std::stop_token) { return run(*a); });
}

}  // namespace dynasurf::app
