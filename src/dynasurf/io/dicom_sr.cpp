#include <algorithm>
#include <cmath>

#include "dynasurf/io/detail/dicom_result_parts.hpp"

namespace dynasurf::io {
namespace {

using dicom::Item;

DicomCode dcm(const char* value, const char* meaning) { return {value, "DCM", meaning}; }

constexpr const char *contains = "CONTAINS", *modifies = "HAS CONCEPT MOD", *observed = "HAS OBS CONTEXT";

/// A node of the tree of content, without what its type asks for.
Item add_node(Item& parent, const char* relation, const char* type, const DicomCode& name) {
  Item node = parent.add(DCM_ContentSequence);
  node.text(DCM_RelationshipType, relation);
  node.text(DCM_ValueType, type);
  dicom::put_code(node, DCM_ConceptNameCodeSequence, name);
  return node;
}

void add_text(Item& parent, const char* relation, const DicomCode& name, const std::string& text) {
  add_node(parent, relation, "TEXT", name).text(DCM_TextValue, text);
}

void add_uid(Item& parent, const char* relation, const DicomCode& name, const std::string& uid) {
  add_node(parent, relation, "UIDREF", name).text(DCM_UID, uid);
}

void add_term(Item& parent, const char* relation, const DicomCode& name, const DicomCode& term) {
  Item node = add_node(parent, relation, "CODE", name);
  dicom::put_code(node, DCM_ConceptCodeSequence, term);
}

void add_number(Item& parent, const DicomMeasurement& m) {
  Item node = add_node(parent, contains, "NUM", m.what);
  Item value = node.add(DCM_MeasuredValueSequence);
  dicom::put_code(value, DCM_MeasurementUnitsCodeSequence, m.unit);
  value.text(DCM_NumericValue, dicom::decimal(std::round(1000 * m.value) / 1000));
}

void put_template(Item& container, const char* id) {
  Item item = container.add(DCM_ContentTemplateSequence);
  item.text(DCM_MappingResource, "DCMR");
  item.text(DCM_MappingResourceUID, UID_DICOMContentMappingResource);
  item.text(DCM_TemplateIdentifier, id);
}

Item add_container(Item& parent, const DicomCode& name) {
  Item container = add_node(parent, contains, "CONTAINER", name);
  container.text(DCM_ContinuityOfContent, "SEPARATE");
  return container;
}

bool has_number(const DicomMeasurementGroup& group) {
  return std::any_of(group.measurements.begin(), group.measurements.end(),
                     [](const DicomMeasurement& m) { return std::isfinite(m.value); });
}

void add_segment_reference(Item& place, const DicomMeasurementGroup& group, const DicomSubject& subject) {
  Item image = add_node(place, contains, "IMAGE", dcm("121191", "Referenced Segment"));
  Item reference = image.add(DCM_ReferencedSOPSequence);
  reference.text(DCM_ReferencedSOPClassUID, group.segments->sop_class);
  reference.text(DCM_ReferencedSOPInstanceUID, group.segments->sop_instance);
  reference.number(DCM_ReferencedSegmentNumber, group.segment);
  add_uid(place, contains, dcm("121232", "Source series for segmentation"),
          subject.sources.empty() ? group.segments->series : subject.sources.front().series);
}

void add_group(Item& parent, const DicomMeasurementGroup& group, const DicomResult& result, const DicomObject& object) {
  Item place = add_container(parent, dcm("125007", "Measurement Group"));
  put_template(place, group.segments ? "1411" : "1501");
  add_text(place, observed, dcm("112039", "Tracking Identifier"), group.name);
  add_uid(place, observed, dcm("112040", "Tracking Unique Identifier"),
          dicom::uid_of(result.content, "tracking " + object.role + " " + group.name));
  if (!group.time_point.empty()) add_text(place, observed, {"C2348792", "UMLS", "Time Point"}, group.time_point);
  if (group.segments) add_segment_reference(place, group, result.subject);
  if (group.method) add_term(place, modifies, {"370129005", "SCT", "Measurement Method"}, *group.method);
  add_term(place, modifies, {"363698007", "SCT", "Finding Site"}, group.site);
  for (const DicomMeasurement& m : group.measurements)
    if (std::isfinite(m.value)) add_number(place, m);
  for (const auto& [what, text] : group.remarks) add_text(place, contains, what, text);
}

/// What is said of the whole: the language, the observer, what was done. TID 1204, and TID 1002 with 1004 for a device.
void add_observation(Item& root, const DicomResult& result) {
  add_term(root, modifies, dcm("121049", "Language of Content Item and Descendants"), {"eng", "RFC5646", "English"});
  add_term(root, observed, dcm("121005", "Observer Type"), dcm("121007", "Device"));
  add_uid(root, observed, dcm("121012", "Device Observer UID"), dicom::uid_of(result.content, "device"));
  add_text(root, observed, dcm("121013", "Device Observer Name"), "Dynasurf");
  add_text(root, observed, dcm("121014", "Device Observer Manufacturer"), "Dynasurf");
  add_text(root, observed, dcm("121015", "Device Observer Model Name"), result.program_version);
  add_term(root, modifies, dcm("121058", "Procedure reported"), {"363679005", "SCT", "Imaging procedure"});
}

void add_content(Item& root, std::span<const DicomMeasurementGroup> groups,
                 std::span<const std::pair<DicomCode, std::string>> remarks, const DicomResult& result,
                 const DicomObject& object) {
  add_observation(root, result);
  Item measurements = add_container(root, dcm("126010", "Imaging Measurements"));
  // The template wants regions before other groups.
  for (const bool of_regions : {true, false})
    for (const DicomMeasurementGroup& group : groups)
      if (has_number(group) && group.segments.has_value() == of_regions) add_group(measurements, group, result, object);
  if (remarks.empty()) return;
  Item evaluations = add_container(root, {"C0034375", "UMLS", "Qualitative Evaluations"});
  for (const auto& [what, text] : remarks) add_text(evaluations, contains, what, text);
}

/// What the document refers to: the study it came from, and the segmentations.
void put_evidence(Item& root, std::span<const DicomMeasurementGroup> groups, const DicomSubject& subject) {
  std::vector<DicomInstance> instances = subject.sources;
  for (const DicomMeasurementGroup& group : groups)
    if (group.segments) instances.push_back(*group.segments);
  if (instances.empty()) return;
  Item study = root.add(DCM_CurrentRequestedProcedureEvidenceSequence);
  dicom::put_series(study, DCM_ReferencedSeriesSequence, DCM_ReferencedSOPSequence, instances);
  study.text(DCM_StudyInstanceUID, subject.study);
}

}  // namespace

DicomInstance write_measurement_report(const DicomResult& result, const DicomObject& object,
                                       std::span<const DicomMeasurementGroup> groups,
                                       std::span<const std::pair<DicomCode, std::string>> remarks,
                                       const std::filesystem::path& path) {
  DicomInstance instance = instance_of(result, object, UID_EnhancedSRStorage);
  DcmFileFormat file;
  Item root(*file.getDataset());
  root.text(DCM_Modality, "SR");
  root.empty_sequence(DCM_ReferencedPerformedProcedureStepSequence);  // type 2
  root.empty_sequence(DCM_PerformedProcedureCodeSequence);
  root.text(DCM_CompletionFlag, "COMPLETE");
  root.text(DCM_VerificationFlag, "UNVERIFIED");  // no person has signed it
  root.text(DCM_ValueType, "CONTAINER");
  dicom::put_code(root, DCM_ConceptNameCodeSequence, dcm("126000", "Imaging Measurement Report"));
  root.text(DCM_ContinuityOfContent, "SEPARATE");
  put_template(root, "1500");
  add_content(root, groups, remarks, result, object);
  put_evidence(root, groups, result.subject);
  Item scheme = root.add(DCM_CodingSchemeIdentificationSequence);
  scheme.text(DCM_CodingSchemeDesignator, "99DYNASURF");
  scheme.text(DCM_CodingSchemeName, "Terms of Dynasurf that the standard lacks");
  scheme.text(DCM_CodingSchemeResponsibleOrganization, "Dynasurf");
  dicom::put_context(*file.getDataset(), result, object, instance);
  dicom::save(file, path);
  return instance;
}

}  // namespace dynasurf::io
