#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
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
  std::optional<std::uint64_t> seed;                        // of the random numbers; absent when none were drawn
};

/// How long a run took is the only thing that differs when it is repeated. With `omit` the key `timings_s` is null and
/// the same input and options give the same bytes.
enum class Timings { keep, omit };

/// results.json (schema dynasurf.ventricle/1, docs/results-schema.md), keys in the order of the schema. Gates and
/// slices count from 1. What is absent, infinite or not a number is null. Notes of the study and of the labels that
/// `result.notes` does not hold are added: none is dropped.
/// Throws OptionError when `provenance.options_json` is neither empty nor JSON.
nlohmann::ordered_json results_json(const VentricleResult& result, const Provenance& provenance,
                                    Timings timings = Timings::keep);

/// results.csv: a line of names, then one line per gate; absent values are empty fields.
std::string results_csv(const VentricleResult& result);

/// report.html as text: one self-contained page that loads nothing (Content-Security-Policy `default-src 'none'`), for
/// research use only. Also for results without gates in time, without surfaces, or with one wall missing.
/// Studies above 48 million voxels are shown with their slices binned; the page says so. Throws OptionError as above.
std::string report_html(const VentricleResult& result, const Provenance& provenance, Timings timings = Timings::keep);

/// Writes `report_html` whole or not at all. Throws IoError.
void write_report(const VentricleResult& result, const Provenance& provenance, const std::filesystem::path& path,
                  Timings timings = Timings::keep);

}  // namespace dynasurf
