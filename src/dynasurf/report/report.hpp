#pragma once
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "dynasurf/cloud/result.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::ventricle {
struct BorderResult;
}

namespace dynasurf::report {

/// results.json (schema dynasurf.ventricle/3, docs/results.md), keys in the order of the schema. Gates and
/// slices count from 1. What is absent, infinite or not a number is null. Notes of the study and of the labels that
/// `result.notes` does not hold are added: none is dropped.
/// Throws OptionError when `provenance.options_json` is neither empty nor JSON.
nlohmann::ordered_json results_json(const ventricle::Result& result, const Provenance& provenance,
                                    Timings timings = Timings::keep);

/// results.csv: a line of names, then one line per gate; absent values are empty fields.
std::string results_csv(const ventricle::Result& result);

/// report.html as text: one self-contained page that loads nothing (Content-Security-Policy `default-src 'none'`), for
/// research use only. Also for results without gates in time, without surfaces, or with one wall missing.
/// Studies above `most_voxels` are shown with their slices binned, which the page says; images of the fit above it are
/// left out. Throws OptionError as above.
std::string report_html(const ventricle::Result& result, const Provenance& provenance, Timings timings = Timings::keep,
                        std::size_t most_voxels = 48'000'000);

/// What a page draws of the borders of one gate, as JSON: the grid of the stack, a byte of marks per voxel (1 endo, 2
/// epi, 4 minor edge, 8 major edge) and the fields around both borders; where the heart was found, and all notes.
/// `gate` counts from 0.
std::string borders_json(const ventricle::BorderResult& result, int gate, std::size_t most_voxels = 48'000'000);

/// The heart of a file that holds `borders_json`, to the bit; absent where it has none. Throws InputError, IoError.
std::optional<heart::Location> read_location(const std::filesystem::path& path);

/// Writes `report_html` whole or not at all. Throws IoError.
void write_report(const ventricle::Result& result, const Provenance& provenance, const std::filesystem::path& path,
                  Timings timings = Timings::keep);

/// One run of the cloud application.
struct CloudRun {
  std::vector<io::CloudSource> sources;                 // one per file
  cloud::Result result;                                 // its notes hold those of reading too
  std::vector<std::pair<std::string, double>> seconds;  // per stage, in order
  std::size_t peak_bytes = 0;                           // of memory that the program has held; 0: not known
};

/// Whether the verdict is not `fail`.
bool is_trustworthy(const cloud::Result& result);

/// Name of a level's files without ending: "level2", or "level2_not_watertight" (of an open surface "level2_not_sound")
/// where its certificate does not hold.
/// Levels count from 0 here and from 1 in names.
std::string name_of_level(const cloud::Result& result, std::size_t level);

/// results.json of a cloud (schema dynasurf.cloud/1, docs/results.md), keys in the order of the schema. Levels
/// count from 1. What is absent, infinite or not a number is null. Throws OptionError when `provenance.options_json` is
/// neither empty nor JSON.
nlohmann::ordered_json cloud_results_json(const CloudRun& run, const Provenance& provenance,
                                          Timings timings = Timings::keep);

/// results.csv of a cloud: a line of names, then one line per level.
std::string cloud_results_csv(const cloud::Result& result);

/// report.html of a cloud as text: one self-contained page that loads nothing: the points, the levels side by side and
/// in morph, the error as colour, the certificates. Shows 50,000 points at most, evenly taken. Throws OptionError as
/// above.
std::string cloud_report_html(const CloudRun& run, const Provenance& provenance, Timings timings = Timings::keep);

/// Writes `cloud_report_html` whole or not at all. Throws IoError.
void write_cloud_report(const CloudRun& run, const Provenance& provenance, const std::filesystem::path& path,
                        Timings timings = Timings::keep);

}  // namespace dynasurf::report
