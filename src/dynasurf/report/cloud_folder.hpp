#pragma once
#include <filesystem>
#include <vector>

#include "dynasurf/io/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/report/cloud_report.hpp"

namespace dynasurf::report {

/// What goes into the folder of a cloud's result, beside what always does.
struct CloudFolderOptions {
  std::vector<io::MeshFormat> mesh_formats{io::MeshFormat::ply};
  bool textures = false;  // textured.glb: colours and normals of the points baked into images
};

/// Writes the files of a result into `folder`, which exists, but for results.json, which tells how long all of it took:
/// options.json, results.csv, report.html, meshes/, levels.glb, textured.glb. Throws IoError, OptionError.
void write_cloud_files(const CloudRun& run, const Provenance& provenance, const CloudFolderOptions& options,
                       const std::filesystem::path& folder);

/// The same and results.json as a new folder `out`, which appears whole or not at all. An untouched former result there
/// is replaced. Throws IoError where anything else stands there.
void write_cloud_folder(const cloud::Result& result, const std::filesystem::path& out,
                        const Provenance& provenance = {}, const CloudFolderOptions& options = {});

}  // namespace dynasurf::report
