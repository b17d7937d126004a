#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/study.hpp"

namespace dynasurf::io {

/// Largest volume of data a study may declare, bytes of float values over all gates.
inline constexpr std::size_t max_study_bytes = std::size_t{2} << 30;

/// Reads a gated or ungated heart study: a DICOM file, a folder of DICOM files, a NIfTI (.nii, .nii.gz) or NRRD
/// (.nrrd, .nhdr, .nrrd gzip) file. The format is told from the content, not from the name.
/// `series` chooses among the image series of a DICOM folder: a SeriesInstanceUID, the number that an error lists, or a
/// part of the SeriesDescription; empty: what the folder is meant to hold. The other functions here take the same.
/// Throws InputError (one line: file, place, what was expected) for anything truncated, inconsistent, projected, not
/// supported, or above `max_study_bytes`, before memory is taken for it; IoError when the file cannot be read.
Study read_study(const std::filesystem::path& path, const std::string& series = {});

/// The files `read_study` would read, in a stable order: for provenance.
std::vector<std::filesystem::path> files_of_study(const std::filesystem::path& path, const std::string& series = {});

/// Lower-case hexadecimal SHA-256 of a file. Throws IoError.
std::string sha256_of_file(const std::filesystem::path& path);

/// What `dynasurf info` tells beside the study itself. Never a name, a birth date or an id.
struct StudyFacts {
  std::vector<std::pair<std::string, std::string>> rows;  // "modality" -> "NM", in print order
};
/// The facts of a study that was read from `path`.
StudyFacts facts_of(const std::filesystem::path& path, const Study& study, const std::string& series = {});

// Writers. Each file appears whole or not at all.

/// 4-D NIfTI-1 (float32, sform and qform, RAS; pixdim[4] from the gate times in ms); gzip when the name ends in .gz.
void write_nifti(const Study& study, const std::filesystem::path& path);
/// NRRD with LPS space; 4-D studies as Slicer sequences (.seq.nrrd: fourth axis of kind list). gzip encoding.
void write_nrrd(const Study& study, const std::filesystem::path& path);

/// What a written DICOM file says beside the voxels.
struct DicomWriteOptions {
  std::string series_description = "Dynasurf";
  std::string patient_name = "PHANTOM^DYNASURF";
  std::string patient_id = "PHANTOM";
  double counts_scale = 1;     // stored value = value * counts_scale, rounded; must fit 16 unsigned bits
  std::uint64_t uid_seed = 0;  // UIDs are derived from it and from the content: the same study gives the same bytes
};
/// NM image, RECON GATED TOMO (several gates) or RECON TOMO (one), explicit VR little endian.
void write_dicom(const Study& study, const std::filesystem::path& path, const DicomWriteOptions& options = {});

/// NM image, GATED TOMO (several gates) or TOMO (one): gates, then views, each with the head at the top. Radii stand
/// per view. As `write_dicom` otherwise.
void write_projections(const Projections& projections, const std::filesystem::path& path,
                       const DicomWriteOptions& options = {});

/// What a tree of folders holds of gated heart studies.
struct StudySearch {
  /// The files that make up one study, in a stable order.
  struct Found {
    std::vector<std::filesystem::path> files;
    std::string what;     // "8 gates of 64 x 64 x 20, short axis, rest"; empty: damaged
    int examination = 0;  // DICOM studies of one examination have the same; 0: not known
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
