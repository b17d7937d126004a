#include <algorithm>

#include "dynasurf/io/detail/dicom_result_parts.hpp"

namespace dynasurf::io {
namespace {

using dicom::decimal, dicom::decimals, dicom::Item;

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

void put_segments(Item& root, std::span<const DicomSegment> segments) {
  int number = 0;
  for (const DicomSegment& s : segments) {
    Item item = root.add(DCM_SegmentSequence);
    dicom::put_code(item, DCM_SegmentedPropertyCategoryCodeSequence, {"123037004", "SCT", "Anatomical Structure"});
    dicom::put_code(item, DCM_SegmentedPropertyTypeCodeSequence, s.type);
    item.number(DCM_SegmentNumber, ++number);
    item.text(DCM_SegmentLabel, s.label);
    item.text(DCM_SegmentAlgorithmType, "AUTOMATIC");
    item.text(DCM_SegmentAlgorithmName, "Dynasurf");
    item.numbers(DCM_RecommendedDisplayCIELabValue, {s.cie_lab.begin(), s.cie_lab.end()});
  }
}

void put_derivation(Item& frames, const DicomSubject& subject) {
  if (subject.sources.empty()) return;
  Item item = frames.add(DCM_DerivationImageSequence);
  item.text(DCM_DerivationDescription, "Surfaces reconstructed from the study, filled");
  dicom::put_code(item, DCM_DerivationCodeSequence, {"113076", "DCM", "Segmentation"});
  for (const DicomInstance& source : subject.sources) {
    Item image = item.add(DCM_SourceImageSequence);
    image.text(DCM_ReferencedSOPClassUID, source.sop_class);
    image.text(DCM_ReferencedSOPInstanceUID, source.sop_instance);
    dicom::put_code(image, DCM_PurposeOfReferenceCodeSequence,
                    {"121322", "DCM", "Source Image for Image Processing Operation"});
  }
}

/// What all frames have in common.
void put_shared(Item& root, const Grid& grid, const DicomSubject& subject) {
  Item frames = root.add(DCM_SharedFunctionalGroupsSequence);
  Item measures = frames.add(DCM_PixelMeasuresSequence);
  measures.text(DCM_PixelSpacing, decimals({grid.spacing[1], grid.spacing[0]}));
  measures.text(DCM_SliceThickness, decimal(grid.spacing[2]));
  measures.text(DCM_SpacingBetweenSlices, decimal(grid.spacing[2]));
  const Mat3& d = grid.direction;
  frames.add(DCM_PlaneOrientationSequence)
      .text(DCM_ImageOrientationPatient, decimals({d(0, 0), d(1, 0), d(2, 0), d(0, 1), d(1, 1), d(2, 1)}));
  put_derivation(frames, subject);
}

/// Frames are told by their segment, then by their place in the stack.
void put_dimensions(Item& root, const std::string& organization) {
  root.add(DCM_DimensionOrganizationSequence).text(DCM_DimensionOrganizationUID, organization);
  const auto dimension = [&](const DcmTagKey& tag, const DcmTagKey& group, const char* label) {
    Item item = root.add(DCM_DimensionIndexSequence);
    item.text(DCM_DimensionOrganizationUID, organization);
    item.tags(DCM_DimensionIndexPointer, {tag});
    item.tags(DCM_FunctionalGroupPointer, {group});
    item.text(DCM_DimensionDescriptionLabel, label);
  };
  dimension(DCM_ReferencedSegmentNumber, DCM_SegmentIdentificationSequence, "Segment");
  dimension(DCM_ImagePositionPatient, DCM_PlanePositionSequence, "Slice");
}

std::span<const std::uint8_t> slice_of(const Mask& mask, int slice) {
  const std::size_t size = mask.grid.size() / mask.grid.dims[2];
  return std::span(mask.values).subspan(size * slice, size);
}

bool holds_voxels(const DicomSegment& segment, int slice) {
  const auto values = slice_of(segment.mask, slice);
  return std::any_of(values.begin(), values.end(), [](std::uint8_t v) { return v != 0; });
}

/// The slices that hold any voxel of any segment, so that indices along the stack mean the same in all segments.
std::vector<int> slices_of(std::span<const DicomSegment> segments) {
  std::vector<int> slices;
  for (int slice = 0; slice < segments[0].mask.grid.dims[2]; ++slice)
    if (std::any_of(segments.begin(), segments.end(), [&](const auto& s) { return holds_voxels(s, slice); }))
      slices.push_back(slice);
  return slices;
}

/// Voxels as bits, the first the lowest; frames follow each other without a gap. PS3.5, 8.1.1: bits are packed without
/// regard to where a frame ends.
class Bits {
 public:
  void add(std::span<const std::uint8_t> values) {
    for (const std::uint8_t v : values) {
      if (count_ % 8 == 0) bytes_.push_back(0);
      bytes_.back() = static_cast<Uint8>(bytes_.back() | (v != 0) << count_ % 8);
      ++count_;
    }
  }
  /// DICOM wants an even number of bytes.
  std::vector<Uint8> bytes() const {
    std::vector<Uint8> even = bytes_;
    even.resize((even.size() + 1) / 2 * 2);
    return even;
  }

 private:
  std::vector<Uint8> bytes_;
  std::size_t count_ = 0;
};

void add_frame(Item& root, const Grid& grid, unsigned segment, int slice, unsigned index) {
  Item frame = root.add(DCM_PerFrameFunctionalGroupsSequence);
  frame.add(DCM_FrameContentSequence).counts(DCM_DimensionIndexValues, {segment, index});
  const Vec3 at = to_world(grid, Vec3(0, 0, grid.spacing[2] * slice));
  frame.add(DCM_PlanePositionSequence).text(DCM_ImagePositionPatient, decimals({at[0], at[1], at[2]}));
  frame.add(DCM_SegmentIdentificationSequence).number(DCM_ReferencedSegmentNumber, segment);
}

/// Every slice of every segment that holds voxels of it is a frame.
void put_frames(DcmItem& dataset, std::span<const DicomSegment> segments) {
  Item root(dataset);
  const std::vector<int> slices = slices_of(segments);
  Bits bits;
  int frames = 0;
  for (std::size_t n = 0; n < segments.size(); ++n) {
    for (std::size_t s = 0; s < slices.size(); ++s) {
      if (!holds_voxels(segments[n], slices[s])) continue;
      add_frame(root, segments[n].mask.grid, static_cast<unsigned>(n) + 1, slices[s], static_cast<unsigned>(s) + 1);
      bits.add(slice_of(segments[n].mask, slices[s]));
      ++frames;
    }
  }
  root.text(DCM_NumberOfFrames, std::to_string(frames));
  const std::vector<Uint8> bytes = bits.bytes();
  dicom::must(dataset.putAndInsertUint8Array(DCM_PixelData, bytes.data(), static_cast<unsigned long>(bytes.size())),
              "store the voxels");
}

void put_image(Item& root, const Grid& grid) {
  root.text(DCM_ImageType, "DERIVED\\PRIMARY");
  root.number(DCM_SamplesPerPixel, 1);
  root.text(DCM_PhotometricInterpretation, "MONOCHROME2");
  root.number(DCM_Rows, grid.dims[1]);
  root.number(DCM_Columns, grid.dims[0]);
  root.number(DCM_BitsAllocated, 1);
  root.number(DCM_BitsStored, 1);
  root.number(DCM_HighBit, 0);
  root.number(DCM_PixelRepresentation, 0);
  root.text(DCM_LossyImageCompression, "00");
  root.text(DCM_SegmentationType, "BINARY");
}

}  // namespace

DicomInstance write_segmentation(const DicomResult& result, const DicomObject& object,
                                 std::span<const DicomSegment> segments, const std::filesystem::path& path) {
  check(segments);
  DicomInstance instance = instance_of(result, object, UID_SegmentationStorage);
  const Grid& grid = segments[0].mask.grid;
  DcmFileFormat file;
  Item root(*file.getDataset());
  root.text(DCM_Modality, "SEG");
  root.text(DCM_ContentLabel, "LEFT_VENTRICLE");
  root.text(DCM_ContentDescription, object.description);
  root.text(DCM_ContentCreatorName, "");
  root.text(DCM_FrameOfReferenceUID, result.subject.frame_of_reference);
  root.text(DCM_PositionReferenceIndicator, "");
  put_image(root, grid);
  put_segments(root, segments);
  put_shared(root, grid, result.subject);
  put_dimensions(root, dicom::uid_of(result.content, "dimensions " + object.role));
  put_frames(*file.getDataset(), segments);
  if (!result.subject.sources.empty())
    dicom::put_series(root, DCM_ReferencedSeriesSequence, DCM_ReferencedInstanceSequence, result.subject.sources);
  dicom::put_context(*file.getDataset(), result, object, instance);
  dicom::save(file, path);
  return instance;
}

}  // namespace dynasurf::io
