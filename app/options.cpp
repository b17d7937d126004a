#include "dynasurf/ventricle/options.hpp"

#include <memory>

#include <nlohmann/json.hpp>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/organ/organ.hpp"
#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/synthetic/terrain.hpp"

#include "command.hpp"
#include "command_line.hpp"
#include "console.hpp"
#include "option_arguments.hpp"

namespace dynasurf::app {
namespace {

using Json = nlohmann::ordered_json;

struct OptionsArguments {
  std::string subject = "ventricle", kind, preset, file;
  std::vector<std::string> settings;
  bool json = false, markdown = false, as_file = false;
};

/// Values of options: to be looked at, and as a file for --options.
struct Values {
  std::vector<OptionRow> rows;
  std::string file;
};

Values values_of(const OptionNodes& nodes, const OptionsArguments& a) {
  if (!a.file.empty()) read_options(a.file, nodes);
  set_options(nodes, a.settings);
  std::string file = io::options_to_text(nodes);  // before the table tries other methods
  return {option_table(nodes), std::move(file)};
}

template <Described O>
Values values_of(O options, const OptionsArguments& a) {
  return values_of(nodes_of(options), a);
}

Values values_of(const OptionsArguments& a) {
  const auto preset_or = [&](const char* usual) { return a.preset.empty() ? usual : a.preset; };
  if (a.subject != "phantom" && !a.kind.empty() &&
      (a.subject == "ventricle" || a.subject == "cloud" || a.subject == "organ"))
    throw OptionError("'" + a.kind + "' follows '" + a.subject + "'; expected nothing");
  if (a.subject == "ventricle") return values_of(ventricle::preset(preset_or("psf_corrected")), a);
  if (a.subject == "cloud") return values_of(cloud::preset(preset_or("shaped")), a);
  if (a.subject == "organ") return values_of(organ::preset(preset_or("ct")), a);
  if (a.subject != "phantom")
    throw OptionError("no options are known of '" + a.subject + "'; choices: ventricle, cloud, organ, phantom KIND");
  if (a.kind == "cloud") return values_of(synthetic::CloudPhantom{}, a);
  if (a.kind == "terrain") return values_of(synthetic::Terrain{}, a);
  if (a.kind == synthetic::CameraPhantom::name) return values_of(synthetic::CameraPhantom{}, a);
  if (a.kind == "patients") return values_of(synthetic::VirtualPatient{}, a);  // what --set says to each of them
  synthetic::PhantomOptions phantom;
  const ChoiceRef kinds = choice_of(phantom);
  return values_of(kinds.choose(position_of(kinds.methods, a.kind, "KIND")), a);
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

ExitCode run(const OptionsArguments& a) {
  const Values values = values_of(a);
  print(a.as_file    ? values.file
        : a.json     ? as_json(values.rows)
        : a.markdown ? as_markdown(values.rows)
                     : as_text(values.rows));
  return done;
}

}  // namespace

void add_options(CLI::App& program, Command& chosen) {
  auto a = std::make_shared<OptionsArguments>();
  CommandLine command(program, "options", "The manual of all options, for --set and --options");
  command.option("SUBJECT", a->subject, "ventricle (the default), cloud, organ or phantom");
  command.option("KIND", a->kind, "kind of phantom");
  command.option("--preset", a->preset, "show the values of a preset of the ventricle or the cloud");
  command.option("--options", a->file,
                 "show the values with those of a JSON file, such as the options.json of a result");
  command.option("--set", a->settings, "show the values with one set: path=value; may be repeated").repeated();
  command.flag("--json", a->json, "print JSON");
  command.flag("--markdown", a->markdown, "print a Markdown table").without("--json");
  command.flag("--as-file", a->as_file, "print the values as a file for --options")
      .without("--json")
      .without("--markdown");
  command.run(chosen, [a](std::stop_token) { return run(*a); });
}

}  // namespace dynasurf::app
