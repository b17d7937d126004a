#include <algorithm>
#include <memory>
#include <set>

#include "dynasurf/io/detail/dicom_result_parts.hpp"
// DCMTK's own headers want its configuration, which the parts bring.
#include <dcmtk/dcmfg/fgderimg.h>
#include <dcmtk/dcmfg/fgfracon.h>
#include <dcmtk/dcmfg/fgpixmsr.h>
#include <dcmtk/dcmfg/fgplanor.h>
#include <dcmtk/dcmfg/fgplanpo.h>
#include <dcmtk/dcmseg/segdoc.h>
#include <dcmtk/dcmseg/segment.h>

namespace dynasurf::io {
namespace {

using dicom::decimal, dicom::must;

void check(std::span<const DicomSegment> segments) {
  if (segments.empty()) throw InputError("segmentation: expected at least one segment");
  for (const DicomSegment& s : segments) {
    const Grid &a = s.mask.grid, &b = segments[0].mask.grid;
    if (a.dims != b.dims || a.spacing != b.spacing || a.origin != b.origin || a.direction != b.direction)
      throw InputError("segmentation: the mask of " + s.label + " has another grid than that of " + segments[0].label);
    if (std::none_of(s.mask.values.begin(), s.mask.values.end(), [](std::uint8_t v) { return v != 0; }))
      throw InputError("segmentation: " + s.label + " holds no voxel");
  }
}

std::unique_ptr<DcmSegmentation> new_segmentation(const Grid& grid, const DicomResult& result,
                                                  const DicomObject& object) {
  const IODGeneralEquipmentModule::EquipmentInfo equipment("Dynasurf", "Dynasurf", "none",
                                                           result.program_version.c_str());
  ContentIdentificationMacro content;
  must(content.setContentLabel("LEFT_VENTRICLE"), "label the segmentation");
  must(content.setContentDescription(object.description.c_str()), "describe the segmentation");
  must(content.setInstanceNumber(std::to_string(object.instance_number).c_str()), "number the segmentation");
  DcmSegmentation* segmentation = nullptr;
  must(DcmSegmentation::createBinarySegmentation(segmentation, static_cast<Uint16>(grid.dims[1]),
                                                 static_cast<Uint16>(grid.dims[0]), equipment, content),
       "make a segmentation");
  return std::unique_ptr<DcmSegmentation>(segmentation);
}

CodeSequenceMacro code_of(const DicomCode& code) {
  return CodeSequenceMacro(code.value.c_str(), code.scheme.c_str(), code.meaning.c_str());
}

Uint16 add_segment(DcmSegmentation& segmentation, const DicomSegment& s) {
  DcmSegment* segment = nullptr;
  must(DcmSegment::create(segment, s.label.c_str(), code_of({"123037004", "SCT", "Anatomical Structure"}),
                          code_of(s.type), DcmSegTypes::SAT_AUTOMATIC, "Dynasurf"),
       "make a segment");
  must(segment->setRecommendedDisplayCIELabValue(s.cie_lab[0], s.cie_lab[1], s.cie_lab[2]), "colour a segment");
  Uint16 number = 0;
  must(segmentation.addSegment(segment, number), "add a segment");
  return number;
}

/// What all frames have in common.
void put_shared(DcmSegmentation& segmentation, const Grid& grid, const DicomSubject& subject) {
  FGPixelMeasures measures;
  must(measures.setPixelSpacing((decimal(grid.spacing[1]) + "\\" + decimal(grid.spacing[0])).c_str()),
       "store the spacing");
  must(measures.setSliceThickness(decimal(grid.spacing[2]).c_str()), "store the thickness");
  must(measures.setSpacingBetweenSlices(decimal(grid.spacing[2]).c_str()), "store the spacing of slices");
  must(segmentation.addForAllFrames(measures), "store the voxels' size");
  const auto part = [&](int row, int column) { return OFString(decimal(grid.direction(row, column)).c_str()); };
  const std::unique_ptr<FGPlaneOrientationPatient> orientation(
      FGPlaneOrientationPatient::createMinimal(part(0, 0), part(1, 0), part(2, 0), part(0, 1), part(1, 1), part(2, 1)));
  must(segmentation.addForAllFrames(*orientation), "store the orientation");
  if (subject.sources.empty()) return;
  OFVector<ImageSOPInstanceReferenceMacro> images;
  for (const DicomInstance& source : subject.sources) {
    ImageSOPInstanceReferenceMacro image;
    must(image.setReferencedSOPClassUID(source.sop_class.c_str()), "refer to the study");
    must(image.setReferencedSOPInstanceUID(source.sop_instance.c_str()), "refer to the study");
    images.push_back(image);
  }
  const std::unique_ptr<FGDerivationImage> derivation(
      DcmSegmentation::createDerivationImageFG(images, "Surfaces reconstructed from the study, filled"));
  must(segmentation.addForAllFrames(*derivation), "refer to the study");
}

void put_dimensions(DcmSegmentation& segmentation, const std::string& organization) {
  IODMultiframeDimensionModule& dimensions = segmentation.getDimensions();
  must(dimensions.addDimensionIndex(DCM_ReferencedSegmentNumber, organization.c_str(),
                                    DCM_SegmentIdentificationSequence, "Segment"),
       "store the first dimension");
  must(dimensions.addDimensionIndex(DCM_ImagePositionPatient, organization.c_str(), DCM_PlanePositionSequence, "Slice"),
       "store the second dimension");
}

/// The slices that hold any voxel of any segment, so that indices along the stack mean the same in all segments.
std::vector<int> slices_of(std::span<const DicomSegment> segments) {
  std::set<int> slices;
  for (const DicomSegment& s : segments) {
    const Grid& grid = s.mask.grid;
    for (std::size_t v = 0; v < s.mask.values.size(); ++v)
      if (s.mask.values[v] != 0) slices.insert(static_cast<int>(v / (grid.size() / grid.dims[2])));
  }
  return {slices.begin(), slices.end()};
}

void add_slice(DcmSegmentation& segmentation, const Mask& mask, Uint16 segment, int slice, Uint32 index) {
  const Grid& grid = mask.grid;
  const std::size_t size = grid.size() / grid.dims[2];
  const auto first = mask.values.begin() + static_cast<std::ptrdiff_t>(size) * slice;
  std::vector<Uint8> pixels(first, first + static_cast<std::ptrdiff_t>(size));
  if (std::all_of(pixels.begin(), pixels.end(), [](Uint8 v) { return v == 0; })) return;
  for (Uint8& v : pixels) v = v != 0;
  FGFrameContent content;
  must(content.setDimensionIndexValues(segment, 0), "place a frame");
  must(content.setDimensionIndexValues(index, 1), "place a frame");
  const Vec3 at = to_world(grid, Vec3(0, 0, grid.spacing[2] * slice));
  const std::unique_ptr<FGPlanePosPatient> position(
      FGPlanePosPatient::createMinimal(decimal(at[0]).c_str(), decimal(at[1]).c_str(), decimal(at[2]).c_str()));
  OFVector<FGBase*> groups;
  groups.push_back(&content);
  groups.push_back(position.get());
  must(segmentation.addFrame(pixels.data(), segment, groups), "add a frame");
}

/// Source images by series, as the object's list of what it refers to.
void put_references(DcmItem& dataset, const DicomSubject& subject) {
  if (subject.sources.empty()) return;
  dataset.findAndDeleteElement(DCM_ReferencedSeriesSequence);
  std::set<std::string> series;
  for (const DicomInstance& source : subject.sources) series.insert(source.series);
  dicom::Item root(dataset);
  for (const std::string& uid : series) {
    dicom::Item item = root.add(DCM_ReferencedSeriesSequence);
    item.text(DCM_SeriesInstanceUID, uid);
    for (const DicomInstance& source : subject.sources) {
      if (source.series != uid) continue;
      dicom::Item instance = item.add(DCM_ReferencedInstanceSequence);
      instance.text(DCM_ReferencedSOPClassUID, source.sop_class);
      instance.text(DCM_ReferencedSOPInstanceUID, source.sop_instance);
    }
  }
}

}  // namespace

DicomInstance write_segmentation(const DicomResult& result, const DicomObject& object,
                                 std::span<const DicomSegment> segments, const std::filesystem::path& path) {
  check(segments);
  DicomInstance instance = instance_of(result, object, UID_SegmentationStorage);
  const Grid& grid = segments[0].mask.grid;
  const auto segmentation = new_segmentation(grid, result, object);
  must(segmentation->getSeries().setSeriesNumber(std::to_string(object.series_number).c_str()), "number the series");
  must(segmentation->getFrameOfReference().setFrameOfReferenceUID(result.subject.frame_of_reference.c_str()),
       "store the frame of reference");
  put_shared(*segmentation, grid, result.subject);
  put_dimensions(*segmentation, dicom::uid_of(result.content, "dimensions " + object.role));
  std::vector<Uint16> numbers;
  for (const DicomSegment& s : segments) numbers.push_back(add_segment(*segmentation, s));
  const std::vector<int> slices = slices_of(segments);
  for (std::size_t n = 0; n < segments.size(); ++n)
    for (std::size_t index = 0; index < slices.size(); ++index)
      add_slice(*segmentation, segments[n].mask, numbers[n], slices[index], static_cast<Uint32>(index + 1));

  // DCMTK checks patient and study before they are put over what it made up.
  DcmFileFormat file;
  must(segmentation->writeDataset(*file.getDataset()), "make a segmentation");
  dicom::put_context(*file.getDataset(), result, object, instance);
  put_references(*file.getDataset(), result.subject);
  dicom::save(file, path);
  return instance;
}

}  // namespace dynasurf::io
