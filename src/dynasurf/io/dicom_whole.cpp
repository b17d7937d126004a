#include "dynasurf/io/detail/dicom_whole.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_stack.hpp"

namespace dynasurf::io {
namespace {

std::string mm(double value) {
  std::array<char, 40> text;
  std::snprintf(text.data(), text.size(), "%.2f mm", value);
  return text.data();
}

/// Fewer than were declared: refused, or for derived images told.
void lack(const DicomImage& image, const std::string& reason, Notes& notes) {
  const bool derived = !image.image_type.empty() && image.image_type.front() == "DERIVED";
  if (!derived) throw InputError(image.path.parent_path().string() + ": " + reason);
  notes.push_back({Severity::warning, "dicom.fewer_images",
                   reason + "; the images are derived, so that may be true of those they were made from"});
}

/// Images of the acquisition that an image belongs to.
std::size_t images_beside(const std::vector<DicomImage>& images, const DicomImage& image) {
  return std::count_if(images.begin(), images.end(), [&](const DicomImage& other) {
    return other.study == image.study && other.acquisition == image.acquisition &&
           other.images_in_acquisition == image.images_in_acquisition;
  });
}

}  // namespace

void require_even_slices(std::span<const double> heights, const std::string& folder) {
  std::vector<double> gaps;
  for (std::size_t k = 1; k < heights.size(); ++k) gaps.push_back(heights[k] - heights[k - 1]);
  std::vector<double> sorted = gaps;
  std::sort(sorted.begin(), sorted.end());
  // The lower median: a gap in which slices are missing is wider, and must not pass for the usual one.
  const double usual = sorted[(sorted.size() - 1) / 2];
  for (std::size_t k = 0; k < gaps.size(); ++k) {
    if (std::abs(gaps[k] - usual) <= std::max(0.02 * usual, same_place_mm)) continue;
    const double steps = gaps[k] / usual;
    const std::string between = "slices " + std::to_string(k + 1) + " and " + std::to_string(k + 2) + " of " +
                                std::to_string(heights.size()) + ", at " + mm(heights[k]) + " and " +
                                mm(heights[k + 1]) + " along the normal, are " + mm(gaps[k]) + " apart, the others " +
                                mm(usual);
    throw InputError(folder + ": " + between +
                     (steps > 1.5 ? "; a slice is missing at " + mm(heights[k] + usual)
                                  : "; expected slices that are equally far apart"));
  }
}

void require_all_images(const std::vector<DicomImage>& images, std::span<const std::size_t> files, std::size_t slices,
                        std::size_t gates, Notes& notes) {
  const DicomImage& first = images[files.front()];
  const auto fewer = [](std::size_t found, const std::optional<int>& declared) {
    return declared && *declared > 0 && found < static_cast<std::size_t>(*declared);
  };
  const auto of = [](std::size_t found, int declared) {
    return "holds " + std::to_string(found) + " of " + std::to_string(declared);
  };
  if (fewer(slices, first.slice_count))
    lack(first, of(slices, *first.slice_count) + " slices that NumberOfSlices tells; a slice is missing", notes);
  if (gates > 1 && fewer(gates, first.gate_count))
    lack(first, of(gates, *first.gate_count) + " gates that NumberOfTimeSlots tells; a gate is missing", notes);
  if (const std::size_t found = images_beside(images, first); fewer(found, first.images_in_acquisition))
    lack(first, of(found, *first.images_in_acquisition) + " images that ImagesInAcquisition tells; a file is missing",
         notes);

  std::optional<int> lowest;
  for (const DicomImage& image : images)
    if (image.study == first.study && image.instance_number)
      lowest = std::min(lowest.value_or(*image.instance_number), *image.instance_number);
  if (lowest > 1 && files.size() > 1)
    notes.push_back({Severity::info, "dicom.first_number",
                     "the images are numbered from " + std::to_string(*lowest) +
                         " on; whether there were others before " + "is not known"});
}

}  // namespace dynasurf::io
