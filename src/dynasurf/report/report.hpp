#pragma once
#include <cstddef>
#include <filesystem>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "dynasurf/report/provenance.hpp"
#include "dynasurf/ventricle/result.hpp"

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
/// Studies above `most_voxels` are shown with their slices binned; the page says so. Throws OptionError as above.
std::string report_html(const ventricle::Result& result, const Provenance& provenance, Timings timings = Timings::keep,
                        std::size_t most_voxels = 48'000'000);

/// Writes `report_html` whole or not at all. Throws IoError.
void write_report(const ventricle::Result& result, const Provenance& provenance, const std::filesystem::path& path,
                  Timings timings = Timings::keep);

}  // namespace dynasurf::report
