#include "dynasurf/io/detail/study_mend.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "dynasurf/core/detail/fill_gates.hpp"
#include "dynasurf/core/detail/not_finite.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::io {
namespace {

constexpr double most_outside = 0.5;         // of the voxels of all gates
constexpr float bright_beside = 0.3f;        // of the brightest voxel: more is heart or gut, not background
constexpr float times_neighbours = 20;       // a blurred point source is at most a few times its neighbours
constexpr float times_all_else = 2;          // than which the brightest of other voxels do not lose a study
constexpr std::size_t least_neighbours = 7;  // of the corner of a volume; in less of one nothing stands alone
constexpr std::size_t most_hot_voxels = 16;

std::string voxel_text(const Grid& grid, std::size_t voxel, std::size_t gate) {
  const Index3 p = voxel_in(grid.dims, voxel);
  return "voxel (" + std::to_string(p[0]) + "," + std::to_string(p[1]) + "," + std::to_string(p[2]) + ") of gate " +
         std::to_string(gate + 1);
}

/// Calls `use(index)` for the six neighbours within the grid.
template <class Use>
void each_beside(const Grid& grid, std::size_t voxel, const Use& use) {
  const Index3 p = voxel_in(grid.dims, voxel);
  std::size_t stride = 1;
  for (std::size_t a = 0; a < 3; ++a) {
    if (p[a] > 0) use(voxel - stride);
    if (p[a] + 1 < grid.dims[a]) use(voxel + stride);
    stride *= grid.dims[a];
  }
}

bool is_on_rim(const Grid& grid, std::size_t voxel) {
  const Index3 p = voxel_in(grid.dims, voxel);
  for (std::size_t a = 0; a < 3; ++a)
    // The two faces across a single slice are no rim: all of it would be one.
    if (grid.dims[a] > 1 && (p[a] == 0 || p[a] + 1 == grid.dims[a])) return true;
  return false;
}

/// What filling one gate did.
struct Outside {
  std::size_t count = 0;  // of voxels that became 0
  float beside = 0;       // the brightest voxel next to them
};

/// Sets what is joined to the rim to 0.
Outside fill_from_rim(Image& image) {
  Outside outside;
  std::vector<std::size_t> open, filled;
  const auto take = [&](std::size_t v) {
    if (std::isfinite(image.values[v])) return;
    image.values[v] = 0;
    open.push_back(v);
    filled.push_back(v);
  };
  for (std::size_t v = 0; v < image.values.size(); ++v)
    if (!std::isfinite(image.values[v]) && is_on_rim(image.grid, v)) take(v);
  while (!open.empty()) {
    const std::size_t v = open.back();
    open.pop_back();
    each_beside(image.grid, v, take);
  }
  for (const std::size_t v : filled)
    each_beside(image.grid, v, [&](std::size_t n) { outside.beside = std::max(outside.beside, image.values[n]); });
  outside.count = filled.size();
  return outside;
}

struct HotVoxel {
  std::size_t gate = 0, voxel = 0;
  float value = 0;
};

std::vector<float> neighbours_of(const Image& image, std::size_t voxel) {
  const Index3 p = voxel_in(image.grid.dims, voxel);
  std::vector<float> values;
  for (int k = p[2] - 1; k <= p[2] + 1; ++k)
    for (int j = p[1] - 1; j <= p[1] + 1; ++j)
      for (int i = p[0] - 1; i <= p[0] + 1; ++i)
        if (image.grid.contains(i, j, k) && !(i == p[0] && j == p[1] && k == p[2])) values.push_back(image(i, j, k));
  return values;
}

bool is_alone(const Image& image, std::size_t voxel) {
  const std::vector<float> beside = neighbours_of(image, voxel);
  if (beside.size() < least_neighbours) return false;
  const float most = *std::max_element(beside.begin(), beside.end());
  return image.values[voxel] > times_neighbours * std::max(most, 0.0f);
}

/// The bright voxels of a gate that stand alone, brightest first, and the brightest of the others; nothing of it when
/// there are too many.
struct Lonely {
  std::vector<HotVoxel> voxels;
  std::optional<float> others;
};

Lonely find_alone(const Image& image, std::size_t gate) {
  Lonely found;
  while (found.voxels.size() <= most_hot_voxels) {
    std::optional<std::size_t> brightest;
    for (std::size_t v = 0; v < image.values.size(); ++v) {
      if (brightest && image.values[v] <= image.values[*brightest]) continue;
      const bool is_known =
          std::any_of(found.voxels.begin(), found.voxels.end(), [&](const HotVoxel& h) { return h.voxel == v; });
      if (!is_known) brightest = v;
    }
    if (!brightest) break;
    const float value = image.values[*brightest];
    if (!is_alone(image, *brightest)) {
      found.others = value;
      break;
    }
    found.voxels.push_back({gate, *brightest, value});
  }
  return found;
}

bool is_empty(const Image& image) {
  return std::all_of(image.values.begin(), image.values.end(), [&](float v) { return v == image.values.front(); });
}

}  // namespace

void fill_outside_field(std::vector<Image>& gates, const std::string& where, Notes& notes) {
  const std::vector<std::size_t> bad = not_finite_in(gates);
  std::size_t count = 0, voxels = 0;
  std::optional<std::string> first;
  for (std::size_t g = 0; g < gates.size(); ++g) {
    if (bad[g] > 0 && !first) first = voxel_text(gates[g].grid, first_not_finite(gates[g]), g);
    count += bad[g];
    voxels += gates[g].values.size();
  }
  if (count == 0) return;
  const std::string reason = " is not a finite number; expected counts";
  if (count > most_outside * voxels)
    throw InputError(where + ": " + *first + reason + " (" + std::to_string(count) + " of " + std::to_string(voxels) +
                     " voxels are not)");
  float beside = 0, brightest = 0;
  for (std::size_t g = 0; g < gates.size(); ++g) {
    beside = std::max(beside, fill_from_rim(gates[g]).beside);
    for (std::size_t v = 0; v < gates[g].values.size(); ++v) {
      if (!std::isfinite(gates[g].values[v])) throw InputError(where + ": " + voxel_text(gates[g].grid, v, g) + reason);
      brightest = std::max(brightest, gates[g].values[v]);
    }
  }
  const bool is_cut = beside > bright_beside * brightest;
  notes.push_back({is_cut ? Severity::warning : Severity::info, "study.not_finite",
                   std::to_string(count) + " of " + std::to_string(voxels) +
                       " values are not finite numbers and lie outside the field: taken as 0" +
                       (is_cut ? "; bright voxels stand beside them, so the field may cut what is looked for" : "")});
}

void mend_hot_voxels(Study& study) {
  std::vector<Lonely> found(study.gates.size());
  parallel_for(found.size(), 1, [&](std::size_t g, std::size_t) { found[g] = find_alone(study.gates[g], g); });
  std::vector<HotVoxel> alone;
  float most = 0;
  for (const Lonely& gate : found) {
    if (!gate.others) return;
    most = std::max(most, *gate.others);
    alone.insert(alone.end(), gate.voxels.begin(), gate.voxels.end());
  }
  std::erase_if(alone, [&](const HotVoxel& h) { return h.value <= times_all_else * most; });
  if (alone.empty() || alone.size() > most_hot_voxels || !(most > 0)) return;
  for (const HotVoxel& hot : alone) {
    study.gates[hot.gate].values[hot.voxel] = upper_median(neighbours_of(study.gates[hot.gate], hot.voxel));
    study.notes.push_back({Severity::info, "study.hot_voxel",
                           voxel_text(study.grid(), hot.voxel, hot.gate) +
                               " is brighter than all else and stands alone: its neighbours' median is taken",
                           static_cast<int>(hot.gate)});
  }
}

void fill_empty_gates(Study& study) {
  std::vector<bool> empty;
  for (const Image& gate : study.gates) empty.push_back(is_empty(gate));
  const std::size_t count = std::count(empty.begin(), empty.end(), true);
  if (count == 0 || 4 * count > empty.size()) return;
  for (const auto& [gate, before, after] : fill_gates(study.gates, empty))
    study.notes.push_back(
        {Severity::warning, "study.empty_gate",
         "gate " + std::to_string(gate + 1) + " is empty: the mean of gates " + std::to_string(before + 1) + " and " +
             std::to_string(after + 1) +
             " stands in its place; were it the smallest or largest, the ejection fraction would be higher",
         static_cast<int>(gate)});
}

}  // namespace dynasurf::io
