#include "dynasurf/field/band.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/band/detail/bricks.hpp"
#include "dynasurf/field/detail/gradient.hpp"

namespace dynasurf::field {

struct BandField::Levels {
  Grid grid;
  std::vector<band::Level> levels;
};

namespace {

using band::BrickData;
using band::side;

/// b and b times the gradient of one brick of a map, `value(i, j, k)` anywhere in the grid. False when all are 0.
template <class F>
bool fill_data(const Grid& g, const Index3& place, const F& value, BrickData& data) {
  data.place = place;
  data.b.fill(0);
  for (auto& c : data.pull) c.fill(0);
  bool any = false;
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        const Index3 v = band::cell_of(place, i, j, k);
        if (!band::is_inside(v, g.dims)) continue;
        Vec3 slope;
        for (std::size_t a = 0; a < 3; ++a) {
          Index3 before = v, after = v;
          before[a] = std::max(before[a] - 1, 0);
          after[a] = std::min(after[a] + 1, g.dims[a] - 1);
          slope[a] = detail::slope(value(before), value(after), v[a], g.dims[a], g.spacing[a]);
        }
        const double b = slope.squaredNorm();
        if (b == 0) continue;
        any = true;
        const std::size_t at = band::cell_at(i, j, k);
        data.b[at] = b;
        for (std::size_t c = 0; c < 3; ++c) data.pull[c][at] = b * slope[c];
      }
  return any;
}

Index3 bricks_of(const Grid& g) {
  return {(g.dims[0] + side - 1) / side, (g.dims[1] + side - 1) / side, (g.dims[2] + side - 1) / side};
}

bool is_finite(const Image& map) {
  const std::size_t grain = std::size_t{1} << 18;
  return parallel_max(map.values.size(), grain, [&](std::size_t begin, std::size_t end) {
           int largest = 0;
           for (std::size_t v = begin; v < end; ++v)
             // Without their signs floats order as their bits do; infinity and all that is no number stand at the end.
             largest = std::max(largest, std::bit_cast<int>(map.values[v]) & 0x7fffffff);
           return largest >= 0x7f800000 ? 1.0 : 0.0;
         }) == 0;
}

/// Bricks of a dense map where its gradient is not 0.
std::vector<BrickData> data_of(const Image& map) {
  const Index3 n = bricks_of(map.grid);
  std::vector<std::vector<BrickData>> layers(n[2]);
  const auto value = [&](const Index3& v) { return map(v[0], v[1], v[2]); };
  // A brick whose values and those around it are all alike has no gradient; most are.
  const auto is_flat = [&](const Index3& p) {
    Index3 low, high;
    for (std::size_t a = 0; a < 3; ++a) {
      low[a] = std::max(side * p[a] - 1, 0);
      high[a] = std::min(side * p[a] + side, map.grid.dims[a] - 1);
    }
    const int first = std::bit_cast<int>(value(low));
    for (int k = low[2]; k <= high[2]; ++k)
      for (int j = low[1]; j <= high[1]; ++j) {
        int other = 0;
        const float* row = map.values.data() + map.grid.index(0, j, k);
        // By bits, without a branch; 0 and -0 differ, which costs a look and no more.
        for (int i = low[0]; i <= high[0]; ++i) other |= std::bit_cast<int>(row[i]) ^ first;
        if (other != 0) return false;
      }
    return true;
  };
  parallel_for(layers.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          const Index3 place{i, j, static_cast<int>(k)};
          BrickData data;
          if (!is_flat(place) && fill_data(map.grid, place, value, data)) layers[k].push_back(data);
        }
  });
  std::vector<BrickData> all;
  for (const auto& layer : layers) all.insert(all.end(), layer.begin(), layer.end());
  return all;
}

/// Voxels of a border as one bit each, in the bricks that have any.
struct BorderBits {
  Index3 bricks;
  std::vector<std::int32_t> brick_at;
  std::vector<Index3> place;
  std::vector<std::array<std::uint64_t, 8>> bits;  // one word per slice of a brick

  std::size_t brick(const Index3& p) {
    std::int32_t& number = brick_at[index_in(bricks, p)];
    if (number < 0) {
      number = place.size();
      place.push_back(p);
      bits.push_back({});
    }
    return number;
  }
  float operator()(const Index3& v) const {
    const std::int32_t number = brick_at[index_in(bricks, {v[0] / side, v[1] / side, v[2] / side})];
    if (number < 0) return 0;
    const std::uint64_t slice = bits[number][v[2] % side];
    return slice >> (v[0] % side + side * (v[1] % side)) & 1 ? 1.0f : 0.0f;
  }
};

std::vector<BrickData> data_of(const Grid& g, std::span<const Index3> border) {
  BorderBits map;
  map.bricks = bricks_of(g);
  map.brick_at.assign(size_of(map.bricks), -1);
  for (std::size_t n = 0; n < border.size(); ++n) {
    const Index3& v = border[n];
    if (v[0] < 0 || v[1] < 0 || v[2] < 0 || !band::is_inside(v, g.dims))
      throw InputError("border: voxel number " + std::to_string(n) + " lies outside the grid");
    const std::size_t own = map.brick({v[0] / side, v[1] / side, v[2] / side});
    map.bits[own][v[2] % side] |= std::uint64_t{1} << (v[0] % side + side * (v[1] % side));
    // A voxel on the face of its brick gives the neighbour a gradient.
    for (std::size_t a = 0; a < 3; ++a)
      for (int step : {-1, 1}) {
        Index3 beside = v;
        beside[a] += step;
        if (beside[a] >= 0 && beside[a] < g.dims[a]) map.brick({beside[0] / side, beside[1] / side, beside[2] / side});
      }
  }
  std::vector<BrickData> all(map.place.size());
  std::vector<std::uint8_t> used(all.size());
  parallel_for(all.size(), 16, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) used[n] = fill_data(g, map.place[n], map, all[n]);
  });
  std::vector<BrickData> kept;
  for (std::size_t n = 0; n < all.size(); ++n)
    if (used[n]) kept.push_back(all[n]);
  return kept;
}

BandResult solve(const Grid& grid, std::vector<BrickData> data, const BandGvf& o, const Progress& progress) {
  const auto levels = std::make_shared<BandField::Levels>();
  levels->grid = grid;
  BandResult result{BandField(levels), 0, 0, {}};
  if (data.empty()) return result;
  std::array<double, 3> rates{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double h = grid.spacing[a];
    rates[a] = o.mu / (h * h);
  }
  levels->levels = band::build(grid, rates, data, o.reach_voxels);
  data = {};  // makes room for the solution
  const band::Outcome outcome = band::solve(levels->levels, o.tolerance, o.most_cycles, progress);
  for (band::Level& l : levels->levels) {  // only the field is asked for from here on
    l.rhs = l.before = {};
    l.b = l.d = {};
    l.ghosts = {};
    l.plain = {};
  }
  result.cycles = outcome.cycles;
  result.error = outcome.error;
  if (outcome.error >= o.tolerance) {
    TextOutput text;
    text << "the field of the band was left at an estimated relative error of " << outcome.error << " after "
         << outcome.cycles << " cycles; asked for was " << o.tolerance;
    result.notes.push_back({Severity::warning, "band.tolerance_missed", text.str()});
  }
  return result;
}

/// Value at a cell of level `l`; from coarser levels where its brick does not exist.
Vec3 value_at(const std::vector<band::Level>& levels, std::size_t l, const Index3& cell) {
  const band::Level& level = levels[l];
  const int number = level.number({cell[0] / side, cell[1] / side, cell[2] / side});
  if (number >= 0) {
    const auto& u = level.u[number];
    const std::size_t at = band::cell_at(cell[0] % side, cell[1] % side, cell[2] % side);
    return {u[0][at], u[1][at], u[2][at]};
  }
  const Index3& coarse = levels[l + 1].dims;
  Index3 own, next;
  for (std::size_t a = 0; a < 3; ++a) {
    own[a] = level.axis[a].halved ? cell[a] / 2 : cell[a];
    next[a] = level.axis[a].halved ? std::clamp(own[a] + (cell[a] % 2 == 0 ? -1 : 1), 0, coarse[a] - 1) : own[a];
  }
  Vec3 sum = Vec3::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    Index3 at;
    double weight = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const bool far = corner >> a & 1;
      at[a] = far ? next[a] : own[a];
      // The centre of a fine cell lies a quarter of a coarse cell from the centre of its own.
      weight *= far ? 0.25 : 0.75;
    }
    sum += weight * value_at(levels, l + 1, at);
  }
  return sum;
}

}  // namespace

BandField::BandField(std::shared_ptr<const Levels> levels) : levels_(std::move(levels)) {}

const Grid& BandField::grid() const { return levels_->grid; }

Vec3 BandField::at(int i, int j, int k) const {
  return levels_->levels.empty() ? Vec3(Vec3::Zero()) : value_at(levels_->levels, 0, {i, j, k});
}

bool BandField::is_in_band(int i, int j, int k) const {
  return !levels_->levels.empty() && levels_->levels[0].number({i / side, j / side, k / side}) >= 0;
}

double BandField::largest() const {
  double squared = 0;
  if (levels_->levels.empty()) return 0;
  const band::Level& l = levels_->levels[0];
  for (std::size_t n = 0; n < l.place.size(); ++n)
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          if (!band::is_inside(band::cell_of(l.place[n], i, j, k), l.dims)) continue;
          const std::size_t at = band::cell_at(i, j, k);
          const double own = Vec3(l.u[n][0][at], l.u[n][1][at], l.u[n][2][at]).squaredNorm();
          if (!(own <= squared)) squared = own;  // lets NaN through
        }
  return std::sqrt(squared);
}

std::size_t BandField::voxels_in_band() const {
  std::size_t count = 0;
  if (levels_->levels.empty()) return 0;
  const band::Level& l = levels_->levels[0];
  for (const Index3& p : l.place) {
    std::size_t cells = 1;
    for (std::size_t a = 0; a < 3; ++a) cells *= std::min(side, l.dims[a] - side * p[a]);
    count += cells;
  }
  return count;
}

std::size_t BandField::bytes() const {
  std::size_t sum = 0;
  for (const band::Level& l : levels_->levels)
    sum += l.brick_at.size() * sizeof(std::int32_t) + l.place.size() * (sizeof(Index3) + sizeof(band::Cells3));
  return sum;
}

VectorField dense_field(const BandField& field) {
  VectorField out(field.grid());
  const Index3& n = out.grid.dims;
  parallel_for(n[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < n[1]; ++j)
        for (int i = 0; i < n[0]; ++i) {
          const Vec3 u = field.at(i, j, k);
          const std::size_t v = out.grid.index(i, j, k);
          out.x[v] = u[0];
          out.y[v] = u[1];
          out.z[v] = u[2];
        }
  });
  return out;
}

namespace {

/// What GGVF makes of the data of GVF: b = h/g = exp(|grad f| / K) - 1, with K a share of the largest gradient.
void generalise(std::vector<BrickData>& data, double k) {
  float most = 0;
  for (const BrickData& brick : data) most = std::max(most, *std::max_element(brick.b.begin(), brick.b.end()));
  const double inverse_k = most > 0 ? 1 / (k * std::sqrt(static_cast<double>(most))) : 0;
  for (BrickData& brick : data)
    for (std::size_t at = 0; at < band::brick_cells; ++at) {
      const double b = brick.b[at];
      if (b == 0) continue;
      const double now = own::expm1(std::min(16.0, inverse_k * std::sqrt(b)));
      brick.b[at] = now;
      for (auto& pull : brick.pull) pull[at] = now / b * pull[at];
    }
}

BandResult solve(const Grid& grid, std::vector<BrickData> data, const BandGgvf& o, const Progress& progress) {
  generalise(data, o.k);
  return solve(grid, std::move(data), BandGvf{1, o.tolerance, o.reach_voxels, o.most_cycles}, progress);
}

template <class Options>
BandResult field_of_map(const Image& edge_map, Options o, const Progress& progress) {
  check_options(o, std::string(Options::name));
  detail::check_grid(edge_map);
  if (!is_finite(edge_map)) detail::check_edge_map(edge_map);  // names the place
  std::vector<BrickData> data = data_of(edge_map);
  for (const BrickData& brick : data)
    if (std::any_of(brick.b.begin(), brick.b.end(), [](float b) { return !std::isfinite(b); }))
      detail::check_edge_map(edge_map);
  return solve(edge_map.grid, std::move(data), o, progress);
}

template <class Options>
BandResult field_of_voxels(const Grid& grid, std::span<const Index3> border, Options o, const Progress& progress) {
  check_options(o, std::string(Options::name));
  if (grid.size() == 0 || !(grid.spacing.minCoeff() > 0) || !grid.spacing.allFinite())
    throw InputError("border: the grid must have at least one voxel and a positive spacing along every axis");
  return solve(grid, data_of(grid, border), o, progress);
}

FlowResult dense_result(const BandResult& band) {
  FlowResult result;
  result.field = dense_field(band.field);
  result.iterations = band.cycles;
  result.error = band.error;
  result.notes = band.notes;
  return result;
}

}  // namespace

BandResult band_field(const Image& edge_map, const BandGvf& options, const Progress& progress) {
  return field_of_map(edge_map, options, progress);
}

BandResult band_field(const Image& edge_map, const BandGgvf& options, const Progress& progress) {
  return field_of_map(edge_map, options, progress);
}

BandResult band_field(const Grid& grid, std::span<const Index3> border, const BandGvf& options,
                      const Progress& progress) {
  return field_of_voxels(grid, border, options, progress);
}

BandResult band_field(const Grid& grid, std::span<const Index3> border, const BandGgvf& options,
                      const Progress& progress) {
  return field_of_voxels(grid, border, options, progress);
}

FlowResult flow_field(const Image& edge_map, const BandGvf& options, const Progress& progress) {
  return dense_result(band_field(edge_map, options, progress));
}

FlowResult flow_field(const Image& edge_map, const BandGgvf& options, const Progress& progress) {
  return dense_result(band_field(edge_map, options, progress));
}

}  // namespace dynasurf::field
