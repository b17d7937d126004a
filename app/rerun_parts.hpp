#pragma once
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_node.hpp"

#include "out_argument.hpp"

// The parts of `dynasurf rerun`: what a result tells of its making, the inputs it names, and what differs.
namespace dynasurf::app {

struct RerunArguments {
  std::string result, mask, start;
  OutFolder out;
  std::vector<std::string> inputs;
  int threads = 0;
  bool quiet = false;
};

/// What a result folder tells of its making, whatever made it.
// NOLINTNEXTLINE(bugprone-exception-escape): the JSON library moves without throwing, though it does not say so.
struct RerunRecord {
  std::string schema, version, commit, command;
  nlohmann::ordered_json options, outputs;
  bool timings = true;
  std::vector<std::string> names, hashes;  // of the inputs
  std::vector<std::uint64_t> bytes;        // likewise; empty where a former version did not tell
  std::string mask_hash, start_hash;       // empty: none was given
  std::string series;                      // that was chosen; likewise
};

/// Throws InputError for what is no result of `ventricle` or `cloud`.
RerunRecord rerun_record_of(const std::filesystem::path& result);

/// Throws InputError "RESULT/results.json: WHAT".
[[noreturn]] void refuse_record(const std::filesystem::path& result, const std::string& what);

/// The words of a list in the record. Throws InputError.
std::vector<std::string> words_in(const io::JsonNode& object, const char* key);
/// The time of DICOM results, YYYYMMDDHHMMSS. Throws InputError.
std::string dicom_time_in(const io::JsonNode& outputs);

/// The study is known by its hash, not by its name, and looked for beside the result and in the working folder.
std::filesystem::path find_study(const RerunArguments& arguments, const RerunRecord& record);
/// The files of a cloud, each known by its hash.
std::vector<std::filesystem::path> find_clouds(const RerunArguments& arguments, const RerunRecord& record);
/// A file that was given beside the study, known by its hash too; empty when none was.
std::filesystem::path find_given(const RerunArguments& arguments, const std::string& hash, const std::string& named,
                                 const std::string& what);

/// A line for a result that is not as it was written; empty for one that is.
std::string alteration_of(const std::filesystem::path& result);
/// The files of either folder that differ, apart from times and memory. `compared`: how many there are.
std::vector<std::string> differences(const std::filesystem::path& before, const std::filesystem::path& after,
                                     const std::stop_token& stop, std::size_t& compared);

}  // namespace dynasurf::app
