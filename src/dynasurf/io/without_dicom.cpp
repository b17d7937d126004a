// What stands in for DICOM in a build without DCMTK (DYNASURF_WITH_DICOM=OFF).

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_dictionary.hpp"
#include "dynasurf/io/detail/dicom_results.hpp"
#include "dynasurf/io/detail/dicom_search.hpp"
#include "dynasurf/io/detail/formats.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw InputError(path.string() + ": is DICOM, which this build does not read or write; expected NIfTI or NRRD");
}

}  // namespace

void dicom::leave_dictionary_unread() {}
Study read_dicom(const std::filesystem::path& path, const std::string&) { refuse(path); }
std::vector<std::filesystem::path> files_of_dicom(const std::filesystem::path& path, const std::string&) {
  refuse(path);
}
std::vector<std::pair<std::string, std::string>> dicom_facts(const std::filesystem::path& path, const std::string&) {
  refuse(path);
}
void search_dicom(const std::vector<std::filesystem::path>&, StudySearch&, const Progress&) {}

void write_dicom(const Study&, const std::filesystem::path& path, const DicomWriteOptions&) { refuse(path); }
void write_projections(const Projections&, const std::filesystem::path& path, const DicomWriteOptions&) {
  refuse(path);
}
DicomSubject read_dicom_subject(const std::filesystem::path& study, const std::string&) { refuse(study); }
DicomSubject nameless_subject(const Sha256&, const std::string&, const std::string&) { return {}; }
DicomInstance instance_of(const DicomResult&, const DicomObject&, const std::string&) { return {}; }
DicomInstance write_segmentation(const DicomResult&, const DicomObject&, std::span<const DicomSegment>,
                                 const std::filesystem::path& path) {
  refuse(path);
}
DicomInstance write_measurement_report(const DicomResult&, const DicomObject&, std::span<const DicomMeasurementGroup>,
                                       std::span<const std::pair<DicomCode, std::string>>,
                                       const std::filesystem::path& path) {
  refuse(path);
}
DicomInstance write_encapsulated_stl(const DicomResult&, const DicomObject&, const TriMesh&,
                                     const std::filesystem::path& path) {
  refuse(path);
}
DicomInstance write_encapsulated_pdf(const DicomResult&, const DicomObject&, std::string_view,
                                     const std::filesystem::path& path) {
  refuse(path);
}

}  // namespace dynasurf::io
