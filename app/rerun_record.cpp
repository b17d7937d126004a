#include <algorithm>
#include <limits>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/folder_file.hpp"
#include "dynasurf/io/detail/json_node.hpp"
#include "dynasurf/io/detail/json_read.hpp"

#include "rerun_parts.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A word that is printed as it stands, such as a version.
std::string plain_word_in(const io::JsonNode& object, const char* key) {
  constexpr std::size_t most = 100;
  std::string word = io::text_in(object, key);
  if (word.size() > most || !std::all_of(word.begin(), word.end(), [](char c) { return c >= ' ' && c <= '~'; }))
    throw InputError(object.file + ": " + object.path + "." + key + ": expected a plain word");
  return word;
}

}  // namespace

[[noreturn]] void refuse_record(const fs::path& result, const std::string& what) {
  throw InputError((result / "results.json").string() + ": " + what);
}

RerunRecord rerun_record_of(const fs::path& result) {
  const fs::path file = io::file_inside(result, "results.json");
  const Json json = io::read_json(file);
  const io::JsonNode results = io::root_of(json, file.string());
  RerunRecord record;
  record.schema = io::text_in(results, "schema");
  if (record.schema != "dynasurf.ventricle/3" && record.schema != "dynasurf.cloud/1")
    refuse_record(result, "expected the schema dynasurf.ventricle/3 or dynasurf.cloud/1");
  const io::JsonNode provenance = io::object_in(results, "provenance");
  record.version = plain_word_in(provenance, "version");
  record.commit = plain_word_in(provenance, "commit");
  record.command = io::text_in(provenance, "command");
  record.options = *io::object_in(provenance, "options").json;
  record.outputs = *io::object_in(provenance, "outputs").json;
  record.timings = io::has(results, "timings_s");
  const io::JsonNode inputs = io::list_in(provenance, "inputs");
  for (std::size_t n = 0; n < io::size_of(inputs); ++n) {
    const io::JsonNode input = io::object_of(inputs, n);
    record.hashes.push_back(io::text_in(input, "sha256"));
    record.names.push_back(io::text_in(input, "file"));
    if (io::has(input, "bytes"))
      record.bytes.push_back(io::whole_in(input, "bytes", 0, std::numeric_limits<std::int64_t>::max()));
  }
  if (io::has(provenance, "given")) {
    const io::JsonNode given = io::object_in(provenance, "given");
    if (io::has(given, "series")) record.series = io::text_in(given, "series");
    if (io::has(given, "mask_sha256")) record.mask_hash = io::text_in(given, "mask_sha256");
    if (io::has(given, "start_mesh_sha256")) record.start_hash = io::text_in(given, "start_mesh_sha256");
  }
  if (record.hashes.empty()) refuse_record(result, "names no input");
  return record;
}

std::vector<std::string> words_in(const io::JsonNode& object, const char* key) {
  const io::JsonNode list = io::list_in(object, key);
  std::vector<std::string> words;
  for (std::size_t n = 0; n < io::size_of(list); ++n) words.push_back(io::text_of(io::item_of(list, n)));
  return words;
}

std::string dicom_time_in(const io::JsonNode& outputs) {
  std::string time = io::text_in(outputs, "dicom_time");
  if (time.size() != 14 || !std::all_of(time.begin(), time.end(), [](char c) { return c >= '0' && c <= '9'; }))
    throw InputError(outputs.file + ": " + outputs.path + ".dicom_time: expected 14 digits, YYYYMMDDHHMMSS");
  return time;
}

}  // namespace dynasurf::app
