#include <cmath>

#include "dynasurf/io/detail/dicom_result_parts.hpp"
// DCMTK's own headers want its configuration, which the parts bring.
#include <dcmtk/dcmsr/cmr/tid1500.h>
#include <dcmtk/dcmsr/dsrdoc.h>

namespace dynasurf::io {
namespace {

using dicom::decimal, dicom::must;
using Units = CID7181_AbstractMultiDimensionalImageModelComponentUnits;
using What = CID7469_GenericIntensityAndSizeMeasurements;
using Value = CMR_SRNumericMeasurementValueWithUnits<Units>;

DSRCodedEntryValue entry(const DicomCode& code) {
  return DSRCodedEntryValue(code.value.c_str(), code.scheme.c_str(), code.meaning.c_str());
}

bool has_number(const DicomMeasurementGroup& group) {
  for (const DicomMeasurement& m : group.measurements)
    if (std::isfinite(m.value)) return true;
  return false;
}

/// What both kinds of group hold.
template <class Group>
void fill(Group& place, const DicomMeasurementGroup& group, const DicomResult& result, const DicomObject& object) {
  const std::string uid = dicom::uid_of(result.content, "tracking " + object.role + " " + group.name);
  must(place.setTrackingIdentifier(group.name.c_str()), "name a group");
  must(place.setTrackingUniqueIdentifier(uid.c_str()), "name a group");
  if (!group.time_point.empty()) must(place.setTimePoint(group.time_point.c_str()), "store a gate");
  if (group.method) must(place.setMeasurementMethod(CID6147_ResponseCriteria(entry(*group.method))), "store a method");
  must(place.addFindingSite(entry(group.site)), "store where a measurement was made");
  for (const DicomMeasurement& m : group.measurements)
    if (std::isfinite(m.value))
      must(place.addMeasurement(What(entry(m.what)),
                                Value(decimal(std::round(1000 * m.value) / 1000).c_str(), Units(entry(m.unit)))),
           "store a measurement");
  for (const auto& [what, text] : group.remarks)
    must(place.addQualitativeEvaluation(entry(what), OFString(text.c_str())), "store a remark");
}

void add_groups(TID1500_MeasurementReport& report, std::span<const DicomMeasurementGroup> groups,
                const DicomResult& result, const DicomObject& object) {
  for (const DicomMeasurementGroup& group : groups) {
    if (!has_number(group)) continue;
    if (!group.segments) {
      must(report.addIndividualMeasurements(), "add a group");
      fill(report.getIndividualMeasurements(), group, result, object);
      continue;
    }
    must(report.addVolumetricROIMeasurements(), "add a region");
    auto& place = report.getVolumetricROIMeasurements();
    DSRImageReferenceValue image(group.segments->sop_class.c_str(), group.segments->sop_instance.c_str());
    image.getSegmentList().addItem(static_cast<Uint16>(group.segment));
    must(place.setReferencedSegment(image), "refer to a segment");
    const std::string series =
        result.subject.sources.empty() ? group.segments->series : result.subject.sources.front().series;
    must(place.setSourceSeriesForSegmentation(series.c_str()), "refer to the study");
    fill(place, group, result, object);
  }
}

TID1500_MeasurementReport new_report(const DicomResult& result) {
  TID1500_MeasurementReport report(CMR_CID7021::ImagingMeasurementReport);
  must(report.setLanguage(CID5000_Languages(CID5000_Languages::English)), "store the language");
  must(report.getObservationContext().addDeviceObserver(dicom::uid_of(result.content, "device").c_str(), "Dynasurf",
                                                        "Dynasurf", result.program_version.c_str()),
       "store the observer");
  must(report.addProcedureReported(
           CID100_QuantitativeDiagnosticImagingProcedures(DSRCodedEntryValue("363679005", "SCT", "Imaging procedure"))),
       "store the procedure");
  return report;
}

/// What the document refers to: the study it came from, and the segmentations.
void put_evidence(DSRDocument& document, std::span<const DicomMeasurementGroup> groups, const DicomSubject& subject) {
  auto& evidence = document.getCurrentRequestedProcedureEvidence();
  const auto add = [&](const DicomInstance& instance) {
    must(evidence.addItem(subject.study.c_str(), instance.series.c_str(), instance.sop_class.c_str(),
                          instance.sop_instance.c_str()),
         "refer to an object");
  };
  for (const DicomInstance& source : subject.sources) add(source);
  for (const DicomMeasurementGroup& group : groups)
    if (group.segments) add(*group.segments);
}

}  // namespace

DicomInstance write_measurement_report(const DicomResult& result, const DicomObject& object,
                                       std::span<const DicomMeasurementGroup> groups,
                                       std::span<const std::pair<DicomCode, std::string>> remarks,
                                       const std::filesystem::path& path) {
  DicomInstance instance = instance_of(result, object, UID_EnhancedSRStorage);
  TID1500_MeasurementReport report = new_report(result);
  add_groups(report, groups, result, object);
  for (const auto& [what, text] : remarks)
    must(report.addQualitativeEvaluation(entry(what), OFString(text.c_str())), "store a remark");

  DSRDocument document(DSRTypes::DT_EnhancedSR);
  must(document.setTreeFromRootTemplate(report, OFTrue), "make a report");
  put_evidence(document, groups, result.subject);
  auto& schemes = document.getCodingSchemeIdentification();
  must(schemes.addItem("99DYNASURF"), "name a coding scheme");
  must(schemes.setCodingSchemeName("Terms of Dynasurf that the standard lacks"), "name a coding scheme");
  must(schemes.setCodingSchemeResponsibleOrganization("Dynasurf"), "name a coding scheme");
  must(document.completeDocument(), "complete the report");
  DcmFileFormat file;
  must(document.write(*file.getDataset()), "make a report");
  dicom::put_context(*file.getDataset(), result, object, instance);
  dicom::save(file, path);
  return instance;
}

}  // namespace dynasurf::io
