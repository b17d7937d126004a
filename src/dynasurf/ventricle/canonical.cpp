#include "dynasurf/ventricle/detail/canonical.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "dynasurf/core/detail/not_finite.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr int least_slices = 3;
constexpr int least_pixels = 8;

/// The bright voxels of one slice summed over the gates: how much there is, and how dark their middle is.
struct SliceLook {
  double mass = 0;
  double hollow = 0;  // 0: the middle is as bright as the brightest, 1: dark
};

SliceLook look_at_slice(const Image& mean, int k, double peak) {
  const Grid& g = mean.grid;
  double mass = 0, x = 0, y = 0, brightest = 0;
  for (int j = 0; j < g.dims[1]; ++j)
    for (int i = 0; i < g.dims[0]; ++i) {
      const double v = mean(i, j, k);
      if (v < 0.4 * peak) continue;
      mass += v, x += v * i, y += v * j;
      brightest = std::max(brightest, v);
    }
  if (mass == 0) return {};
  const int ci = round_int(x / mass), cj = round_int(y / mass);
  double middle = 0;
  for (int dj = -1; dj <= 1; ++dj)
    for (int di = -1; di <= 1; ++di) middle += mean.clamped(ci + di, cj + dj, k) / 9.0;
  return {mass, std::clamp(1 - middle / brightest, 0.0, 1.0)};
}

}  // namespace

float peak_of(std::span<const Image> gates) {
  std::vector<float> peaks(gates.size());
  parallel_for(gates.size(), 1, [&](std::size_t g, std::size_t) {
    peaks[g] = *std::max_element(gates[g].values.begin(), gates[g].values.end());
  });
  return std::max(0.0F, *std::max_element(peaks.begin(), peaks.end()));
}

/// Neighbouring gates of the same values are one gate that was stored twice, unless nothing moves at all.
void tell_same_gates(Study& study) {
  const std::size_t gates = study.gates.size();
  std::vector<std::size_t> like_next;
  for (std::size_t g = 0; g + 1 < gates; ++g)
    if (study.gates[g].values == study.gates[g + 1].values) like_next.push_back(g);
  if (like_next.empty() || like_next.size() + 1 == gates) return;
  const std::size_t first = like_next.front();
  study.notes.push_back({Severity::warning, "study.same_gates",
                         "gates " + std::to_string(first + 1) + " and " + std::to_string(first + 2) +
                             " hold the same values: one of them may be lost"});
}

void require_workable(const Study& study) {
  if (study.gates.empty()) throw InputError("the study holds no volume; expected at least one gate");
  const Grid& grid = study.grid();
  if (grid.dims[2] < least_slices || grid.dims[0] < least_pixels || grid.dims[1] < least_pixels) {
    TextOutput text;
    text << "the volume has " << grid.dims[0] << " x " << grid.dims[1] << " pixels in " << grid.dims[2]
         << " slices; expected at least " << least_pixels << " x " << least_pixels << " in " << least_slices;
    throw InputError(text.str());
  }
  const std::vector<std::size_t> bad = not_finite_in(study.gates);
  for (std::size_t g = 0; g < study.gates.size(); ++g) {
    const Image& image = study.gates[g];
    if (!(image.grid == grid)) throw InputError("gate " + std::to_string(g + 1) + " lies on another grid than gate 1");
    if (bad[g] > 0)
      throw InputError("gate " + std::to_string(g + 1) + " holds a value that is not finite at voxel " +
                       std::to_string(first_not_finite(image)) + "; expected numbers only");
  }
}

SliceOrder guess_slice_order(std::span<const Image> gates) {
  Image mean(gates.front().grid);
  for (const Image& gate : gates)
    for (std::size_t v = 0; v < mean.values.size(); ++v) mean.values[v] += gate.values[v];
  const double peak = *std::max_element(mean.values.begin(), mean.values.end());
  if (peak <= 0) return SliceOrder::unknown;

  // The ends of the heart along the stack, and how hollow each half of it is.
  std::vector<SliceLook> looks;
  for (int k = 0; k < mean.grid.dims[2]; ++k) {
    const SliceLook look = look_at_slice(mean, k, peak);
    if (look.mass > 0) looks.push_back(look);
  }
  if (looks.size() < 4) return SliceOrder::unknown;
  const std::size_t third = std::max<std::size_t>(1, looks.size() / 3);
  double low = 0, high = 0;
  for (std::size_t s = 0; s < third; ++s) {
    low += looks[s].hollow / third;
    high += looks[looks.size() - 1 - s].hollow / third;
  }
  constexpr double least_difference = 0.1;
  if (std::abs(high - low) < least_difference) return SliceOrder::unknown;
  return high > low ? SliceOrder::apex_to_base : SliceOrder::base_to_apex;
}

Study reverse_slices(Study study) {
  for (Image& image : study.gates) {
    Grid& g = image.grid;
    const Index slice = g.slice_size();
    for (int low = 0, high = g.dims[2] - 1; low < high; ++low, --high)
      std::swap_ranges(image.values.begin() + low * slice, image.values.begin() + (low + 1) * slice,
                       image.values.begin() + high * slice);
    // The last slice becomes the first, and the axis runs the other way.
    g.origin += g.direction.col(2) * (g.spacing[2] * (g.dims[2] - 1));
    g.direction.col(2) *= -1;
  }
  if (study.slice_order == SliceOrder::apex_to_base)
    study.slice_order = SliceOrder::base_to_apex;
  else if (study.slice_order == SliceOrder::base_to_apex)
    study.slice_order = SliceOrder::apex_to_base;
  return study;
}

Study canonical_study(Study study) {
  require_workable(study);
  if (study.view != View::short_axis && study.view != View::unknown)
    throw InputError("the slices are " + std::string(name_of(study.view)) +
                     " ones; expected a short-axis stack: reorient the study to short axis first");
  if (study.view == View::unknown) {
    study.view = View::short_axis;
    study.notes.push_back(
        {Severity::info, "study.view_assumed", "the file does not name its view; taken as a short-axis stack"});
  }
  if (study.slice_order == SliceOrder::unknown) {
    const SliceOrder guess = guess_slice_order(study.gates);
    study.slice_order = guess == SliceOrder::unknown ? SliceOrder::apex_to_base : guess;
    if (guess == SliceOrder::unknown)
      study.notes.push_back({Severity::warning, "study.slice_order_unclear",
                             "neither the file nor the data tell apex from base; taken as apex first"});
    else
      study.notes.push_back(
          {Severity::info, "study.slice_order_guessed",
           std::string("the file does not tell apex from base; the data say ") + std::string(name_of(guess))});
  }
  if (study.slice_order == SliceOrder::base_to_apex) study = reverse_slices(std::move(study));

  const float peak = peak_of(study.gates);
  if (peak <= 0) {
    study.notes.push_back({Severity::failure, "study.empty", "the study holds no positive value"});
    return study;
  }
  tell_same_gates(study);
  parallel_for(study.gates.size(), 1, [&](std::size_t g, std::size_t) {
    for (float& v : study.gates[g].values) v /= peak;
  });
  return study;
}

}  // namespace dynasurf::ventricle
