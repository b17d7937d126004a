#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/io/study_io.hpp"

namespace dynasurf::cohort {

/// A study of a cohort, and what is known of it beforehand.
struct CohortStudy {
  std::string id;  // unique; 1 to 64 of A-Z a-z 0-9 . _ -, not a dot first
  std::filesystem::path path;
  std::string series;                // for `read_study`
  std::optional<double> fwhm_mm;     // of the camera
  std::vector<std::string> options;  // of the command line, for this study alone
  std::vector<std::string> groups;   // values of the list's group columns; empty: not known
};

/// The studies of a cohort, in the order of their list.
struct StudyList {
  std::vector<std::string> group_columns;  // names: letters, digits and _
  std::vector<CohortStudy> studies;
};

/// Reads a table of studies, told by the ending of its name: .tsv (cells between tabs), .csv (RFC 4180), .jsonl (an
/// object a line, values are texts and numbers). The columns `path`, `id`, `series`, `fwhm_mm` (or `fwhm`) and
/// `options` (words between blanks) mean what `CohortStudy` says; all others are group columns. Only `path` must be
/// there; it is taken from the folder of the table. Without an id, a study gets one that is made from its path and
/// series as they stand in the table. Throws InputError "FILE: line 3: WHAT; expected WHAT" for anything else, IoError.
StudyList read_study_list(const std::filesystem::path& file);

/// The list as a table (TSV) that `read_study_list` reads, with absolute paths. Throws InputError for a path that a
/// line cannot hold.
std::string study_list_text(const StudyList& list);

/// What was found below `folder` as a list, without groups. The id is made from the path below the folder, and tells
/// nothing of it. A study of several files is the folder that holds them, where it holds nothing else; else links to
/// the files are made in `links`/ID. Throws IoError.
StudyList list_of(const io::StudySearch& found, const std::filesystem::path& folder,
                  const std::filesystem::path& links);

/// 12 hexadecimal digits that tell texts apart.
std::string short_hash(std::string_view text);

}  // namespace dynasurf::cohort
