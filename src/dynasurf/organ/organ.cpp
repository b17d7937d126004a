#include "dynasurf/organ/organ.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/dynamics/detail/damping.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/ventricle/detail/closure.hpp"

namespace dynasurf::organ {
namespace {

constexpr std::array<std::string_view, 4> presets{"ct", "mr", "pet", "labels"};
constexpr int room_voxels = 3;  // around a border, for its field

void require_workable(const Image& image) {
  for (const int n : image.grid.dims)
    if (n < 3) throw InputError("the image has " + std::to_string(n) + " voxels along one side; expected at least 3");
  for (const float v : image.values)
    if (!std::isfinite(v)) throw InputError("the image holds a value that is not finite");
}

/// The two usual values of an image, low and high: means of the two classes that differ most (Otsu, IEEE Trans Syst Man
/// Cybern 9:62, 1979).
std::array<double, 2> usual_values(const Image& image) {
  const auto [low, high] = std::minmax_element(image.values.begin(), image.values.end());
  const double from = *low, width = *high - from;
  constexpr std::size_t bins = 256;
  std::array<double, bins> count{}, sum{};
  for (const float v : image.values) {
    const double share = width > 0 ? (v - from) / width : 0;
    const auto bin = std::min<std::size_t>(bins - 1, share * bins);
    count[bin] += 1, sum[bin] += v;
  }
  double all = 0, total = 0;
  for (std::size_t b = 0; b < bins; ++b) all += count[b], total += sum[b];
  double best = -1, below = 0, below_sum = 0;
  std::array<double, 2> means{from, from + width};
  for (std::size_t b = 0; b + 1 < bins; ++b) {
    below += count[b], below_sum += sum[b];
    if (below == 0 || below == all) continue;
    const double a = below_sum / below, c = (total - below_sum) / (all - below);
    const double between = below * (all - below) * (c - a) * (c - a);
    if (between > best) best = between, means = {a, c};
  }
  return means;
}

/// 1 in the voxels that may be the organ's.
std::vector<char> candidates(const Image& image, const Options& o, double& threshold) {
  std::vector<char> is_inside(image.values.size(), 0);
  if (o.source == Source::labels) {
    threshold = o.label;
    for (std::size_t n = 0; n < is_inside.size(); ++n)
      is_inside[n] = o.label == 0 ? image.values[n] > 0 : std::lround(image.values[n]) == o.label;
    return is_inside;
  }
  if (o.source == Source::of_maximum) {
    threshold = o.level * *std::max_element(image.values.begin(), image.values.end());
  } else {
    const std::array<double, 2> usual = usual_values(image);
    threshold = usual[0] + o.level * (usual[1] - usual[0]);
  }
  for (std::size_t n = 0; n < is_inside.size(); ++n) is_inside[n] = (image.values[n] > threshold) != o.dark;
  return is_inside;
}

/// Sets of voxels joined by common faces, in the order of their first voxels.
struct Parts {
  std::vector<int> part;  // of every voxel, -1: none
  std::vector<std::size_t> size;
  std::vector<char> is_cut;  // by the image's edge
};
Parts parts_of(const std::vector<char>& inside, const Index3& dims) {
  Parts parts{std::vector<int>(inside.size(), -1), {}, {}};
  const std::array<std::size_t, 3> stride{1, size_of({dims[0], 1, 1}), size_of({dims[0], dims[1], 1})};
  std::vector<std::size_t> open;
  for (std::size_t seed = 0; seed < inside.size(); ++seed) {
    if (!inside[seed] || parts.part[seed] >= 0) continue;
    const int number = parts.size.size();
    parts.size.push_back(0), parts.is_cut.push_back(0);
    parts.part[seed] = number;
    open.push_back(seed);
    while (!open.empty()) {
      const std::size_t n = open.back();
      open.pop_back();
      ++parts.size.back();
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t length = dims[a], at = n / stride[a] % length;
        if (at == 0 || at + 1 == length) parts.is_cut.back() = 1;
        for (const std::size_t next : {at > 0 ? n - stride[a] : n, at + 1 < length ? n + stride[a] : n})
          if (inside[next] && parts.part[next] < 0) parts.part[next] = number, open.push_back(next);
      }
    }
  }
  return parts;
}

/// The largest body without its holes.
std::vector<char> largest_body(const std::vector<char>& inside, const Index3& dims, Notes& notes) {
  const Parts parts = parts_of(inside, dims);
  if (parts.size.empty()) return {};
  const auto largest = std::max_element(parts.size.begin(), parts.size.end());
  const int number = largest - parts.size.begin();
  if (parts.is_cut[number])
    notes.push_back(
        {Severity::warning, "organ.cut_off", "the organ reaches the edge of the image; its surface is closed there"});
  std::size_t rest = 0;
  for (const std::size_t size : parts.size) rest += size;
  rest -= *largest;
  if (rest * 20 > *largest)
    notes.push_back({Severity::info, "organ.parts",
                     std::to_string(parts.size.size() - 1) + " smaller parts with " +
                         std::to_string(100 * rest / *largest) + " % of the organ's voxels were left out"});
  std::vector<char> around(inside.size());
  for (std::size_t n = 0; n < around.size(); ++n) around[n] = parts.part[n] != number;
  const Parts outside = parts_of(around, dims);
  std::vector<char> body(inside.size());
  for (std::size_t n = 0; n < body.size(); ++n) body[n] = !around[n] || !outside.is_cut[outside.part[n]];
  return body;
}

/// Voxels of the body with a face to the outside, on a grid with room around.
Image border_of(const Image& body) {
  Image border(body.grid);
  const Index3 dims = body.grid.dims;
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; ++j)
      for (int i = 0; i < dims[0]; ++i) {
        const auto is_out = [&](int x, int y, int z) {
          return x < 0 || y < 0 || z < 0 || x >= dims[0] || y >= dims[1] || z >= dims[2] || body(x, y, z) == 0;
        };
        if (body(i, j, k) > 0 && (is_out(i - 1, j, k) || is_out(i + 1, j, k) || is_out(i, j - 1, k) ||
                                  is_out(i, j + 1, k) || is_out(i, j, k - 1) || is_out(i, j, k + 1)))
          border(i, j, k) = 1;
      }
  return ventricle::with_room(std::move(border), room_voxels);
}

}  // namespace

std::span<const std::string_view> preset_names() { return presets; }

Options preset(std::string_view name) {
  Options o;
  switch (position_of(presets, name, "preset")) {
    case 2:
      o.source = Source::of_maximum;
      o.level = 0.42;  // of the largest, as lesions are usually outlined
      return o;
    case 3:
      o.source = Source::labels;
      return o;
    default:  // MR and CT differ in how their values come about, not in how an organ stands out
      return o;
  }
}

Result reconstruct(const Image& image, const Options& requested, const Progress& progress) {
  Options options = requested;
  check_options(options, "organ");
  require_workable(image);
  Result result;
  const std::vector<char> inside =
      largest_body(candidates(image, options, result.threshold), image.grid.dims, result.notes);
  Image body(image.grid);
  std::size_t voxels = 0;
  for (std::size_t n = 0; n < inside.size(); ++n) body.values[n] = inside[n] ? 1.0F : 0.0F, voxels += inside[n] != 0;
  if (voxels == 0) {
    result.notes.push_back({Severity::failure, "organ.none", "no voxel belongs to an organ; another level or label?"});
    return result;
  }
  result.voxels_ml = voxels * image.grid.spacing.prod() / 1000;

  const Image border = border_of(body);
  progress.check();
  const field::FlowResult flow = field::flow_field(border, options.field, progress);
  dynamics::Additions own;
  own.drag = dynamics::drag_map(options.evolution.damping, flow.field, border, options.evolution.force.drag,
                                [&] { return ventricle::spread_to(image, border.grid); });
  const dynamics::EvolutionResult evolved =
      dynamics::evolve(mesh::start_mesh(border, options.mesh_level, options.placement), flow.field, border,
                       options.evolution, progress, own);
  // A label map has steps between its voxels; an image of many parts shows other slopes than this body's.
  const bool is_map = options.source == Source::labels;
  const Image& seen = is_map ? body : image;
  const Image smooth =
      image::smooth_gaussian(ventricle::spread_to(seen, border.grid),
                             std::max(options.smooth_voxels, is_map ? 0.7 : 0.0) * image.grid.spacing.minCoeff());
  const TriMesh settled = ventricle::settle_on_slope(evolved.mesh, smooth, Vec3::Zero(), options.settle);
  result.surface = ventricle::measure_surface(evolved, border, std::nullopt, options.tidy,
                                              evolved.reason == dynamics::StopReason::diverged ? nullptr : &settled);
  for (const Notes* notes : std::initializer_list<const Notes*>{&flow.notes, &evolved.notes, &result.surface->notes})
    result.notes.insert(result.notes.end(), notes->begin(), notes->end());
  return result;
}

}  // namespace dynasurf::organ
