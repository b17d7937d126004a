#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/report/detail/label_volumes.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "result_job.hpp"

namespace dynasurf::app {

/// What is written beside numbers and meshes. Kept in results.json (provenance.outputs), so that a run can be repeated.
struct Outputs {
  bool keep_stages = false;
  bool dicom = false;          // the folder dicom: results as objects of the patient's study
  std::string dicom_time;      // YYYYMMDDHHMMSS that they tell; empty: now, without timings the study's
  bool pdf = false;            // report.pdf, printed by Chromium
  report::LabelOutput labels;  // the folder labels: voxels of walls and borders
};

/// One run of the ventricle pipeline, from a study on disk to a result folder.
struct Job : ResultJob {
  Job() { mesh_formats = {io::MeshFormat::ply, io::MeshFormat::vtp}; }
  std::filesystem::path study;
  std::string series;                // of a DICOM folder; empty: not asked for
  std::filesystem::path start_mesh;  // for placement.shape file; else empty
  std::filesystem::path mask;        // outside which nothing is looked at; empty: none
  ventricle::Options options;
  Outputs outputs;
};

struct Outcome {
  ventricle::Result result;
  std::string json;                               // results.json
  std::optional<std::filesystem::path> moved_to;  // where what stood at `job.out` was moved
};

/// Reads, reconstructs, and publishes the folder `job.out`, whole or not at all.
Outcome reconstruct_to_folder(const Job& job, const Progress& progress);

/// SHA-256 of every file of a study, in the order of `files_of_study`.
std::vector<std::string> hashes_of_study(const std::filesystem::path& study, const std::string& series = {});

}  // namespace dynasurf::app
