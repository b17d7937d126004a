#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/cohort/study_list.hpp"

namespace dynasurf::cohort {

/// A study of a BIDS dataset: sub-01/[ses-x/]nm/sub-01[_ses-x][_...]_nm.nii.gz and the like.
struct BidsStudy {
  CohortStudy study;
  std::string participant;       // "sub-01"
  std::filesystem::path folder;  // below the dataset: sub-01/ses-x/nm
};

/// The studies of a dataset, in the order of their paths. Throws InputError when there is none, IoError.
std::vector<BidsStudy> bids_studies(const std::filesystem::path& dataset);

/// The same as a cohort's list. The columns of participants.tsv become groups of the studies; "n/a" is not known.
/// Throws InputError, IoError.
StudyList bids_list(const std::filesystem::path& dataset, std::vector<BidsStudy>& studies);

/// Writes dataset_description.json, and a .bidsignore by which validators skip the cohort's own files and the folders
/// nm: BIDS has no datatype for single-photon studies. Throws IoError.
void describe_derivatives(const std::filesystem::path& out, const std::string& version);

/// What a reader of derivatives looks for, beside the whole result in `out`/cohort: the report and the numbers. Throws
/// IoError.
void publish_derivatives(const std::filesystem::path& out, const BidsStudy& one);

}  // namespace dynasurf::cohort
