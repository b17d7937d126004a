// What stands in for results as DICOM objects in a build without DCMTK's dcmseg and dcmsr
// (DYNASURF_WITH_DICOM_RESULTS=OFF).

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_results.hpp"

namespace dynasurf::io {
namespace {

[[noreturn]] void refuse(const std::filesystem::path& path) {
  throw IoError(path.string() + ": this build writes no results as DICOM; the native program does");
}

}  // namespace

DicomInstance write_segmentation(const DicomResult&, const DicomObject&, std::span<const DicomSegment>,
                                 const std::filesystem::path& path) {
  refuse(path);
}
DicomInstance write_measurement_report(const DicomResult&, const DicomObject&, std::span<const DicomMeasurementGroup>,
                                       std::span<const std::pair<DicomCode, std::string>>,
                                       const std::filesystem::path& path) {
  refuse(path);
}

}  // namespace dynasurf::io
