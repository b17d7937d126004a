#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/detail/label_volumes.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::report {

/// A file as provenance tells it: its place among the inputs and its ending, "input-1.dcm". Its own name may name a
/// person.
std::string neutral_name(const std::filesystem::path& file, std::size_t position);

/// What a ventricle run was given beside its study, and what it writes beside numbers and meshes.
struct VentricleRecord {
  std::optional<std::string> mask_sha256, start_mesh_sha256;
  std::vector<io::MeshFormat> mesh_formats{io::MeshFormat::ply, io::MeshFormat::vtp};
  bool keep_stages = false, dicom = false, pdf = false;
  LabelOutput labels;
  std::optional<std::string> dicom_time;  // that DICOM results tell; absent: not to be repeated
  Timings timings = Timings::keep;
};

/// results.json of a run that can be repeated: `results_json` with the keys `given` and `outputs` of its provenance.
/// Throws as it does.
std::string ventricle_results_text(const ventricle::Result& result, const Provenance& provenance,
                                   const VentricleRecord& record);

/// The same of a cloud.
struct CloudRecord {
  std::vector<io::MeshFormat> mesh_formats{io::MeshFormat::ply};
  bool textures = false, packed = false;
  Timings timings = Timings::keep;
};
std::string cloud_results_text(const CloudRun& run, const Provenance& provenance, const CloudRecord& record);

}  // namespace dynasurf::report
