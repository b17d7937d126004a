#pragma once
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/core/study.hpp"

namespace dynasurf::io {

// The readers behind `read_study`, one per format. Each throws InputError or IoError like it.

Study read_nifti(const std::filesystem::path& path);
Study read_nrrd(const std::filesystem::path& path);
/// `path` is a file or a folder; `series` as for `read_study`.
Study read_dicom(const std::filesystem::path& path, const std::string& series = {});

/// The files beside the header that hold the voxels: the .img of a .hdr, the data file of a .nhdr; else none.
std::vector<std::filesystem::path> data_files_of_nifti(const std::filesystem::path& path);
std::vector<std::filesystem::path> data_files_of_nrrd(const std::filesystem::path& path);
/// The DICOM files a folder is read from, in a stable order; the file itself when `path` is one.
std::vector<std::filesystem::path> files_of_dicom(const std::filesystem::path& path, const std::string& series = {});

/// Acquisition facts of a DICOM study: isotope, corrections, beats. Words come from fixed lists, never from free text.
std::vector<std::pair<std::string, std::string>> dicom_facts(const std::filesystem::path& path,
                                                             const std::string& series = {});

/// Times of gates that are `step_ms` apart, if that makes a believable heart cycle; else none and a note.
void set_uniform_times(Study& study, double first_ms, double step_ms, const std::string& code);

}  // namespace dynasurf::io
