#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/dicom_item.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

using dicom::decimal, dicom::decimals, dicom::Item, dicom::uid_of;

/// UIDs from the content of a study.
class UidMaker {
 public:
  UidMaker(const Study& study, const std::vector<Uint16>& pixels, const DicomWriteOptions& options) {
    Hasher hasher;
    const auto add = [&](const auto& value) { hasher.add(&value, sizeof value); };
    add(options.uid_seed);
    const Grid& g = study.grid();
    for (const int extent : g.dims) add(extent);
    hasher.add(g.spacing.data(), 3 * sizeof(double));
    hasher.add(g.origin.data(), 3 * sizeof(double));
    hasher.add(g.direction.data(), 9 * sizeof(double));
    add(study.cycle_ms);
    finish(hasher, pixels, options);
  }
  UidMaker(const Projections& p, const std::vector<Uint16>& pixels, const DicomWriteOptions& options) {
    Hasher hasher;
    const auto add = [&](const auto& value) { hasher.add(&value, sizeof value); };
    add(options.uid_seed), add(p.size), add(p.bin_mm), add(p.cycle_ms);
    hasher.add(p.angle_deg.data(), p.angle_deg.size() * sizeof(double));
    hasher.add(p.radius_mm.data(), p.radius_mm.size() * sizeof(double));
    finish(hasher, pixels, options);
  }
  std::string operator()(std::string_view role) const { return uid_of(content_, role); }

 private:
  void finish(Hasher& hasher, const std::vector<Uint16>& pixels, const DicomWriteOptions& options) {
    hasher.add(options.series_description.data(), options.series_description.size());
    hasher.add(options.patient_id.data(), options.patient_id.size());
    hasher.add(pixels.data(), pixels.size() * sizeof(Uint16));
    content_ = hasher.finish();
  }
  Sha256 content_;
};

/// Negative values and those beyond 16 bits are refused, not clipped: a study must be read back as it was.
Uint16 scaled_count(float value, double scale, const std::string& where) {
  const double count = std::floor(value * scale + 0.5);
  if (!(count >= 0) || count > 65535)
    throw OptionError(where + ": the value " + std::to_string(value) + " times counts_scale " + std::to_string(scale) +
                      " does not fit 16 unsigned bits; expected 0 to 65535");
  return static_cast<Uint16>(count);
}

std::vector<Uint16> scaled_counts(const Study& study, double scale, const std::string& where) {
  std::vector<Uint16> counts;
  counts.reserve(study.gates.size() * study.grid().size());
  for (const Image& gate : study.gates)
    for (const float value : gate.values) counts.push_back(scaled_count(value, scale, where));
  return counts;
}

void put_identity(Item& root, const UidMaker& uid, const DicomWriteOptions& options) {
  root.text(DCM_SOPClassUID, UID_NuclearMedicineImageStorage);
  root.text(DCM_SOPInstanceUID, uid("instance"));
  root.text(DCM_StudyInstanceUID, uid("study"));
  root.text(DCM_SeriesInstanceUID, uid("series"));
  root.text(DCM_FrameOfReferenceUID, uid("frame of reference"));
  // Dates are fixed: a synthetic study was never acquired, and the same study must give the same bytes.
  for (const DcmTagKey& tag : {DCM_StudyDate, DCM_SeriesDate, DCM_AcquisitionDate, DCM_ContentDate})
    root.text(tag, "20000101");
  for (const DcmTagKey& tag : {DCM_StudyTime, DCM_SeriesTime, DCM_AcquisitionTime, DCM_ContentTime})
    root.text(tag, "000000");
  root.text(DCM_Modality, "NM");
  root.text(DCM_Manufacturer, "Dynasurf");
  root.text(DCM_SeriesDescription, options.series_description);
  root.text(DCM_PatientName, options.patient_name);
  root.text(DCM_PatientID, options.patient_id);
  for (const DcmTagKey& tag : {DCM_AccessionNumber, DCM_ReferringPhysicianName, DCM_PatientBirthDate, DCM_PatientSex,
                               DCM_PatientOrientation, DCM_PositionReferenceIndicator})
    root.text(tag, "");
  root.text(DCM_StudyID, "1");
  root.text(DCM_SeriesNumber, "1");
  root.text(DCM_InstanceNumber, "1");
}

void put_pixel_format(Item& root, std::size_t frames, int rows, int columns) {
  root.text(DCM_BodyPartExamined, "HEART");
  root.number(DCM_SamplesPerPixel, 1);
  root.text(DCM_PhotometricInterpretation, "MONOCHROME2");
  root.text(DCM_NumberOfFrames, std::to_string(frames));
  root.number(DCM_Rows, rows);
  root.number(DCM_Columns, columns);
  root.number(DCM_BitsAllocated, 16);
  root.number(DCM_BitsStored, 16);
  root.number(DCM_HighBit, 15);
  root.number(DCM_PixelRepresentation, 0);
}

void put_image(Item& root, const Study& study) {
  const Grid& g = study.grid();
  const bool gated = study.gates.size() > 1;
  const std::size_t slices = g.dims[2], gates = study.gates.size();
  root.text(DCM_ImageType,
            gated ? "DERIVED\\PRIMARY\\RECON GATED TOMO\\EMISSION" : "DERIVED\\PRIMARY\\RECON TOMO\\EMISSION");
  put_pixel_format(root, gates * slices, g.dims[1], g.dims[0]);
  // PixelSpacing tells the distance between rows first, then that between columns.
  root.text(DCM_PixelSpacing, decimals({g.spacing[1], g.spacing[0]}));
  root.text(DCM_SliceThickness, decimal(g.spacing[2]));
  // The sign of the spacing tells on which side of the first slice the others lie (NM Reconstruction module).
  const Vec3 normal = g.direction.col(0).cross(g.direction.col(1));
  root.text(DCM_SpacingBetweenSlices, decimal(normal.dot(g.direction.col(2)) < 0 ? -g.spacing[2] : g.spacing[2]));
  std::vector<Uint16> ones(gates * slices, 1), slot, slice;
  for (std::size_t n = 0; n < gates * slices; ++n) {
    slot.push_back(static_cast<Uint16>(n / slices + 1));
    slice.push_back(static_cast<Uint16>(n % slices + 1));
  }
  if (gated) {
    root.tags(DCM_FrameIncrementPointer, {DCM_RRIntervalVector, DCM_TimeSlotVector, DCM_SliceVector});
    root.numbers(DCM_RRIntervalVector, ones);
    root.number(DCM_NumberOfRRIntervals, 1);
    root.numbers(DCM_TimeSlotVector, slot);
    root.number(DCM_NumberOfTimeSlots, gates);
  } else {
    root.tags(DCM_FrameIncrementPointer, {DCM_SliceVector});
  }
  root.numbers(DCM_SliceVector, slice);
  root.number(DCM_NumberOfSlices, g.dims[2]);
  if (study.slice_order != SliceOrder::unknown)
    root.text(DCM_SliceProgressionDirection,
              study.slice_order == SliceOrder::apex_to_base ? "APEX_TO_BASE" : "BASE_TO_APEX");
  if (study.attenuation == Attenuation::corrected) root.text(DCM_CorrectedImage, "ATTN");
}

void put_detector(Item& root, const Study& study) {
  const Grid& g = study.grid();
  const Vec3 r = g.direction.col(0), c = g.direction.col(1);
  root.number(DCM_NumberOfDetectors, 1);
  Item detector = root.add(DCM_DetectorInformationSequence);
  detector.text(DCM_CollimatorType, "PARA");
  detector.text(DCM_FocalDistance, "0");
  detector.text(DCM_ImagePositionPatient, decimals({g.origin[0], g.origin[1], g.origin[2]}));
  detector.text(DCM_ImageOrientationPatient, decimals({r[0], r[1], r[2], c[0], c[1], c[2]}));
  switch (study.view) {
    case View::short_axis:
      detector.code(DCM_ViewCodeSequence, "103340004", "Short Axis");
      break;
    case View::horizontal_long_axis:
      detector.code(DCM_ViewCodeSequence, "131186000", "Horizontal Long Axis");
      break;
    case View::vertical_long_axis:
      detector.code(DCM_ViewCodeSequence, "131185001", "Vertical Long Axis");
      break;
    case View::transaxial:
      detector.code(DCM_ViewCodeSequence, "62824007", "Transverse");
      break;
    case View::unknown:
      break;
  }
}

/// What a camera would have noted; empty where the attribute may be, because nothing was measured. No counts for images
/// that were made of others.
void put_acquisition(Item& root, std::uint64_t counts) {
  root.number(DCM_NumberOfEnergyWindows, 1);
  root.empty_sequence(DCM_EnergyWindowInformationSequence);
  root.empty_sequence(DCM_RadiopharmaceuticalInformationSequence);
  root.number(DCM_NumberOfRotations, 1);
  constexpr std::uint64_t most = 2'147'483'647;  // of an integer string
  root.text(DCM_CountsAccumulated, std::to_string(std::min(counts, most)));
  root.text(DCM_AcquisitionTerminationCondition, "");
  root.empty_sequence(DCM_PatientOrientationCodeSequence);
  root.empty_sequence(DCM_PatientGantryRelationshipCodeSequence);
}

void put_gates(Item& root, std::size_t gates, double first_ms, double step_ms, double cycle_ms) {
  if (gates < 2) return;
  Item gated = root.add(DCM_GatedInformationSequence);
  gated.text(DCM_TriggerTime, decimal(first_ms));
  gated.text(DCM_CardiacFramingType, "FORW");
  Item data = gated.add(DCM_DataInformationSequence);
  // An integer string (IS) holds whole milliseconds only.
  if (cycle_ms > 0) data.text(DCM_NominalInterval, std::to_string(std::lround(cycle_ms)));
  data.text(DCM_FrameTime, decimal(step_ms));
  for (std::size_t g = 0; g < gates; ++g)
    data.add(DCM_TimeSlotInformationSequence).text(DCM_TimeSlotTime, decimal(step_ms));
}

double step_of(const Study& study) {
  if (study.cycle_ms > 0) return study.cycle_ms / study.gates.size();
  return study.time_ms.size() > 1 ? study.time_ms[1] - study.time_ms[0] : 0;
}

/// Head first, as rows are stored.
std::vector<Uint16> pixels_of(const Projections& p, double scale, const std::string& where) {
  std::vector<Uint16> pixels;
  const std::size_t size = p.size;
  for (const std::vector<float>& gate : p.gates)
    for (std::size_t v = 0; v < p.views(); ++v)
      for (std::size_t row = size; row > 0;) {
        --row;
        for (std::size_t column = 0; column < size; ++column)
          pixels.push_back(scaled_count(gate[v * p.bins() + row * size + column], scale, where));
      }
  return pixels;
}

void put_views(Item& root, const Projections& p) {
  const std::size_t views = p.views(), frames = p.gates.size() * views;
  std::vector<Uint16> ones(frames, 1), slot, view;
  for (std::size_t n = 0; n < frames; ++n) {
    slot.push_back(static_cast<Uint16>(n / views + 1));
    view.push_back(static_cast<Uint16>(n % views + 1));
  }
  // The NM Multi-frame module fixes which vectors a kind of image has, also where each counts to 1 alone.
  std::vector<DcmTagKey> order{DCM_EnergyWindowVector, DCM_DetectorVector, DCM_RotationVector};
  for (const DcmTagKey& tag : order) root.numbers(tag, ones);
  if (p.gates.size() > 1) {
    order.insert(order.end(), {DCM_RRIntervalVector, DCM_TimeSlotVector});
    root.numbers(DCM_RRIntervalVector, ones);
    root.number(DCM_NumberOfRRIntervals, 1);
    root.numbers(DCM_TimeSlotVector, slot);
    root.number(DCM_NumberOfTimeSlots, p.gates.size());
  }
  order.push_back(DCM_AngularViewVector);
  root.numbers(DCM_AngularViewVector, view);
  root.tags(DCM_FrameIncrementPointer, order);
}

/// DICOM counts angles from the patient's back towards his left (C.8.4.11): 180 degrees less ours, which fall as ours
/// rise.
void put_rotation(Item& root, const Projections& p) {
  const double step = p.views() > 1 ? p.angle_deg[1] - p.angle_deg[0] : 0;
  const double start = std::fmod(std::fmod(180 - p.angle_deg[0], 360.0) + 360, 360.0);
  Item rotation = root.add(DCM_RotationInformationSequence);
  rotation.text(DCM_StartAngle, decimal(start));
  rotation.text(DCM_AngularStep, decimal(std::abs(step)));
  rotation.text(DCM_RotationDirection, step < 0 ? "CC" : "CW");
  rotation.text(DCM_ScanArc, decimal(std::abs(step) * p.views()));
  rotation.text(DCM_ActualFrameDuration, "1000");
  std::string radii;
  for (const double radius : p.radius_mm) radii += (radii.empty() ? "" : "\\") + decimal(radius);
  rotation.text(DCM_RadialPosition, radii);
  rotation.number(DCM_NumberOfFramesInRotation, p.views());
}

/// The camera where it starts: its rows run to the patient's left when it stands in front of him.
void put_camera(Item& root, const Projections& p) {
  const double angle = p.angle_deg[0] * (M_PI / 180), half = 0.5 * (p.size - 1) * p.bin_mm;
  const Vec3 across{own::cos(angle), own::sin(angle), 0}, towards{own::sin(angle), -own::cos(angle), 0};
  const Vec3 corner = p.centre - half * across + Vec3(0, 0, half) + p.radius_mm[0] * towards;
  root.number(DCM_NumberOfDetectors, 1);
  Item detector = root.add(DCM_DetectorInformationSequence);
  detector.text(DCM_CollimatorType, "PARA");
  detector.text(DCM_FocalDistance, "0");
  detector.text(DCM_ImagePositionPatient, decimals({corner[0], corner[1], corner[2]}));
  detector.text(DCM_ImageOrientationPatient, decimals({across[0], across[1], 0, 0, 0, -1}));
}

}  // namespace

void write_dicom(const Study& study, const std::filesystem::path& path, const DicomWriteOptions& options) {
  const std::string where = path.string();
  if (study.gates.empty()) throw InputError(where + ": cannot write a study without a volume");
  for (const int extent : study.grid().dims)
    if (extent > 65535) throw InputError(where + ": DICOM holds at most 65535 voxels along an axis");
  // A vector of 16-bit numbers stands behind a length of 16 bits: 65534 bytes at most.
  if (study.gates.size() * study.grid().dims[2] > 32767)
    throw InputError(where + ": has more frames than DICOM's frame vectors hold (32767)");
  const std::vector<Uint16> pixels = scaled_counts(study, options.counts_scale, where);

  DcmFileFormat file;
  Item root(*file.getDataset());
  put_identity(root, UidMaker(study, pixels, options), options);
  put_image(root, study);
  put_detector(root, study);
  put_acquisition(root, 0);
  root.empty_sequence(DCM_RotationInformationSequence);
  put_gates(root, study.gates.size(), study.time_ms.empty() ? 0 : study.time_ms.front(), step_of(study),
            study.cycle_ms);
  root.pixels(pixels);

  write_file(path, dicom::bytes_of(file, where));
}

void write_projections(const Projections& p, const std::filesystem::path& path, const DicomWriteOptions& options) {
  const std::string where = path.string();
  if (p.gates.empty() || p.views() == 0) throw InputError(where + ": cannot write projections without a view");
  if (p.gates.size() * p.views() > 32767)
    throw InputError(where + ": has more frames than DICOM's frame vectors hold (32767)");
  const std::vector<Uint16> pixels = pixels_of(p, options.counts_scale, where);
  const bool is_gated = p.gates.size() > 1;

  DcmFileFormat file;
  Item root(*file.getDataset());
  put_identity(root, UidMaker(p, pixels, options), options);
  root.text(DCM_ImageType, is_gated ? "ORIGINAL\\PRIMARY\\GATED TOMO\\EMISSION" : "ORIGINAL\\PRIMARY\\TOMO\\EMISSION");
  put_pixel_format(root, p.gates.size() * p.views(), p.size, p.size);
  root.text(DCM_PixelSpacing, decimals({p.bin_mm, p.bin_mm}));
  put_views(root, p);
  put_camera(root, p);
  put_acquisition(root, std::accumulate(pixels.begin(), pixels.end(), std::uint64_t{0}));
  put_rotation(root, p);
  const double step = is_gated ? p.cycle_ms / p.gates.size() : 0;
  put_gates(root, p.gates.size(), 0, step, p.cycle_ms);
  root.pixels(pixels);

  write_file(path, dicom::bytes_of(file, where));
}

}  // namespace dynasurf::io
