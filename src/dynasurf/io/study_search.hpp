#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/core/progress.hpp"

namespace dynasurf::io {

/// What a tree of folders holds of gated heart studies.
struct StudySearch {
  /// The files that make up one study, in a stable order.
  struct Found {
    std::vector<std::filesystem::path> files;
  };
  struct LeftOut {
    std::filesystem::path file;
    std::string reason;  // in words and numbers of this program, none of the file's own text
  };
  std::vector<Found> studies;  // in the order of their first files
  std::vector<LeftOut> left_out;
};

/// Looks into every file below `folder`. DICOM files are told apart by what they are: those of one study and series
/// become stacks as `read_study` makes them, and gated ones that may be short-axis are found; projections, static and
/// reoriented images, reports and copies are left out with their reason. NIfTI and NRRD files are found where they hold
/// more than one gate. A damaged file that begins as a study counts as one, so that reading it tells what is wrong.
/// Every other file is left out. Time is linear in the files, their headers are kept.
/// Throws IoError when a folder cannot be listed, InputError above a million files, Cancelled.
StudySearch search_studies(const std::filesystem::path& folder, const Progress& progress = {});

}  // namespace dynasurf::io
