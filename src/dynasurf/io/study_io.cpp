#include "dynasurf/io/study_io.hpp"

#include <cstring>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/dicom_look.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/detail/nifti_format.hpp"
#include "dynasurf/io/detail/study_mend.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

enum class Format { dicom, nifti, nrrd };

/// NIfTI-1 begins with the size of its header, 348, in either byte order; NIfTI-2 with 540.
bool looks_like_nifti(const std::string& head) {
  constexpr const char little[] = "\x5c\x01\0\0", big[] = "\0\0\x01\x5c";
  return head.size() >= 4 && (std::memcmp(head.data(), little, 4) == 0 || std::memcmp(head.data(), big, 4) == 0);
}

/// By the content alone: names of medical files tell little. What is packed by gzip is looked into.
Format format_of(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) return Format::dicom;
  const std::string head = first_bytes(path, 132);
  const DicomLook look = dicom_look_of(head);
  if (look == DicomLook::preamble) return Format::dicom;
  if (head.compare(0, 4, "NRRD") == 0) {
    if (is_gzip_file(path))
      throw InputError(path.string() + ": is a NRRD file packed as a whole; unpack it with gunzip first");
    return Format::nrrd;
  }
  if (looks_like_nifti(head)) return Format::nifti;
  if (head.compare(0, 4, std::string("\x1c\x02\0\0", 4)) == 0 ||
      head.compare(0, 4, std::string("\0\0\x02\x1c", 4)) == 0)
    throw InputError(path.string() + ": is NIfTI-2; expected NIfTI-1, DICOM or NRRD");
  if (look == DicomLook::bare) return Format::dicom;
  throw InputError(path.string() +
                   (size_of_file(path) == 0 ? ": is empty" : ": is not a heart study that can be read") +
                   "; expected DICOM, NIfTI or NRRD");
}

void require_dicom(const fs::path& path, Format format, const std::string& series) {
  if (!series.empty() && format != Format::dicom)
    throw InputError(path.string() + ": has no series to choose from; expected DICOM");
}

}  // namespace

Study read_study(const std::filesystem::path& path, const std::string& series) {
  const Format format = format_of(path);
  require_dicom(path, format, series);
  Study study = format == Format::nifti  ? read_nifti(path)
                : format == Format::nrrd ? read_nrrd(path)
                                         : read_dicom(path, series);
  mend_hot_voxels(study);
  fill_empty_gates(study);
  return study;
}

std::vector<std::filesystem::path> files_of_study(const std::filesystem::path& path, const std::string& series) {
  std::vector<fs::path> files{path};
  const Format format = format_of(path);
  require_dicom(path, format, series);
  if (format == Format::dicom) return files_of_dicom(path, series);
  for (const fs::path& data : format == Format::nifti ? data_files_of_nifti(path) : data_files_of_nrrd(path))
    files.push_back(data);
  return files;
}

}  // namespace dynasurf::io
