#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf {

/// Where a result comes from: enough to repeat it byte for byte.
struct Provenance {
  std::string program_version, commit;
  std::string command;                                      // command line without paths that name a person
  std::vector<std::pair<std::string, std::string>> inputs;  // file name (not path), SHA-256
  std::string options_json;                                 // resolved options
};

/// results.json (schema dynasurf.ventricle/1, docs/results-schema.md).
nlohmann::json results_json(const VentricleResult& result, const Provenance& provenance);
/// results.csv: one row per gate.
std::string results_csv(const VentricleResult& result);

/// report.html: one self-contained page (no network, research use only). Throws IoError.
void write_report(const VentricleResult& result, const Provenance& provenance, const std::filesystem::path& path);

}  // namespace dynasurf
