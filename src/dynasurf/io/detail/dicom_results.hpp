#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/io/detail/digest.hpp"

namespace dynasurf::io {

/// One object that others refer to.
struct DicomInstance {
  std::string sop_class, sop_instance, series;
};

/// Whose study it is, in the words of its files. The one place that holds what identifies a person: it goes from the
/// input into DICOM results and nowhere else.
struct DicomSubject {
  std::string character_set, patient_name, patient_id, birth_date, sex;
  std::string study, study_date, study_time, study_id, study_description, accession_number, referring_physician;
  std::string frame_of_reference;      // empty: the file names none
  std::vector<DicomInstance> sources;  // the files the study was read from
};

/// The subject of a DICOM study, of the first file for all but `sources`. Throws InputError for files that are no
/// DICOM.
DicomSubject read_dicom_subject(const std::filesystem::path& study, const std::string& series = {});

/// For studies of formats that name no patient: an id and a study of their own, from the hash of what was read, so that
/// different studies never become one patient; dated `date` (YYYYMMDD) and `time` (HHMMSS).
DicomSubject nameless_subject(const Sha256& content, const std::string& date, const std::string& time);

/// What all objects of one result share.
struct DicomResult {
  DicomSubject subject;
  Sha256 content{};        // of all that the result comes from: UIDs are derived from it
  std::string date, time;  // of the result: YYYYMMDD, HHMMSS
  std::string program_version;
};

/// One object of a result. Its UIDs are derived from the two roles.
struct DicomObject {
  std::string series_role, role;
  int series_number = 1, instance_number = 1;
  std::string series_description, description;
};
/// The UIDs an object has, also before it is written.
DicomInstance instance_of(const DicomResult& result, const DicomObject& object, const std::string& sop_class);

/// A term of a coding scheme: SCT, LN, DCM, UCUM, or the program's own, 99DYNASURF.
struct DicomCode {
  std::string value, scheme, meaning;
};

/// A part of the heart for `write_segmentation`; voxels that are not 0 belong to it.
struct DicomSegment {
  std::string label;
  DicomCode type;
  Mask mask;
  std::array<std::uint16_t, 3> cie_lab{};  // colour to show it in, DICOM's 16-bit CIELab
};

/// SEG, binary, segments numbered from 1 in their order; slices without any voxel of a segment are left out. All masks
/// have one grid. Clean in dciodvfy. Returns what refers to it. Throws InputError for no segment, masks of different
/// grids or without a voxel, IoError.
DicomInstance write_segmentation(const DicomResult& result, const DicomObject& object,
                                 std::span<const DicomSegment> segments, const std::filesystem::path& path);

struct DicomMeasurement {
  DicomCode what;
  double value = 0;
  DicomCode unit;
};
/// Numbers of one thing, read in one way.
struct DicomMeasurementGroup {
  std::string name;                       // tracking identifier
  DicomCode site;                         // where in the body
  std::optional<DicomCode> method;        // how it was read
  std::string time_point;                 // "gate 3"; empty: the beat
  std::optional<DicomInstance> segments;  // the segmentation object that holds the measured part
  int segment = 0;                        // its number there
  std::vector<DicomMeasurement> measurements;
  std::vector<std::pair<DicomCode, std::string>> remarks;  // what, and a text
};

/// SR of template TID 1500: groups with a segment as volumetric regions (TID 1411), others as measurement groups (TID
/// 1501), then `remarks` on the whole; three decimals. Numbers that are not finite are left out, and groups without a
/// number. Clean in dciodvfy. Throws IoError.
DicomInstance write_measurement_report(const DicomResult& result, const DicomObject& object,
                                       std::span<const DicomMeasurementGroup> groups,
                                       std::span<const std::pair<DicomCode, std::string>> remarks,
                                       const std::filesystem::path& path);

/// Encapsulated STL: a mesh in mm, LPS, in the subject's frame of reference. Clean in dciodvfy. Throws as `write_mesh`.
DicomInstance write_encapsulated_stl(const DicomResult& result, const DicomObject& object, const TriMesh& mesh,
                                     const std::filesystem::path& path);
/// Encapsulated PDF; `document` is the file's bytes. Clean in dciodvfy. Throws IoError.
DicomInstance write_encapsulated_pdf(const DicomResult& result, const DicomObject& object, std::string_view document,
                                     const std::filesystem::path& path);

}  // namespace dynasurf::io
