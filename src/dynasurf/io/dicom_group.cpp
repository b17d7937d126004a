#include "dynasurf/io/detail/dicom_group.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <tuple>

#include "dynasurf/io/detail/dicom_stacking.hpp"
#include "dynasurf/io/detail/digest.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

/// What the pixels of an image are after rescaling, whatever they are packed in.
Sha256 digest_of_pixels(const DicomImage& image) {
  Hasher hasher;
  read_dicom_frames(image, [&](int, std::span<const float> values) { hasher.add(values.data(), values.size_bytes()); });
  return hasher.finish();
}

/// Whether two files of one SOP instance hold one image: writers that give every file the same UID exist.
bool is_copy(const DicomImage& a, const DicomImage& b) {
  const auto header = [](const DicomImage& d) {
    return std::tie(d.image_type, d.view, d.study, d.series, d.rows, d.columns, d.frames, d.slice_location,
                    d.trigger_time, d.temporal_position, d.cycle_percentage, d.instance_number, d.gate_of_frame,
                    d.slice_of_frame);
  };
  return header(a) == header(b) && a.position == b.position && a.orientation == b.orientation &&
         digest_of_pixels(a) == digest_of_pixels(b);
}

/// Directions of columns and rows, rounded so that they can be compared.
std::array<long, 6> direction_of(const DicomImage& image) {
  std::array<long, 6> direction{};
  if (image.orientation)
    for (std::size_t n = 0; n < 3; ++n) {
      direction[n] = std::lround(1000 * image.orientation->first[n]);
      direction[n + 3] = std::lround(1000 * image.orientation->second[n]);
    }
  return direction;
}

/// Files that belong to one stack of single frames: those of one key.
using SliceGroup = std::tuple<std::string, int, int, std::array<long, 6>>;
using SliceGroups = std::map<SliceGroup, std::vector<std::size_t>>;

SliceGroup group_of(const DicomImage& image) { return {image.series, image.rows, image.columns, direction_of(image)}; }

/// Height along the normal of a group of one place and two or more times; nothing for other groups.
std::optional<double> height_of_cine(const std::vector<DicomImage>& images, const std::vector<std::size_t>& files) {
  const DicomImage& first = images[files.front()];
  if (files.size() < 2 || !first.orientation) return std::nullopt;
  const Vec3 normal = first.orientation->first.cross(first.orientation->second);
  for (const std::size_t f : files)
    if (!images[f].position || (*images[f].position - *first.position).norm() > same_place_mm) return std::nullopt;
  return normal.dot(*first.position);
}

/// Cine MR is often stored as a series per slice. Such series of one study, direction, size and number of times whose
/// places differ become one group. Returns of how many series each grown group is made.
std::map<SliceGroup, std::size_t> join_cine_slices(const std::vector<DicomImage>& images, SliceGroups& groups) {
  using Kind = std::tuple<std::string, int, int, std::array<long, 6>, std::pair<double, double>, std::size_t>;
  std::map<Kind, std::map<long, std::vector<SliceGroups::iterator>>> places;  // kind -> rounded height -> groups
  for (auto it = groups.begin(); it != groups.end(); ++it)
    if (const auto height = height_of_cine(images, it->second)) {
      const DicomImage& d = images[it->second.front()];
      places[{d.study, d.rows, d.columns, direction_of(d), d.pixel_spacing.value_or(std::pair(0.0, 0.0)),
              it->second.size()}][std::lround(*height / same_place_mm)]
          .push_back(it);
    }
  std::map<SliceGroup, std::size_t> joined;
  for (auto& [kind, stack] : places) {
    const bool is_one_each =
        std::all_of(stack.begin(), stack.end(), [](const auto& p) { return p.second.size() == 1; });
    if (stack.size() < 2 || !is_one_each) continue;
    const auto into = stack.begin()->second.front();
    for (auto next = std::next(stack.begin()); next != stack.end(); ++next) {
      const auto from = next->second.front();
      into->second.insert(into->second.end(), from->second.begin(), from->second.end());
      groups.erase(from);
    }
    joined[into->first] = stack.size();
  }
  return joined;
}

}  // namespace

std::size_t drop_copies(std::vector<DicomImage>& images) {
  std::map<std::string, std::size_t> first_of;
  std::vector<DicomImage> kept;
  for (DicomImage& image : images) {
    const std::string name =
        image.sop_instance.empty() ? "bytes " + sha256_of_file(image.path) : "instance " + image.sop_instance;
    const auto [at, is_new] = first_of.emplace(name, kept.size());
    if (is_new || !is_copy(kept[at->second], image)) kept.push_back(std::move(image));
  }
  const std::size_t dropped = images.size() - kept.size();
  images = std::move(kept);
  return dropped;
}

std::vector<DicomStack> stacks_of(const std::vector<DicomImage>& images) {
  std::vector<DicomStack> stacks;
  SliceGroups singles;
  for (std::size_t n = 0; n < images.size(); ++n) {
    // A file of nuclear medicine is a stack by itself, even of one slice, unless its slices come in files of one.
    if (images[n].frames > 1)
      stacks.push_back(stack_of_frames(images[n], n));
    else
      singles[group_of(images[n])].push_back(n);
  }
  const auto joined = join_cine_slices(images, singles);
  for (const auto& [group, files] : singles) {
    stacks.push_back(stack_of_slices(images, files));
    if (const auto at = joined.find(group); at != joined.end())
      stacks.back().notes.push_back({Severity::info, "dicom.joined_series",
                                     std::to_string(at->second) + " series of one slice each were joined to a stack"});
  }
  return stacks;
}

}  // namespace dynasurf::io
