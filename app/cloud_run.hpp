#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/cloud_report.hpp"

namespace dynasurf::app {

/// What is written beside the numbers. Kept in results.json (provenance.outputs), so that a run can be repeated.
struct CloudOutputs {
  std::vector<MeshFormat> mesh_formats{MeshFormat::ply};
  bool textures = false;  // textured.glb
  bool timings = true;
};

/// One run of the cloud application, from files on disk to a result folder.
struct CloudJob {
  std::vector<std::filesystem::path> clouds;
  std::filesystem::path out;
  CloudOptions options;
  CloudOutputs outputs;
  std::string command;                      // for the provenance
  bool file_names = false;                  // record the names of the input files
  std::vector<std::string> recorded_names;  // of the input files, when an earlier run gave them
  int threads = 0;                          // 0: as many as the machine has
};

struct CloudOutcome {
  CloudRun run;
  std::string json;  // results.json
};

/// Reads, reconstructs, and publishes the folder `job.out`, whole or not at all.
CloudOutcome reconstruct_cloud_to_folder(const CloudJob& job, const Progress& progress);

/// The short table on the terminal: a row per level, then what is doubtful.
std::string summary_of(const CloudRun& run);

}  // namespace dynasurf::app
