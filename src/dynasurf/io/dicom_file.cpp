#include "dynasurf/io/detail/dicom_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <memory>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/dicom_load.hpp"
#include "dynasurf/io/detail/dicom_words.hpp"
#include "dynasurf/io/detail/samples.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

namespace fs = std::filesystem;

std::uint32_t number_of(const DcmTagKey& tag) { return std::uint32_t{tag.getGroup()} << 16 | tag.getElement(); }

/// Every attribute of the first level that this source asks for. An attribute that is not in this list reads as absent:
/// only wanted elements reach DCMTK.
std::vector<std::uint32_t> wanted_tags() {
  std::vector<std::uint32_t> tags;
  for (const DcmTagKey& tag : {DCM_Modality,
                               DCM_ImageType,
                               DCM_SOPClassUID,
                               DCM_SOPInstanceUID,
                               DCM_StudyInstanceUID,
                               DCM_SeriesInstanceUID,
                               DCM_SeriesNumber,
                               DCM_SeriesType,
                               DCM_Rows,
                               DCM_Columns,
                               DCM_NumberOfFrames,
                               DCM_SamplesPerPixel,
                               DCM_BitsAllocated,
                               DCM_BitsStored,
                               DCM_HighBit,
                               DCM_PixelRepresentation,
                               DCM_RescaleSlope,
                               DCM_RescaleIntercept,
                               DCM_RealWorldValueMappingSequence,
                               DCM_PixelSpacing,
                               DCM_SpacingBetweenSlices,
                               DCM_SliceThickness,
                               DCM_SliceLocation,
                               DCM_DetectorInformationSequence,
                               DCM_ImagePositionPatient,
                               DCM_ImageOrientationPatient,
                               DCM_RRIntervalVector,
                               DCM_TimeSlotVector,
                               DCM_SliceVector,
                               DCM_NumberOfRRIntervals,
                               DCM_NumberOfTimeSlots,
                               DCM_NumberOfSlices,
                               DCM_TriggerTime,
                               DCM_NominalInterval,
                               DCM_HeartRate,
                               DCM_TemporalPositionIndex,
                               DCM_TemporalPositionIdentifier,
                               DCM_NominalPercentageOfCardiacPhase,
                               DCM_InstanceNumber,
                               DCM_GatedInformationSequence,
                               DCM_ViewCodeSequence,
                               DCM_SeriesDescription,
                               DCM_ImageID,
                               DCM_SliceProgressionDirection,
                               DCM_RadiopharmaceuticalInformationSequence,
                               DCM_CorrectedImage,
                               DCM_AcquisitionNumber,
                               DCM_ImagesInAcquisition,
                               DCM_EnergyWindowVector,
                               DCM_EnergyWindowInformationSequence})
    tags.push_back(number_of(tag));
  return tags;
}

/// What is wanted of a file, and where its pixels stand.
struct LoadedFile {
  DicomOutline outline;
  std::unique_ptr<DcmDataset> dataset;
};

LoadedFile load(const fs::path& path) {
  const std::uint64_t size = size_of_file(path);
  if (size > 2 * std::uint64_t{max_study_bytes})
    throw InputError(path.string() + ": is larger than any study that is read (" + std::to_string(size) + " bytes)");
  LoadedFile file;
  file.outline = outline_of_dicom(path, wanted_tags());
  file.dataset = dicom::load_wanted(path, file.outline);
  return file;
}

/// Values are filled up to an even length: texts by a space, UIDs by a NUL (PS3.5, 6.2).
std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  if (first == std::string::npos) return "";
  return text.substr(first, text.find_last_not_of(std::string(" \t\0", 3)) - first + 1);
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t at = 0; at <= text.size();) {
    const std::size_t end = std::min(text.find('\\', at), text.size());
    parts.push_back(trimmed(text.substr(at, end - at)));
    at = end + 1;
  }
  return parts;
}

/// The attributes of a data set or of an item of a sequence.
class Attributes {
 public:
  Attributes(DcmItem& item, const std::string& where) : item_(&item), where_(where) {}

  /// All values, trimmed; empty when the attribute is absent or has no value.
  std::vector<std::string> texts(const DcmTagKey& tag) const {
    DcmElement* element = find(tag);
    if (!element || element->getLength() == 0) return {};
    OFString value;
    if (element->getOFStringArray(value).bad()) return {};
    return split(std::string(value.c_str(), value.length()));
  }
  std::string text(const DcmTagKey& tag) const {
    const auto all = texts(tag);
    return all.empty() ? "" : all.front();
  }

  /// All values as finite numbers; nothing when absent. Throws InputError when something else stands there.
  std::optional<std::vector<double>> numbers(const DcmTagKey& tag) const {
    const auto all = texts(tag);
    if (all.empty()) return std::nullopt;
    switch (find(tag)->ident()) {
      case EVR_US:
      case EVR_SS:
      case EVR_UL:
      case EVR_SL:
      case EVR_IS:
      case EVR_DS:
      case EVR_FL:
      case EVR_FD:
        break;
      default:
        refuse(tag, "is not a number");
    }
    std::vector<double> values;
    for (const std::string& word : all) {
      std::string_view rest = word;
      // A decimal string may begin with +, which from_chars does not take.
      if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
      double value = 0;
      const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), value);
      if (error != std::errc{} || end != rest.data() + rest.size() || !std::isfinite(value))
        refuse(tag, "is not a number");
      values.push_back(value);
    }
    return values;
  }
  std::optional<double> number(const DcmTagKey& tag) const {
    const auto all = numbers(tag);
    return all ? std::optional(all->front()) : std::nullopt;
  }
  /// A number that only informs: nothing when it cannot be understood.
  std::optional<double> soft_number(const DcmTagKey& tag) const {
    try {
      return number(tag);
    } catch (const InputError&) {
      return std::nullopt;
    }
  }
  std::optional<int> soft_whole(const DcmTagKey& tag) const {
    const auto value = soft_number(tag);
    return value && std::abs(*value) < 1e9 ? std::optional(static_cast<int>(*value)) : std::nullopt;
  }
  std::optional<std::vector<int>> wholes(const DcmTagKey& tag) const {
    const auto all = numbers(tag);
    if (!all) return std::nullopt;
    std::vector<int> values;
    for (const double v : *all) {
      if (v != std::floor(v) || std::abs(v) > 1e9) refuse(tag, "is not a whole number");
      values.push_back(static_cast<int>(v));
    }
    return values;
  }
  std::optional<int> whole(const DcmTagKey& tag) const {
    const auto all = wholes(tag);
    return all ? std::optional(all->front()) : std::nullopt;
  }
  int need_whole(const DcmTagKey& tag, int least, int most) const {
    const auto value = whole(tag);
    if (!value) refuse(tag, "is absent");
    if (*value < least || *value > most)
      refuse(tag,
             ("is " + std::to_string(*value) + "; expected " + std::to_string(least) + " to " + std::to_string(most))
                 .c_str());
    return *value;
  }
  std::optional<Vec3> vector(const DcmTagKey& tag) const {
    const auto all = numbers(tag);
    if (!all) return std::nullopt;
    if (all->size() != 3) refuse(tag, "has not three numbers");
    return Vec3((*all)[0], (*all)[1], (*all)[2]);
  }

  std::vector<Attributes> items(const DcmTagKey& tag) const {
    DcmSequenceOfItems* sequence = nullptr;
    std::vector<Attributes> found;
    if (item_->findAndGetSequence(tag, sequence).bad() || !sequence) return found;
    for (unsigned long n = 0; n < sequence->card(); ++n) found.emplace_back(*sequence->getItem(n), where_);
    return found;
  }
  std::optional<Attributes> first_item(const DcmTagKey& tag) const {
    const auto all = items(tag);
    return all.empty() ? std::nullopt : std::optional(all.front());
  }
  bool has(const DcmTagKey& tag) const { return find(tag) != nullptr; }

  [[noreturn]] void refuse(const DcmTagKey& tag, const char* what) const {
    throw InputError(where_ + ": " + dicom::name_of(tag.getGroup() << 16 | tag.getElement()) + " " +
                     tag.toString().c_str() + " " + what);
  }

 private:
  DcmElement* find(const DcmTagKey& tag) const {
    DcmElement* element = nullptr;
    return item_->findAndGetElement(tag, element).good() ? element : nullptr;
  }

  DcmItem* item_;
  std::string where_;
};

void read_pixel_format(DicomImage& image, const Attributes& root) {
  image.rows = root.need_whole(DCM_Rows, 1, 65535);
  image.columns = root.need_whole(DCM_Columns, 1, 65535);
  image.frames = root.has(DCM_NumberOfFrames) ? root.need_whole(DCM_NumberOfFrames, 1, 1'000'000) : 1;
  image.samples = root.need_whole(DCM_SamplesPerPixel, 1, 4);
  image.bits_allocated = root.need_whole(DCM_BitsAllocated, 1, 64);
  if (image.bits_allocated != 8 && image.bits_allocated != 16) root.refuse(DCM_BitsAllocated, "is not 8 or 16");
  image.bits_stored = root.need_whole(DCM_BitsStored, 1, image.bits_allocated);
  image.high_bit = root.need_whole(DCM_HighBit, image.bits_stored - 1, image.bits_allocated - 1);
  image.is_signed = root.need_whole(DCM_PixelRepresentation, 0, 1) == 1;
  if (const auto slope = root.number(DCM_RescaleSlope)) {
    image.slope = *slope;
    image.intercept = root.number(DCM_RescaleIntercept).value_or(0);
  } else if (const auto mapping = root.first_item(DCM_RealWorldValueMappingSequence)) {
    image.slope = mapping->number(DCM_RealWorldValueSlope).value_or(1);
    image.intercept = mapping->number(DCM_RealWorldValueIntercept).value_or(0);
  }
  if (image.slope == 0) root.refuse(DCM_RescaleSlope, "is 0, which makes every value the same");
}

void read_geometry(DicomImage& image, const Attributes& root) {
  if (const auto spacing = root.numbers(DCM_PixelSpacing)) {
    if (spacing->size() != 2) root.refuse(DCM_PixelSpacing, "has not two numbers");
    image.pixel_spacing = {(*spacing)[0], (*spacing)[1]};
  }
  image.slice_spacing = root.number(DCM_SpacingBetweenSlices);
  image.slice_thickness = root.number(DCM_SliceThickness);
  image.slice_location = root.soft_number(DCM_SliceLocation);
  // In nuclear medicine the position belongs to the detector; some writers leave it at the root.
  const Attributes detector = root.first_item(DCM_DetectorInformationSequence).value_or(root);
  image.position = detector.vector(DCM_ImagePositionPatient);
  if (!image.position) image.position = root.vector(DCM_ImagePositionPatient);
  auto direction = detector.numbers(DCM_ImageOrientationPatient);
  if (!direction) direction = root.numbers(DCM_ImageOrientationPatient);
  if (!direction) return;
  if (direction->size() != 6) root.refuse(DCM_ImageOrientationPatient, "has not six numbers");
  const Vec3 along_row((*direction)[0], (*direction)[1], (*direction)[2]);
  const Vec3 along_column((*direction)[3], (*direction)[4], (*direction)[5]);
  for (const Vec3& v : {along_row, along_column})
    if (!(std::abs(v.norm() - 1) < 0.01)) root.refuse(DCM_ImageOrientationPatient, "is not two directions of length 1");
  // Cosines are written with a few decimals; all that follows relies on unit vectors.
  image.orientation = {along_row.normalized(), along_column.normalized()};
}

void read_gating(DicomImage& image, const Attributes& root) {
  image.rr_of_frame = root.wholes(DCM_RRIntervalVector);
  image.gate_of_frame = root.wholes(DCM_TimeSlotVector);
  image.slice_of_frame = root.wholes(DCM_SliceVector);
  image.rr_count = root.whole(DCM_NumberOfRRIntervals);
  image.gate_count = root.whole(DCM_NumberOfTimeSlots);
  image.slice_count = root.whole(DCM_NumberOfSlices);
  image.trigger_time = root.soft_number(DCM_TriggerTime);
  image.nominal_interval = root.soft_number(DCM_NominalInterval);
  image.heart_rate = root.soft_number(DCM_HeartRate);
  image.temporal_position = root.soft_number(DCM_TemporalPositionIndex);
  if (!image.temporal_position) image.temporal_position = root.soft_number(DCM_TemporalPositionIdentifier);
  image.cycle_percentage = root.soft_number(DCM_NominalPercentageOfCardiacPhase);
  image.instance_number = root.soft_whole(DCM_InstanceNumber);
  image.acquisition = root.soft_whole(DCM_AcquisitionNumber);
  image.images_in_acquisition = root.soft_whole(DCM_ImagesInAcquisition);
  const auto gated = root.first_item(DCM_GatedInformationSequence);
  if (!gated) return;
  // In nuclear medicine the delay of the first gate after the R wave stands in this sequence.
  if (const auto delay = gated->soft_number(DCM_TriggerTime)) image.trigger_time = delay;
  image.counts_back_from_r = gated->text(DCM_CardiacFramingType) == "BACK";
  for (const Attributes& rr : gated->items(DCM_DataInformationSequence)) {
    image.beats_of_rr.push_back(rr.soft_whole(DCM_IntervalsAcquired));
    image.rejected_beats_of_rr.push_back(rr.soft_whole(DCM_IntervalsRejected));
    image.frame_time_of_rr.push_back(rr.soft_number(DCM_FrameTime));
    image.nominal_interval_of_rr.push_back(rr.soft_number(DCM_NominalInterval));
    std::vector<double> slots;
    for (const Attributes& slot : rr.items(DCM_TimeSlotInformationSequence))
      slots.push_back(slot.soft_number(DCM_TimeSlotTime).value_or(0));
    image.slot_times_of_rr.push_back(slots);
  }
}

std::string isotope_in(const Attributes& root) {
  const auto tracer = root.first_item(DCM_RadiopharmaceuticalInformationSequence);
  const auto nuclide = tracer ? tracer->first_item(DCM_RadionuclideCodeSequence) : std::nullopt;
  return nuclide ? isotope_of(nuclide->text(DCM_CodeValue), nuclide->text(DCM_CodeMeaning)) : "";
}

/// Energy windows only inform: what cannot be understood, or fits no frame, is as good as absent.
void read_energy_windows(DicomImage& image, const Attributes& root) {
  image.isotope = isotope_in(root);
  for (const Attributes& window : root.items(DCM_EnergyWindowInformationSequence)) {
    auto& ranges = image.windows.emplace_back();
    for (const Attributes& range : window.items(DCM_EnergyWindowRangeSequence)) {
      const auto lower = range.soft_number(DCM_EnergyWindowLowerLimit);
      const auto upper = range.soft_number(DCM_EnergyWindowUpperLimit);
      if (lower && upper) ranges.push_back({*lower, *upper});
    }
  }
  try {
    image.window_of_frame = root.wholes(DCM_EnergyWindowVector);
  } catch (const InputError&) {
    return;
  }
  if (image.window_of_frame && image.window_of_frame->size() != static_cast<std::size_t>(image.frames))
    image.window_of_frame.reset();
}

void read_view(DicomImage& image, const Attributes& root) {
  const Attributes detector = root.first_item(DCM_DetectorInformationSequence).value_or(root);
  for (const Attributes& holder : {detector, root})
    if (const auto code = holder.first_item(DCM_ViewCodeSequence); code && image.view == View::unknown)
      image.view = view_of_code(code->text(DCM_CodeValue), code->text(DCM_CodingSchemeDesignator));
  const std::string words = root.text(DCM_SeriesDescription) + " / " + root.text(DCM_ImageID);
  if (image.view == View::unknown) {
    image.view = view_in_words(words);
    image.view_from_words = image.view != View::unknown;
  }
  image.gate_in_words = gate_in_words(words);
  const std::string order = root.text(DCM_SliceProgressionDirection);
  if (order == "APEX_TO_BASE") image.slice_order = SliceOrder::apex_to_base;
  if (order == "BASE_TO_APEX") image.slice_order = SliceOrder::base_to_apex;
}

/// By the list of corrections, where attenuation stands in it; else by the description, for many cameras list no more
/// than what they do to counts. Only where that says nothing is a list without attenuation taken at its word.
Attenuation attenuation_in(const Attributes& root) {
  const std::vector<std::string> corrections = root.texts(DCM_CorrectedImage);
  if (std::find(corrections.begin(), corrections.end(), "ATTN") != corrections.end()) return Attenuation::corrected;
  const Attenuation in_words = attenuation_in_words(root.text(DCM_SeriesDescription));
  const bool is_listed = std::any_of(corrections.begin(), corrections.end(), is_correction);
  return in_words == Attenuation::unknown && is_listed ? Attenuation::uncorrected : in_words;
}

}  // namespace

const std::string& DicomImage::kind() const {
  static const std::string none;
  return image_type.size() > 2 ? image_type[2] : none;
}

DicomImage read_dicom_header(const std::filesystem::path& path) {
  const LoadedFile file = load(path);
  const Attributes root(*file.dataset, path.string());
  DicomImage image;
  image.path = path;
  if (!file.outline.pixels)
    throw InputError(path.string() + ": holds no pixel data" +
                     (file.outline.has_real_pixels ? " of 8 or 16 bits" : "") + "; expected an image");
  image.modality = root.text(DCM_Modality);
  image.image_type = root.texts(DCM_ImageType);
  image.sop_class = root.text(DCM_SOPClassUID);
  image.sop_instance = root.text(DCM_SOPInstanceUID);
  image.study = root.text(DCM_StudyInstanceUID);
  image.series = root.text(DCM_SeriesInstanceUID);
  image.series_description = root.text(DCM_SeriesDescription);
  image.series_number = root.soft_whole(DCM_SeriesNumber);
  const auto series_type = root.texts(DCM_SeriesType);
  if (!series_type.empty()) image.series_type = series_type.front();
  // Value 2 of SeriesType of PET is IMAGE or REPROJECTION.
  image.is_reprojection = series_type.size() > 1 && series_type[1] == "REPROJECTION";
  read_pixel_format(image, root);
  read_geometry(image, root);
  read_gating(image, root);
  read_energy_windows(image, root);
  read_view(image, root);
  image.attenuation = attenuation_in(root);
  return image;
}

std::vector<std::pair<std::string, std::string>> acquisition_facts_of(const std::filesystem::path& path) {
  const LoadedFile file = load(path);
  const Attributes root(*file.dataset, path.string());
  std::vector<std::pair<std::string, std::string>> rows;
  if (const auto tracer = root.first_item(DCM_RadiopharmaceuticalInformationSequence)) {
    if (const std::string word = isotope_in(root); !word.empty()) rows.emplace_back("isotope", word);
    if (const std::string word = tracer_of(tracer->text(DCM_Radiopharmaceutical)); !word.empty())
      rows.emplace_back("tracer", word);
  }
  std::string corrections;
  for (const std::string& word : root.texts(DCM_CorrectedImage))
    if (is_correction(word)) corrections += (corrections.empty() ? "" : ", ") + word;
  if (!corrections.empty()) rows.emplace_back("corrections", corrections);
  if (const auto rate = root.soft_whole(DCM_HeartRate))
    rows.emplace_back("heart rate", std::to_string(*rate) + " /min");
  if (const auto gated = root.first_item(DCM_GatedInformationSequence))
    if (const auto beats = gated->first_item(DCM_DataInformationSequence)) {
      if (const auto n = beats->soft_whole(DCM_IntervalsAcquired))
        rows.emplace_back("beats accepted", std::to_string(*n));
      if (const auto n = beats->soft_whole(DCM_IntervalsRejected))
        rows.emplace_back("beats rejected", std::to_string(*n));
      const auto low = beats->soft_whole(DCM_LowRRValue), high = beats->soft_whole(DCM_HighRRValue);
      if (low && high)
        rows.emplace_back("beats accepted from", std::to_string(*low) + " to " + std::to_string(*high) + " ms");
    }
  return rows;
}

}  // namespace dynasurf::io
