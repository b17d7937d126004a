#include <algorithm>
#include <array>
#include <set>

#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/dicom_load.hpp"
#include "dynasurf/io/detail/dicom_result_parts.hpp"
#include "dynasurf/io/detail/formats.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

const std::array subject_texts{
    std::pair{&DicomSubject::character_set, DCM_SpecificCharacterSet},
    std::pair{&DicomSubject::patient_name, DCM_PatientName},
    std::pair{&DicomSubject::patient_id, DCM_PatientID},
    std::pair{&DicomSubject::birth_date, DCM_PatientBirthDate},
    std::pair{&DicomSubject::sex, DCM_PatientSex},
    std::pair{&DicomSubject::study, DCM_StudyInstanceUID},
    std::pair{&DicomSubject::study_date, DCM_StudyDate},
    std::pair{&DicomSubject::study_time, DCM_StudyTime},
    std::pair{&DicomSubject::study_id, DCM_StudyID},
    std::pair{&DicomSubject::study_description, DCM_StudyDescription},
    std::pair{&DicomSubject::accession_number, DCM_AccessionNumber},
    std::pair{&DicomSubject::referring_physician, DCM_ReferringPhysicianName},
};

std::string text_in(DcmItem& item, const DcmTagKey& tag) {
  OFString text;
  return item.findAndGetOFStringArray(tag, text).good() ? std::string(text.c_str()) : std::string();
}

}  // namespace

DicomSubject read_dicom_subject(const fs::path& study, const std::string& series) {
  std::vector<std::uint32_t> wanted;
  const auto want = [&](const DcmTagKey& tag) {
    wanted.push_back(std::uint32_t{tag.getGroup()} << 16 | tag.getElement());
  };
  for (const auto& [member, tag] : subject_texts) want(tag);
  for (const DcmTagKey& tag : {DCM_FrameOfReferenceUID, DCM_SOPClassUID, DCM_SOPInstanceUID, DCM_SeriesInstanceUID})
    want(tag);
  DicomSubject subject;
  for (const fs::path& path : files_of_dicom(study, series)) {
    const auto dataset = dicom::load_wanted(path, outline_of_dicom(path, wanted));
    DcmDataset& data = *dataset;
    if (subject.sources.empty()) {
      for (const auto& [member, tag] : subject_texts) subject.*member = text_in(data, tag);
      subject.frame_of_reference = text_in(data, DCM_FrameOfReferenceUID);
    }
    subject.sources.push_back(
        {text_in(data, DCM_SOPClassUID), text_in(data, DCM_SOPInstanceUID), text_in(data, DCM_SeriesInstanceUID)});
  }
  return subject;
}

DicomSubject nameless_subject(const Sha256& content, const std::string& date, const std::string& time) {
  DicomSubject subject;
  subject.study = dicom::uid_of(content, "study");
  subject.patient_id = "DYNASURF-" + subject.study.substr(5, 12);
  subject.study_id = "1";
  subject.study_date = date;
  subject.study_time = time;
  return subject;
}

DicomInstance instance_of(const DicomResult& result, const DicomObject& object, const std::string& sop_class) {
  return {sop_class, dicom::uid_of(result.content, "instance " + object.role),
          dicom::uid_of(result.content, "series " + object.series_role)};
}

namespace dicom {

void put_context(DcmItem& dataset, const DicomResult& result, const DicomObject& object,
                 const DicomInstance& instance) {
  Item root(dataset);
  // An empty character set means the default repertoire; an empty attribute would be a fault.
  dataset.findAndDeleteElement(DCM_SpecificCharacterSet);
  // The study description is optional too (type 3); the others are of type 2, which must stand there, though empty.
  dataset.findAndDeleteElement(DCM_StudyDescription);
  for (const auto& [member, tag] : subject_texts) {
    const std::string& text = result.subject.*member;
    const bool may_be_empty = tag != DCM_SpecificCharacterSet && tag != DCM_StudyDescription;
    if (!text.empty() || may_be_empty) root.text(tag, text);
  }
  root.text(DCM_SOPClassUID, instance.sop_class);
  root.text(DCM_SOPInstanceUID, instance.sop_instance);
  root.text(DCM_SeriesInstanceUID, instance.series);
  root.text(DCM_SeriesNumber, std::to_string(object.series_number));
  root.text(DCM_InstanceNumber, std::to_string(object.instance_number));
  root.text(DCM_SeriesDescription, object.series_description);
  for (const DcmTagKey& tag : {DCM_InstanceCreationDate, DCM_SeriesDate, DCM_ContentDate}) root.text(tag, result.date);
  for (const DcmTagKey& tag : {DCM_InstanceCreationTime, DCM_SeriesTime, DCM_ContentTime}) root.text(tag, result.time);
  // Enhanced General Equipment wants all four with a value (type 1).
  root.text(DCM_Manufacturer, "Dynasurf");
  root.text(DCM_ManufacturerModelName, "Dynasurf, research use only");
  root.text(DCM_DeviceSerialNumber, "none");
  root.text(DCM_SoftwareVersions, result.program_version);
}

void put_code(Item& item, const DcmTagKey& tag, const DicomCode& code) {
  item.code(tag, code.value, code.meaning, code.scheme);
}

void put_series(Item& item, const DcmTagKey& series, const DcmTagKey& objects,
                std::span<const DicomInstance> instances) {
  std::vector<std::string> uids;
  for (const DicomInstance& instance : instances)
    if (std::find(uids.begin(), uids.end(), instance.series) == uids.end()) uids.push_back(instance.series);
  for (const std::string& uid : uids) {
    Item one = item.add(series);
    one.text(DCM_SeriesInstanceUID, uid);
    std::set<std::string> known;
    for (const DicomInstance& instance : instances) {
      if (instance.series != uid || !known.insert(instance.sop_instance).second) continue;
      Item object = one.add(objects);
      object.text(DCM_ReferencedSOPClassUID, instance.sop_class);
      object.text(DCM_ReferencedSOPInstanceUID, instance.sop_instance);
    }
  }
}

void save(DcmFileFormat& file, const fs::path& path) { write_file(path, bytes_of(file, path.string())); }

}  // namespace dicom
}  // namespace dynasurf::io
