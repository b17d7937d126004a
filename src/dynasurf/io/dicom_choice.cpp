#include "dynasurf/io/detail/dicom_choice.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/dicom_stacking.hpp"
#include "dynasurf/io/detail/dicom_words.hpp"

namespace dynasurf::io {

namespace {

// Stacks that an error lists. A folder of more is not one that somebody looks at line by line.
constexpr std::size_t most_listed = 8;
constexpr int least_slices = 3;  // that a ventricle can be found in

const DicomImage& image_of(const std::vector<DicomImage>& images, const DicomStack& stack) {
  return images[stack.first_file()];
}

}  // namespace

bool is_wanted(const DicomImage& image, const DicomStack& stack) {
  return stack.gates > 1 && stack.grid.dims[2] >= least_slices &&
         (image.view == View::short_axis || image.view == View::unknown);
}

std::string size_in_words(int gates, const Index3& n) {
  return (gates > 1 ? std::to_string(gates) + " gates of " : "ungated ") + std::to_string(n[0]) + " x " +
         std::to_string(n[1]) + " x " + std::to_string(n[2]);
}

std::string description_of(const DicomImage& image, const DicomStack& stack) {
  std::string text = size_in_words(stack.gates, stack.grid.dims);
  if (image.view != View::unknown) {
    std::string view(name_of(image.view));
    std::replace(view.begin(), view.end(), '_', ' ');
    text += ", " + view;
  }
  const std::string words = circumstances_in_words(image.series_description);
  return words.empty() ? text : text + ", " + words;
}

namespace {

/// The numbers by which stacks are chosen: of their series, where they tell them apart; else their places in the list.
std::vector<std::string> numbers_of(const std::vector<DicomImage>& images, const std::vector<DicomStack>& stacks) {
  std::set<int> numbers;
  std::vector<std::string> own, places;
  for (const DicomStack& stack : stacks) {
    if (const auto number = image_of(images, stack).series_number;
        number && *number > 0 && numbers.insert(*number).second)
      own.push_back(std::to_string(*number));
    places.push_back(std::to_string(places.size() + 1));
  }
  return own.size() == stacks.size() ? own : places;
}

std::string list_of(const std::vector<DicomImage>& images, const std::vector<DicomStack>& stacks,
                    const std::vector<std::size_t>& listed) {
  const std::vector<std::string> numbers = numbers_of(images, stacks);
  std::string text;
  for (std::size_t n = 0; n < std::min(listed.size(), most_listed); ++n) {
    const DicomStack& stack = stacks[listed[n]];
    text += (n ? "; " : "") + numbers[listed[n]] + " is " + description_of(image_of(images, stack), stack);
  }
  if (listed.size() > most_listed) text += "; and " + std::to_string(listed.size() - most_listed) + " more";
  return text;
}

/// The stacks that the user may mean by `series`.
std::vector<std::size_t> named_by(const std::string& series, const std::vector<DicomImage>& images,
                                  const std::vector<DicomStack>& stacks) {
  const std::vector<std::string> numbers = numbers_of(images, stacks);
  std::vector<std::size_t> by_uid, by_number, by_words;
  for (std::size_t n = 0; n < stacks.size(); ++n) {
    const DicomImage& image = image_of(images, stacks[n]);
    if (image.series == series) by_uid.push_back(n);
    if (numbers[n] == series) by_number.push_back(n);
    if (small_letters(image.series_description).find(small_letters(series)) != std::string::npos) by_words.push_back(n);
  }
  return !by_uid.empty() ? by_uid : !by_number.empty() ? by_number : by_words;
}

/// Of stacks on one grid with an energy window each, the one that alone holds the nuclide's peak.
std::optional<std::size_t> photopeak_of(const std::vector<DicomImage>& images, const std::vector<DicomStack>& stacks,
                                        const std::vector<std::size_t>& candidates) {
  std::optional<std::size_t> found;
  const DicomStack& front = stacks[candidates.front()];
  for (const std::size_t n : candidates) {
    const DicomImage& image = image_of(images, stacks[n]);
    if (image.windows.size() != 1 || image.windows[0].empty() || image.study != image_of(images, front).study ||
        stacks[n].gates != front.gates || !is_same_grid(stacks[n].grid, front.grid))
      return std::nullopt;
    const double peak = photopeak_kev(image.isotope);
    const bool holds = std::any_of(image.windows[0].begin(), image.windows[0].end(),
                                   [&](const EnergyRange& r) { return r.lower <= peak && peak <= r.upper; });
    if (holds && found) return std::nullopt;
    if (holds) found = n;
  }
  return found;
}

/// Joins the stacks of one gate that have the same `key`, where they are gates of one beat.
template <class Key>
std::vector<DicomStack> joined_by(const std::vector<DicomImage>& images, std::vector<DicomStack> stacks,
                                  const Key& key) {
  std::map<decltype(key(images.front())), std::vector<DicomStack>> groups;
  std::vector<DicomStack> result;
  for (DicomStack& stack : stacks) {
    if (stack.gates == 1)
      groups[key(image_of(images, stack))].push_back(std::move(stack));
    else
      result.push_back(std::move(stack));
  }
  for (auto& [name, group] : groups) {
    if (auto whole = group.size() > 1 ? joined_gates(images, group) : std::nullopt)
      result.push_back(std::move(*whole));
    else
      std::move(group.begin(), group.end(), std::back_inserter(result));
  }
  return result;
}

}  // namespace

std::vector<DicomStack> with_joined_gates(const std::vector<DicomImage>& images, std::vector<DicomStack> stacks) {
  if (stacks.size() < 2) return stacks;
  if (auto whole = joined_gates(images, stacks)) return {std::move(*whole)};
  if (std::any_of(stacks.begin(), stacks.end(), [](const DicomStack& s) { return s.gates > 1; })) return stacks;
  stacks = joined_by(images, std::move(stacks), [](const DicomImage& d) { return std::pair(d.study, d.series); });
  return joined_by(images, std::move(stacks), [](const DicomImage& d) {
    return std::pair(d.study, circumstances_in_words(d.series_description));
  });
}

DicomChoice chosen_stack(const std::vector<DicomImage>& images, std::vector<DicomStack> stacks,
                         const std::string& series, const std::string& where) {
  // The order of a list should not follow from random UIDs.
  std::stable_sort(stacks.begin(), stacks.end(), [&](const DicomStack& a, const DicomStack& b) {
    return std::pair(image_of(images, a).series_number.value_or(0), a.first_file()) <
           std::pair(image_of(images, b).series_number.value_or(0), b.first_file());
  });
  std::vector<std::size_t> all(stacks.size());
  for (std::size_t n = 0; n < all.size(); ++n) all[n] = n;
  std::vector<std::size_t> candidates = series.empty() ? all : named_by(series, images, stacks);
  if (candidates.empty())
    throw InputError(where + ": holds no series of the UID, number or description asked for; " +
                     list_of(images, stacks, all));
  std::string note;
  std::vector<std::size_t> wanted;
  for (const std::size_t n : candidates)
    if (is_wanted(image_of(images, stacks[n]), stacks[n])) wanted.push_back(n);
  if (candidates.size() > 1 && wanted.size() == 1) {
    candidates = wanted;
    note = "the only gated one that is not a long axis or transaxial is read";
  } else if (const auto peak = wanted.size() > 1 ? photopeak_of(images, stacks, wanted) : std::nullopt) {
    candidates = {*peak};
    note = "that of the photopeak's energy window is read";
  }
  if (candidates.size() != 1)
    throw InputError(where + ": holds " + std::to_string(candidates.size()) + " different image stacks (" +
                     std::to_string(wanted.size()) +
                     " of them gated and perhaps short-axis); choose one with --series NUMBER: " +
                     list_of(images, stacks, wanted.empty() ? candidates : wanted));
  const std::string number = numbers_of(images, stacks)[candidates.front()];
  DicomChoice choice{std::move(stacks[candidates.front()]), series.empty() ? "" : number};
  if (!series.empty() && stacks.size() > 1)
    note = "number " + number + ", which --series chose, is read (" +
           description_of(image_of(images, choice.stack), choice.stack) + ")";
  if (!note.empty())
    choice.stack.notes.push_back({series.empty() ? Severity::warning : Severity::info, "dicom.several_stacks",
                                  "the folder holds " + std::to_string(stacks.size()) + " image stacks; " + note});
  return choice;
}

}  // namespace dynasurf::io
