#include "slicer.hpp"

#include <algorithm>
#include <filesystem>
#include <mutex>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/detail/vtk_xml.hpp"

#include "console.hpp"
#include "version.hpp"

namespace dynasurf::app {
namespace {

bool slicer_calls = false;

bool is_described(const std::string& command) { return command == "ventricle" || command == "cloud"; }

std::string element(const std::string& name, const std::string& text) {
  return "<" + name + ">" + io::detail::xml_text(text) + "</" + name + ">\n";
}

/// The longest name of an argument without its dashes; of a positional one its own.
std::string name_of(const CLI::Option& option) {
  return option.get_lnames().empty() ? option.get_name(true) : option.get_lnames().front();
}

std::string kind_of(const CLI::Option& option, const std::string& name) {
  if (!option.nonpositional()) return "file";
  if (option.get_expected_max() == 0) return "boolean";
  if (name == "out") return "directory";
  if (name == "mask" || name == "options") return "file";
  return "string";
}

std::string parameter(const CLI::Option& option) {
  const std::string name = name_of(option), kind = kind_of(option, name);
  std::string variable = name;
  std::transform(variable.begin(), variable.end(), variable.begin(),
                 [](unsigned char c) { return std::isalnum(c) ? std::tolower(c) : '_'; });
  const bool many = kind == "string" && option.get_expected_max() > 1;
  std::string text = "<" + kind + (many ? " multiple=\"true\"" : "") + ">\n" + element("name", variable);
  text += option.nonpositional() ? element("longflag", name) : element("index", "0");
  text += element("label", name) + element("description", option.get_description());
  if (kind == "file" || kind == "directory") text += element("channel", kind == "file" ? "input" : "output");
  if (kind == "boolean") text += element("default", "false");
  return text + "</" + kind + ">\n";
}

bool is_shown(const CLI::Option& option) {
  const std::string name = name_of(option);
  const bool is_own = name == "help" || name == "json" || name == "quiet";
  return !is_own && option.get_type_size() <= 1;
}

/// What a result tells in one number each.
std::string returned_text(const nlohmann::ordered_json& results) {
  std::string text;
  for (const auto& [name, value] : results.items())
    if (value.is_number() || value.is_boolean()) text += name + " = " + value.dump() + "\n";
  return text;
}

/// The stage that was told last, so that it can be ended.
struct Stages {
  std::mutex mutex;
  std::string last;
};
Stages& stages() {
  static Stages one;
  return one;
}

}  // namespace

bool asks_for_slicer_description(const std::vector<std::string>& words) {
  return words.size() == 2 && words[1] == "--xml" && is_described(words[0]);
}

std::string slicer_description(const CLI::App& command) {
  const std::string& name = command.get_name();
  std::string text = "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n<executable>\n";
  text += element("category", "Surface Models") + element("title", "Dynasurf " + name);
  text += element("description", command.get_description() + ". Meshes are in LPS, mm. Research use only.");
  text += element("version", version()) + "<parameters>\n";
  text += element("label", "Arguments") + element("description", "As of dynasurf " + name + " --help");
  for (const CLI::Option* option : command.get_options())
    if (is_shown(*option)) text += parameter(*option);
  return text + "</parameters>\n</executable>\n";
}

SlicerCall::SlicerCall(std::vector<std::string>& words) {
  if (words.empty() || !is_described(words[0])) return;
  const auto asked = std::find(words.begin(), words.end(), "--returnparameterfile");
  if (asked == words.end()) return;
  if (asked + 1 == words.end()) throw OptionError("--returnparameterfile: names no file");
  file_ = *(asked + 1);
  words.erase(asked, asked + 2);
  // A parameter that is not set comes as an option with an empty word: both go.
  for (auto word = words.begin(); word != words.end();)
    word = word->starts_with("--") && word + 1 != words.end() && (word + 1)->empty() ? words.erase(word, word + 2)
                                                                                     : word + 1;
  slicer_calls = true;
}

void SlicerCall::write_returned(const CLI::App& program) const {
  if (file_.empty()) return;
  tell_slicer("", 0, 0);
  const CLI::App& command = *program.get_subcommands().front();
  const std::filesystem::path results =
      std::filesystem::path(command.get_option("--out")->as<std::string>()) / "results.json";
  io::write_file(file_, returned_text(io::read_json(results)));
}

void tell_slicer(std::string_view stage, int done, int total) {
  if (!slicer_calls) return;
  const std::lock_guard lock(stages().mutex);
  std::string& last = stages().last;
  std::string text;
  if (stage != last) {
    if (!last.empty())
      text += "<filter-end><filter-name>" + last + "</filter-name><filter-time>0</filter-time></filter-end>\n";
    if (!stage.empty())
      text += "<filter-start><filter-name>" + std::string(stage) +
              "</filter-name><filter-comment></filter-comment></filter-start>\n";
    last = stage;
  }
  if (!stage.empty()) {
    TextOutput part;
    part << static_cast<double>(done) / std::max(total, 1);
    text += "<filter-progress>" + part.str() + "</filter-progress>\n";
  }
  print(text);
}

}  // namespace dynasurf::app
