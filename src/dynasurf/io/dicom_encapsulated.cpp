#include "dynasurf/io/detail/dicom_result_parts.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"

namespace dynasurf::io {
namespace {

using dicom::Item;

/// The document in its item; DICOM pads it to an even length, so its own is told too.
void put_document(DcmItem& dataset, std::string_view document, const char* mime, const std::string& title) {
  Item root(dataset);
  root.text(DCM_DocumentTitle, title);
  root.empty_sequence(DCM_ConceptNameCodeSequence);
  root.text(DCM_AcquisitionDateTime, "");
  root.text(DCM_MIMETypeOfEncapsulatedDocument, mime);
  std::string even(document);
  if (even.size() % 2 != 0) even += '\0';
  dicom::must(dataset.putAndInsertUint8Array(DCM_EncapsulatedDocument, reinterpret_cast<const Uint8*>(even.data()),
                                             static_cast<unsigned long>(even.size())),
              "store the document");
  dicom::must(dataset.putAndInsertUint32(DCM_EncapsulatedDocumentLength, static_cast<Uint32>(document.size())),
              "store the length of the document");
}

DicomInstance save_document(DcmFileFormat& file, const DicomResult& result, const DicomObject& object,
                            const char* sop_class, const std::filesystem::path& path) {
  DicomInstance instance = instance_of(result, object, sop_class);
  dicom::put_context(*file.getDataset(), result, object, instance);
  dicom::save(file, path);
  return instance;
}

}  // namespace

DicomInstance write_encapsulated_stl(const DicomResult& result, const DicomObject& object, const TriMesh& mesh,
                                     const std::filesystem::path& path) {
  detail::check_writable(mesh, {}, path.string());
  DcmFileFormat file;
  DcmDataset& data = *file.getDataset();
  Item root(data);
  root.text(DCM_Modality, "M3D");
  root.text(DCM_BurnedInAnnotation, "NO");
  root.text(DCM_FrameOfReferenceUID, result.subject.frame_of_reference);
  root.text(DCM_PositionReferenceIndicator, "");
  root.code(DCM_MeasurementUnitsCodeSequence, "mm", "mm", "UCUM");
  put_document(data, detail::encode_stl(mesh), "model/stl", object.description);
  return save_document(file, result, object, UID_EncapsulatedSTLStorage, path);
}

DicomInstance write_encapsulated_pdf(const DicomResult& result, const DicomObject& object, std::string_view document,
                                     const std::filesystem::path& path) {
  DcmFileFormat file;
  DcmDataset& data = *file.getDataset();
  Item root(data);
  root.text(DCM_Modality, "DOC");
  root.text(DCM_ConversionType, "WSD");
  root.text(DCM_BurnedInAnnotation, "NO");
  put_document(data, document, "application/pdf", object.description);
  return save_document(file, result, object, UID_EncapsulatedPDFStorage, path);
}

}  // namespace dynasurf::io
