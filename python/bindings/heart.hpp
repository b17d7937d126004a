#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/report/detail/run_record.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "origin.hpp"
#include "stage_cache.hpp"

namespace dynasurf::python {

/// What `dynasurf ventricle` would be told, and the functions of Python that replace stages.
struct HeartRun {
  std::shared_ptr<OriginStudy> study;
  std::string preset;
  ventricle::Options options;
  std::shared_ptr<Image> mask;
  std::shared_ptr<TriMesh> start;
  std::optional<std::string> mask_sha256, start_sha256;  // of the files they come from
  ventricle::OwnStages own;
  std::shared_ptr<StageCache> cache;  // null: none
};

/// A finished run: the result, and where it comes from.
struct Heart {
  ventricle::Result result;
  ventricle::Options options;
  report::Provenance provenance;
  std::optional<std::string> mask_sha256, start_sha256;
  std::shared_ptr<OriginStudy> study;  // as given: labels lie on its grid
};

/// What goes into the folder of a heart, by the words of the command line.
struct HeartOutputs {
  std::vector<std::string> mesh_formats;
  bool timings = true, replace = false;
  report::LabelOutput labels;
};

std::shared_ptr<Heart> reconstruct_heart(const HeartRun& run, const Progress& progress);

/// Writes the folder of `dynasurf ventricle`. Throws IoError, OptionError.
void save_heart(const Heart& heart, const std::filesystem::path& folder, const HeartOutputs& outputs);

/// The formats by their words. Throws OptionError.
std::vector<io::MeshFormat> formats_from(const std::vector<std::string>& words);

}  // namespace dynasurf::python
