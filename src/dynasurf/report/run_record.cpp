#include "dynasurf/report/detail/run_record.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::report {
namespace {

using Json = nlohmann::ordered_json;

Json words_of(const std::vector<io::MeshFormat>& formats) {
  Json words = Json::array();
  for (const io::MeshFormat format : formats) words.push_back(word_of(format));
  return words;
}

Json text_or_null(const std::optional<std::string>& text) { return text ? Json(*text) : Json(nullptr); }

}  // namespace

std::string neutral_name(const std::filesystem::path& file, std::size_t position) {
  constexpr std::string_view known[] = {".dcm", ".nii", ".nii.gz", ".nrrd", ".nhdr", ".IMA", ".ima",
                                        ".ply", ".xyz", ".txt",    ".asc",  ".pts",  ".csv", ".pwn",
                                        ".obj", ".off", ".stl",    ".las",  ".laz",  ".pcd", ".ptx"};
  std::string ending = file.extension().string();
  if (ending == ".gz") ending = file.stem().extension().string() + ending;
  const bool is_known = std::find(std::begin(known), std::end(known), ending) != std::end(known);
  return "input-" + std::to_string(position + 1) + (is_known ? ending : "");
}

std::string ventricle_results_text(const ventricle::Result& result, const Provenance& provenance,
                                   const VentricleRecord& record) {
  Json json = results_json(result, provenance, record.timings);
  Json& run = json["provenance"];
  run["given"] = {{"mask_sha256", text_or_null(record.mask_sha256)},
                  {"start_mesh_sha256", text_or_null(record.start_mesh_sha256)}};
  if (!result.study.series.empty()) run["given"]["series"] = result.study.series;
  run["outputs"] = {{"mesh_formats", words_of(record.mesh_formats)},
                    {"keep_stages", record.keep_stages},
                    {"dicom", record.dicom},
                    {"dicom_time", text_or_null(record.dicom_time)},
                    {"pdf", record.pdf}};
  if (!record.labels.ending.empty()) {
    run["outputs"]["labels"] = record.labels.ending;
    run["outputs"]["partial_volumes"] = record.labels.partial_volumes;
  }
  return io::json_text(json);
}

std::string cloud_results_text(const CloudRun& run, const Provenance& provenance, const CloudRecord& record) {
  Json json = cloud_results_json(run, provenance, record.timings);
  json["provenance"]["outputs"] = {{"mesh_formats", words_of(record.mesh_formats)}, {"textures", record.textures}};
  if (record.packed) json["provenance"]["outputs"]["packed"] = true;
  return io::json_text(json);
}

}  // namespace dynasurf::report
