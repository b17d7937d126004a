#pragma once
#include <string>

#include <nlohmann/json.hpp>

#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/detail/label_volumes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::app {

/// What is known of a phantom, as truth.json holds it (schema dynasurf.phantom/1).
nlohmann::ordered_json truth_of(const synthetic::Phantom& phantom);

/// The options of its kind that a phantom was made from.
nlohmann::ordered_json options_of(const synthetic::Phantom& phantom);

/// The voxels of the true walls, into `folder`, if labels are asked for. Throws OptionError unless there are two walls.
void write_true_labels(const synthetic::Phantom& phantom, const report::LabelOutput& labels,
                       const std::filesystem::path& folder);

/// A study as DICOM of counts can hold it: what noise left below 0 is 0.
Study without_negative(Study study);

/// How to store a study so finely that rounding adds nothing to the noise of its counts.
io::DicomWriteOptions finely_stored(const Study& study, const std::string& description);

}  // namespace dynasurf::app
