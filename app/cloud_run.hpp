#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/report/report.hpp"

#include "result_job.hpp"

namespace dynasurf::app {

/// One run of the cloud application, from files on disk to a result folder.
struct CloudJob : ResultJob {
  CloudJob() { mesh_formats = {io::MeshFormat::ply}; }
  std::vector<std::filesystem::path> clouds;
  cloud::Options options;
  bool textures = false;  // textured.glb
  bool packed = false;    // packed.glb
};

struct CloudOutcome {
  report::CloudRun run;
  std::string json;                               // results.json
  std::optional<std::filesystem::path> moved_to;  // where what stood at `job.out` was moved
};

/// Reads, reconstructs, and publishes the folder `job.out`, whole or not at all.
CloudOutcome reconstruct_cloud_to_folder(const CloudJob& job, const Progress& progress);

/// The short table on the terminal: a row per level, then what is doubtful.
std::string summary_of(const report::CloudRun& run);

}  // namespace dynasurf::app
