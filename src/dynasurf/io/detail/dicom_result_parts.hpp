#pragma once
#include "dynasurf/io/detail/dicom_item.hpp"
#include "dynasurf/io/detail/dicom_results.hpp"

// What the writers of DICOM results share.
namespace dynasurf::io::dicom {

/// Patient, study, series, equipment, dates and UIDs of an object: over what stands there.
void put_context(DcmItem& dataset, const DicomResult& result, const DicomObject& object, const DicomInstance& instance);

/// Saves whole or not at all.
void save(DcmFileFormat& file, const std::filesystem::path& path);

}  // namespace dynasurf::io::dicom
