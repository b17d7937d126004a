#include <algorithm>
#include <map>
#include <set>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_places.hpp"
#include "dynasurf/io/detail/dicom_stacking.hpp"
#include "dynasurf/io/detail/dicom_whole.hpp"
#include "dynasurf/io/detail/samples.hpp"

namespace dynasurf::io {

namespace {

using Slices = std::vector<std::vector<std::size_t>>;  // indices of the images of each place, lowest place first
using Heights = std::map<std::size_t, double>;         // mm along the normal, by index of the image

Heights heights_of(const std::vector<DicomImage>& images, std::span<const std::size_t> files, const Vec3& normal) {
  std::set<std::string> instances;
  Heights height;
  for (const std::size_t f : files) {
    const DicomImage& image = images[f];
    if (!image.sop_instance.empty() && !instances.insert(image.sop_instance).second)
      throw InputError(image.where() + ": is there twice: another file of this folder holds the same image");
    if (image.position)
      height[f] = normal.dot(*image.position);
    else if (image.slice_location)
      height[f] = *image.slice_location;
    else if (files.size() == 1)
      height[f] = 0;
    else
      throw InputError(image.where() +
                       ": has neither ImagePositionPatient nor SliceLocation, so its place in the stack is not known");
  }
  return height;
}

/// All places hold as many images as there are gates.
Slices slices_of(std::span<const std::size_t> files, const Heights& height, const std::string& folder) {
  std::vector<std::size_t> order(files.begin(), files.end());
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return height.at(a) < height.at(b); });
  Slices slices;
  for (const std::size_t f : order) {
    if (slices.empty() || height.at(f) - height.at(slices.back().front()) > same_place_mm) slices.emplace_back();
    slices.back().push_back(f);
  }
  const auto is_smaller = [](const auto& a, const auto& b) { return a.size() < b.size(); };
  const std::size_t gates = std::max_element(slices.begin(), slices.end(), is_smaller)->size();
  for (std::size_t k = 0; k < slices.size(); ++k)
    if (slices[k].size() != gates)
      throw InputError(folder + ": slice " + std::to_string(k + 1) + " of " + std::to_string(slices.size()) + ", at " +
                       std::to_string(height.at(slices[k].front())) + " mm along the normal, has " +
                       std::to_string(slices[k].size()) + " images, another " + std::to_string(gates) +
                       "; a file is missing or double");
  return slices;
}

/// Whether an attribute differs between all images of each place.
bool tells_gates_apart(const GateKey& key, const Slices& slices, const std::vector<DicomImage>& images) {
  return std::all_of(slices.begin(), slices.end(), [&](const auto& slice) {
    std::set<double> seen;
    return std::all_of(slice.begin(), slice.end(), [&](std::size_t f) {
      const std::optional<double> value = key.value(images[f]);
      return value && seen.insert(*value).second;
    });
  });
}

/// Orders the images of each place by the first attribute that tells the gates apart, and takes the times from it.
void order_gates(Slices& slices, const std::vector<DicomImage>& images, const DicomImage& first, DicomStack& stack) {
  const std::size_t gates = slices.front().size();
  std::vector<GateKey> keys = gate_keys();
  keys.push_back({"InstanceNumber", [](const DicomImage& d) {
                    return d.instance_number ? std::optional<double>(*d.instance_number) : std::nullopt;
                  }});
  const auto key =
      std::find_if(keys.begin(), keys.end(), [&](const GateKey& k) { return tells_gates_apart(k, slices, images); });
  if (key == keys.end())
    throw InputError(first.path.parent_path().string() + ": every slice has " + std::to_string(gates) +
                     " images, but nothing tells which gate each is (TriggerTime, TemporalPositionIndex, "
                     "NominalPercentageOfCardiacPhase)");
  const auto value = [&](std::size_t f) { return *key->value(images[f]); };
  std::vector<double> mean(gates, 0);
  for (auto& slice : slices) {
    std::sort(slice.begin(), slice.end(), [&](std::size_t a, std::size_t b) { return value(a) < value(b); });
    for (std::size_t g = 0; g < gates; ++g) mean[g] += value(slice[g]) / slices.size();
  }
  const std::string used = key->name;
  if (used == "InstanceNumber")
    note(stack.notes, Severity::warning, "dicom.gate_order",
         "only the instance numbers tell the gates apart; their order is assumed");
  set_times_from(stack, used, mean, first);
}

/// From one slice to the next, in mm.
Vec3 step_of(const Slices& slices, const Heights& height, const std::vector<DicomImage>& images, const Placement& place,
             Notes& notes) {
  const DicomImage &bottom = images[slices.front().front()], &top = images[slices.back().front()];
  if (slices.size() == 1) {
    note(notes, Severity::warning, "dicom.one_slice",
         "there is one slice only; give the folder that holds the whole stack");
    return place.normal * std::abs(slice_spacing_of(bottom, notes, false));
  }
  std::vector<double> heights;
  for (const auto& slice : slices) heights.push_back(height.at(slice.front()));
  require_even_slices(heights, bottom.path.parent_path().string());
  const double gaps = slices.size() - 1;
  if (bottom.position && top.position) return (*top.position - *bottom.position) / gaps;
  return place.normal * ((heights.back() - heights.front()) / gaps);
}

}  // namespace

DicomStack stack_of_slices(const std::vector<DicomImage>& images, std::span<const std::size_t> files) {
  DicomStack stack;
  const DicomImage& first = images[files.front()];
  const Placement place = placement_of(first, stack.notes);
  const Heights height = heights_of(images, files, place.normal);
  Slices slices = slices_of(files, height, first.path.parent_path().string());
  const std::size_t gates = slices.front().size();
  require_all_images(images, files, slices.size(), gates, stack.notes);
  if (gates > 1) order_gates(slices, images, first, stack);
  check_study_size(first.columns, first.rows, slices.size(), gates, first.where());
  const Vec3 step = step_of(slices, height, images, place, stack.notes);
  Mat3 steps;
  steps << place.right * place.column_mm, place.down * place.row_mm, step;
  stack.grid = grid_from_steps({first.columns, first.rows, static_cast<int>(slices.size())}, steps,
                               images[slices.front().front()].position.value_or(place.origin), first.where());
  stack.gates = gates;
  for (std::size_t g = 0; g < gates; ++g)
    for (const auto& slice : slices) stack.frames.push_back({slice[g], 0});
  return stack;
}

}  // namespace dynasurf::io
