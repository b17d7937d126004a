#pragma once
#include "dynasurf/io/detail/dicom_item.hpp"
#include "dynasurf/io/detail/dicom_results.hpp"

// What the writers of DICOM results share.
namespace dynasurf::io::dicom {

/// Patient, study, series, equipment, dates and UIDs of an object: over what stands there.
void put_context(DcmItem& dataset, const DicomResult& result, const DicomObject& object, const DicomInstance& instance);

void put_code(Item& item, const DcmTagKey& tag, const DicomCode& code);

/// Objects by series, each once, as a list of references: `series` holds `objects`.
void put_series(Item& item, const DcmTagKey& series, const DcmTagKey& objects,
                std::span<const DicomInstance> instances);

/// Saves whole or not at all.
void save(DcmFileFormat& file, const std::filesystem::path& path);

}  // namespace dynasurf::io::dicom
