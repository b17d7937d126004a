#pragma once
#include <filesystem>
#include <string>
#include <string_view>

#include "dynasurf/io/detail/dicom_results.hpp"
#include "dynasurf/ventricle/result.hpp"

namespace dynasurf::report {

/// Writes a result as DICOM objects of the subject's study into `folder`, which must exist:
/// `measurements.dcm` (SR: every reading of the volumes, rates, phases, segments, the volumes of each gate, verdict and
/// flags), `segmentation_gNN.dcm` (SEG: cavity and wall of a gate), `endo_gNN.dcm` and `epi_gNN.dcm` (encapsulated
/// STL), and, where `pdf` is not empty, `report.dcm` (encapsulated PDF). Surfaces and masks are those of the fit
/// through the blur where there is one, else those of the edges. Gates without both surfaces have no segmentation. The
/// same result, content and time give the same bytes. Throws IoError.
void write_dicom_folder(const ventricle::Result& result, io::DicomResult context, std::string_view pdf,
                        const std::filesystem::path& folder);

}  // namespace dynasurf::report
