#include "dynasurf/report/detail/json_parts.hpp"

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/json_read.hpp"

namespace dynasurf::report::detail {
namespace {

Json options_json(const std::string& text) {
  if (text.empty()) return nullptr;
  try {
    return io::parse_json(text, "the resolved options");
  } catch (const InputError& error) {
    throw OptionError(error.what());
  }
}

}  // namespace

Json provenance_json(const Provenance& provenance) {
  Json inputs = Json::array();
  for (const InputFile& input : provenance.inputs)
    inputs.push_back({{"file", input.name}, {"bytes", input.bytes}, {"sha256", input.sha256}});
  Json json = Json::object();
  json["program"] = "dynasurf";
  json["version"] = provenance.program_version;
  json["commit"] = provenance.commit;
  json["command"] = provenance.command;
  json["inputs"] = std::move(inputs);
  json["seed"] = provenance.seed ? Json(*provenance.seed) : Json(nullptr);
  json["options"] = options_json(provenance.options_json);
  return json;
}

Json placed_notes_json(const Notes& notes) {
  Json json = Json::array();
  for (const Note& note : notes)
    json.push_back({{"severity", name_of(note.severity)},
                    {"code", note.code},
                    {"message", note.message},
                    {"gate", one_based(note.gate)},
                    {"slice", one_based(note.slice)}});
  return json;
}

}  // namespace dynasurf::report::detail
