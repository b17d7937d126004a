#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/motion.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::report {

/// What goes into the folder of a ventricle result, beside what always does.
struct StudyFolderOptions {
  std::vector<io::MeshFormat> mesh_formats{io::MeshFormat::ply, io::MeshFormat::vtp};
  mesh::Keyframes keyframes;
  Timings timings = Timings::keep;  // of results.json; the page tells no times, so that equal runs give equal pages
  std::string results_text;         // results.json, for a caller that adds to it; empty: what `results_json` makes
};

/// Writes every file of a result into `folder`, which exists: results.json, results.csv, options.json, report.html,
/// meshes/, cycle.pvd, cycle.glb, measures/, and keyframes/ where asked for. Surfaces are those of the reading that
/// leads; where that is not the edge's, those of the edges stand beside them as `meshes/edge_*`.
/// Throws IoError, and OptionError when `provenance.options_json` is not JSON.
void write_study_files(const ventricle::Result& result, const Provenance& provenance, const StudyFolderOptions& options,
                       const std::filesystem::path& folder);

/// The same as a new folder `out`, which appears whole or not at all. An untouched former result there is replaced.
/// Throws IoError where anything else stands there.
void write_study_folder(const ventricle::Result& result, const std::filesystem::path& out,
                        const Provenance& provenance = {}, const StudyFolderOptions& options = {});

/// What goes into the folder of a cloud's result, beside what always does.
struct CloudFolderOptions {
  std::vector<io::MeshFormat> mesh_formats{io::MeshFormat::ply};
  bool textures = false;  // textured.glb: colours and normals of the points baked into images
  bool packed = false;    // packed.glb: the levels with 16 bits a coordinate, see `io::write_packed_lod_glb`
};

/// Writes the files of a result into `folder`, which exists, but for results.json, which tells how long all of it took:
/// options.json, results.csv, report.html, meshes/, levels.glb, textured.glb, packed.glb. Throws IoError, OptionError.
void write_cloud_files(const CloudRun& run, const Provenance& provenance, const CloudFolderOptions& options,
                       const std::filesystem::path& folder);

/// The same and results.json as a new folder `out`, which appears whole or not at all. An untouched former result there
/// is replaced. Throws IoError where anything else stands there.
void write_cloud_folder(const cloud::Result& result, const std::filesystem::path& out,
                        const Provenance& provenance = {}, const CloudFolderOptions& options = {});

}  // namespace dynasurf::report
