#include <algorithm>
#include <bit>
#include <cmath>
#include <span>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/detail/gradient.hpp"
#include "dynasurf/field/multigrid/detail/coarsen.hpp"

namespace dynasurf::field::multigrid {

namespace {

/// At least `count` floats, all zero when the memory is new or the shape of what it holds has changed.
void make_room(detail::FloatBuffer& buffer, std::size_t count, bool changed) {
  const bool grown = buffer.size() < count;
  if (grown) buffer = detail::FloatBuffer(count);
  if (!grown && !changed) return;
  parallel_for(count, std::size_t{1} << 18, [&](std::size_t begin, std::size_t end) {
    std::fill(buffer.data() + begin, buffer.data() + end, 0.0f);
  });
}

Axis axis_of(std::vector<double> width, double nominal) {
  Axis a;
  a.count = width.size();
  a.nominal = nominal;
  a.left.assign(width.size(), 0);
  a.right.assign(width.size(), 0);
  a.share.assign(width.size(), 1);
  for (std::size_t i = 0; i + 1 < width.size(); ++i) {
    const double apart = (width[i] + width[i + 1]) / 2;
    a.right[i] = 1 / (width[i] * apart);
    a.left[i + 1] = 1 / (width[i + 1] * apart);
  }
  a.width = std::move(width);
  return a;
}

/// Joins pairs of cells along the axes that are nearly the finest ones: diffusion couples their cells most, so that
/// only there the error is smooth after a sweep. Returns the axes of the coarser level; none when all axes are single
/// cells.
std::array<Axis, 3> coarsen(std::array<Axis, 3>& fine) {
  double finest = INFINITY;
  for (const Axis& a : fine)
    if (a.count > 1) finest = std::min(finest, a.nominal);
  std::array<Axis, 3> coarse;
  for (std::size_t d = 0; d < 3; ++d) {
    Axis& a = fine[d];
    a.halved = a.count > 1 && a.nominal <= 1.4143 * finest;
    if (!a.halved) {
      coarse[d] = axis_of(a.width, a.nominal);
      continue;
    }
    std::vector<double> width;
    for (std::size_t i = 0; i < a.width.size(); i += 2)
      width.push_back(a.width[i] + (i + 1 < a.width.size() ? a.width[i + 1] : 0));
    for (std::size_t i = 0; i < a.width.size(); ++i) a.share[i] = a.width[i] / width[i / 2];
    coarse[d] = axis_of(std::move(width), 2 * a.nominal);
  }
  return coarse;
}

/// Sizes and the values along i that all rows share.
void rasterise(Level& l, std::array<Axis, 3> axis, bool finest) {
  const bool changed = l.nx() != axis[0].count || l.ny() != axis[1].count || l.nz() != axis[2].count;
  l.axis = std::move(axis);
  l.finest = finest;
  l.slot = ((l.nx() + 1) / 2 + lanes - 1) / lanes * lanes;
  l.stride = 6 * l.slot;
  const std::size_t rows = size_of({1, l.ny(), l.nz()});
  const std::size_t vector_size = rows * l.stride + 2 * lanes, scalar_size = rows * 2 * l.slot;
  make_room(l.u, vector_size, changed);
  if (finest) {
    make_room(l.empty_d, 18 * l.slot, true);
    l.block_of.resize(scalar_size / lanes);
    l.change.resize(rows);
    l.size.resize(rows);
  } else {
    make_room(l.rhs, vector_size, changed);
    make_room(l.b, scalar_size, changed);
    make_room(l.d, scalar_size, changed);
  }
}

void fill_lanes(Level& l) {
  make_room(l.lane_values, 8 * l.slot, true);
  const Axis& x = l.axis[0];
  for (int i = 0; i < x.count; ++i) {
    float* v = l.lane_values.data() + (i % 2) * l.slot + i / 2;
    v[0] = x.left[i];
    v[2 * l.slot] = x.right[i];
    v[4 * l.slot] = x.left[i] + x.right[i];
    v[6 * l.slot] = x.share[i];
  }
}

void fill_empty_d(Level& l) {
  for (int z : {0, 1, 2})
    for (int y : {0, 1, 2}) {
      const auto cell = [](int type, int n) { return type == 0 ? 0 : type == 2 ? n - 1 : std::min(1, n - 1); };
      const float yz = l.yz_diagonal(cell(y, l.ny()), cell(z, l.nz()));
      for (int i = 0; i < l.nx(); ++i) {
        const float diagonal = l.lane_diagonal(i % 2)[i / 2] + yz;
        l.empty_d.data()[((z * 3 + y) * 2 + i % 2) * l.slot + i / 2] = diagonal > 0 ? 1 / diagonal : 0;
      }
    }
}

/// A row of the map and the rows whose difference is its gradient in y and z.
struct MapRow {
  const float *own, *ym, *yp, *zm, *zp;
  float per_mm[3];           // of a difference over two voxels in x, of those rows in y and z
  const float *begin, *end;  // of the whole map
};

DYNASURF_INLINE MapRow row_of(const Image& map, int j, int k) {
  const Grid& g = map.grid;
  const auto at = [&](int y, int z) { return map.values.data() + g.index(0, y, z); };
  const int jm = std::max(j - 1, 0), jp = std::min(j + 1, g.dims[1] - 1), km = std::max(k - 1, 0),
            kp = std::min(k + 1, g.dims[2] - 1);
  return {at(j, k),
          at(jm, k),
          at(jp, k),
          at(j, km),
          at(j, kp),
          {static_cast<float>(0.5 / g.spacing[0]), static_cast<float>(jp > jm ? 1 / ((jp - jm) * g.spacing[1]) : 0),
           static_cast<float>(kp > km ? 1 / ((kp - km) * g.spacing[2]) : 0)},
          map.values.data(),
          map.values.data() + map.values.size()};
}

constexpr int chunk = 2 * lanes;  // voxels whose even and odd ones share blocks

/// The values of a chunk of a row and those beside them, 0 beyond the row's end. At the ends of a row a voxel stands in
/// for its missing neighbour.
template <class V>
struct MapChunk {
  V own[2], before[2], after[2], ym[2], yp[2], zm[2], zp[2];
};

template <class V>
DYNASURF_INLINE MapChunk<V> chunk_of(const MapRow& r, int first, int n) {
  const int count = std::min(chunk, n - first);
  const float *own = r.own + first, *ym = r.ym + first, *yp = r.yp + first, *zm = r.zm + first, *zp = r.zp + first;
  float copies[5][chunk + 2];  // where reading whole vectors would leave the map
  if (own == r.begin || std::max(yp, zp) + chunk >= r.end) {
    const int from = first > 0 ? -1 : 0, to = std::min(chunk + 1, n - first);
    int copy = 0;
    for (const float** p : {&own, &ym, &yp, &zm, &zp}) {
      std::copy(*p + from, *p + to, copies[copy] + 1 + from);
      *p = copies[copy++] + 1;
    }
  }
  MapChunk<V> c;
  for (int h : {0, 1}) {
    const auto at = [&](const float* p) DYNASURF_INLINE_LAMBDA { return load<V>(p + h * lanes); };
    c.own[h] = at(own), c.before[h] = at(own - 1), c.after[h] = at(own + 1);
    c.ym[h] = at(ym), c.yp[h] = at(yp), c.zm[h] = at(zm), c.zp[h] = at(zp);
  }
  if (first == 0) c.before[0] = where_greater(lane_numbers<V>(), V{}, c.before[0], c.own[0]);
  if (first + count < n) return c;
  for (int h : {0, 1}) {
    const V left = count - h * lanes - lane_numbers<V>();  // voxels from this one on
    c.after[h] = where_equal(left, V(1), c.own[h], c.after[h]);
    if (count == chunk) continue;
    for (V* v : {c.own, c.before, c.after, c.ym, c.yp, c.zm, c.zp}) v[h] = where_greater(left, V{}, v[h], V{});
  }
  return c;
}

/// Whether a chunk has a gradient anywhere. Bits of the largest magnitude are kept in `largest`.
template <class V>
DYNASURF_INLINE bool changes(const MapChunk<V>& c, Ints<V>& largest) {
  Ints<V> change{};
  for (int h : {0, 1}) {
    change = change | (bits_of(c.yp[h]) ^ bits_of(c.ym[h])) | (bits_of(c.zp[h]) ^ bits_of(c.zm[h])) |
             (bits_of(c.after[h]) ^ bits_of(c.before[h]));
    const Ints<V> size = bits_of(c.own[h]) & 0x7fffffff;
    largest = larger(size, largest);
  }
  return any(change);
}

/// Even and odd voxels of a chunk's gradient along one axis.
template <class V>
struct Halves {
  V half[2];
};
template <class V>
DYNASURF_INLINE Halves<V> slope(const V (&after)[2], const V (&before)[2], float per_mm) {
  Halves<V> s;
  split((after[0] - before[0]) * per_mm, (after[1] - before[1]) * per_mm, s.half[0], s.half[1]);
  return s;
}

/// b of 16 voxels from the squares of their gradients.
template <class V>
DYNASURF_INLINE V data_term(V squared, const DataTerm& term) {
  if (term.inverse_k == 0) return squared;
  float b[lanes];
  store(b, squared);
  for (float& x : b) x = own::expm1(std::min(16.0, term.inverse_k * std::sqrt(static_cast<double>(x))));
  return load<V>(b);
}

struct SliceOutcome {
  std::int32_t blocks = 0;
  int first_row = 0, end_row = 0;  // of those with blocks
  double largest_b = 0, sum_b = 0;
  int largest_bits = 0;
};

/// Where the finest level needs blocks of data in one slice: numbers from 0, the halves of a chunk one after the other.
template <class V>
DYNASURF_INLINE void number_blocks(Level& l, const Image& map, int k, SliceOutcome& outcome) {
  const int chunks = l.slot / lanes, nx = l.nx(), ny = l.ny();
  Ints<V> largest{};
  std::int32_t blocks = 0;
  for (int j = 0; j < ny; ++j) {
    const MapRow row = row_of(map, j, k);
    std::int32_t* block_of = l.block_of.data() + l.row_number(j, k) * 2 * chunks;
    const std::int32_t before = blocks;
    if (constexpr int ahead = 4; j + ahead < ny)  // of the rows of one place only that of the next slice is new
      for (int i = 0; i < nx; i += lanes) __builtin_prefetch(row.zp + ahead * nx + i);
    for (int m = 0; m < chunks; ++m) {
      const bool has_data = changes(chunk_of<V>(row, m * chunk, nx), largest);
      for (int half : {0, 1}) block_of[half * chunks + m] = has_data ? blocks++ : -1;
    }
    if (blocks == before) continue;
    if (before == 0) outcome.first_row = j;
    outcome.end_row = j + 1;
  }
  outcome.blocks = blocks;
  std::int32_t bits[lanes];
  store(bits, largest);
  outcome.largest_bits = std::max(outcome.largest_bits, *std::max_element(bits, bits + lanes));
}

/// Fills the blocks of one slice, whose first one is block `first`.
template <class V>
DYNASURF_INLINE void fill_blocks(Level& l, const Image& map, int k, std::int32_t first, DataTerm term,
                                 SliceOutcome& outcome) {
  const int chunks = l.slot / lanes, nx = l.nx();
  V largest_b{}, sum_b{};
  for (int j = 0; j < l.ny(); ++j) {
    const MapRow row = row_of(map, j, k);
    std::int32_t* block_of = l.block_of.data() + l.row_number(j, k) * 2 * chunks;
    const float yz = l.yz_diagonal(j, k);
    for (int m = 0; m < chunks; ++m) {
      if (block_of[m] < 0) continue;
      const MapChunk<V> c = chunk_of<V>(row, m * chunk, nx);
      Halves<V> x = slope(c.after, c.before, row.per_mm[0]);
      const Halves<V> y = slope(c.yp, c.ym, row.per_mm[1]), z = slope(c.zp, c.zm, row.per_mm[2]);
      // One voxel apart at the ends.
      if (m == 0) x.half[0] = where_greater(lane_numbers<V>(), V{}, x.half[0], x.half[0] * 2);
      if (const int last = nx - 1 - m * chunk; last < chunk) {
        V& end = x.half[last % 2];
        const int lane = last / 2;
        end = where_equal(lane_numbers<V>(), V(lane), end * 2, end);
      }
      for (int half : {0, 1}) {
        const std::int32_t number = block_of[half * chunks + m] += first;
        float* data = l.blocks.data() + block_size * static_cast<Index>(number);
        const V gx = x.half[half], gy = y.half[half], gz = z.half[half];
        const V b = data_term(gx * gx + gy * gy + gz * gz, term);
        const V diagonal = b + (load<V>(l.lane_diagonal(half) + lanes * m) + yz);
        store(data, inverse(diagonal, load<V>(l.lane_share(half) + lanes * m)));
        store(data + 16, b);
        store(data + 32, gx);
        store(data + 48, gy);
        store(data + 64, gz);
        largest_b = larger(b, largest_b);
        sum_b += b;  // 0 in unused lanes
      }
    }
  }
  float lane[lanes];
  store(lane, largest_b);
  outcome.largest_b = std::max(outcome.largest_b, static_cast<double>(*std::max_element(lane, lane + lanes)));
  store(lane, sum_b);
  for (const float b : lane) outcome.sum_b += b;
}

Rows box_around(std::span<const SliceOutcome> slices) {
  Rows box;
  for (std::size_t k = 0; k < slices.size(); ++k) {
    const SliceOutcome& s = slices[k];
    if (s.blocks == 0) continue;
    const int slice = k;
    box = box.k1 == 0 ? Rows{slice, slice + 1, s.first_row, s.end_row}
                      : Rows{box.k0, slice + 1, std::min(box.j0, s.first_row), std::max(box.j1, s.end_row)};
  }
  return box;
}

/// Room for so many blocks, and some more: the next map of a series needs about as many.
void make_room_for_blocks(Level& l, std::size_t count) {
  constexpr std::size_t size = block_size;
  if (l.blocks.size() < size * count) l.blocks = detail::FloatBuffer(size * (count + count / 16));
}

/// Cells of all levels, the finest with the voxels' widths, and what does not depend on the data.
void shape_levels(std::vector<Level>& levels, const Grid& grid, const Vec3& rates) {
  if (levels.empty()) levels.emplace_back();
  std::array<Axis, 3> axis;
  for (std::size_t d = 0; d < 3; ++d) {
    const double width = 1 / std::sqrt(rates[d]);
    axis[d] = axis_of(std::vector<double>(grid.dims[d], width), width);
  }
  rasterise(levels[0], axis, true);
  std::size_t count = 1;
  for (; levels[count - 1].cells() > 1; ++count) {
    if (levels.size() == count) levels.emplace_back();
    std::array<Axis, 3> coarse = coarsen(levels[count - 1].axis);
    rasterise(levels[count], std::move(coarse), false);
  }
  levels.resize(count);
  for (Level& l : levels) fill_lanes(l);
  fill_empty_d(levels[0]);
}

/// The blocks of data of the finest level, and what each slice found in them.
std::vector<SliceOutcome> fill_finest(Level& finest, const Image& map, const DataTerm& term) {
  const std::size_t slices = finest.nz();
  std::vector<SliceOutcome> outcomes(slices);
  std::vector<std::int32_t> first(slices + 1);
  const auto each_slice = [&](auto body) {
    const std::size_t grain = std::max<std::size_t>(1, (std::size_t{1} << 14) * slices / finest.cells());
    parallel_for(slices, grain, [&](std::size_t begin, std::size_t end) {
      const detail::FlushDenormals flush;
      for (std::size_t k = begin; k < end; ++k) body(k);
    });
  };
  each_slice([&](std::size_t k) {
    detail::with_native_vectors(
        [&]<int native>() DYNASURF_INLINE_LAMBDA { number_blocks<Floats<native>>(finest, map, k, outcomes[k]); });
  });
  for (std::size_t k = 0; k < slices; ++k) first[k + 1] = first[k] + outcomes[k].blocks;
  finest.data = box_around(outcomes);
  finest.data_rows.resize(slices);
  for (std::size_t k = 0; k < slices; ++k) finest.data_rows[k] = {outcomes[k].first_row, outcomes[k].end_row};
  make_room_for_blocks(finest, first[slices]);
  each_slice([&](std::size_t k) {
    detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
      fill_blocks<Floats<native>>(finest, map, k, first[k], term, outcomes[k]);
    });
  });
  return outcomes;
}

}  // namespace

DataStrength build(std::vector<Level>& levels, const Image& map, const Vec3& rates, const DataTerm& term) {
  shape_levels(levels, map.grid, rates);
  SliceOutcome all;
  for (const SliceOutcome& o : fill_finest(levels[0], map, term))
    all = {.largest_b = std::max(all.largest_b, o.largest_b),
           .sum_b = all.sum_b + o.sum_b,
           .largest_bits = std::max(all.largest_bits, o.largest_bits)};
  if (all.largest_bits >= 0x7f800000 || !std::isfinite(all.largest_b)) detail::check_edge_map(map);  // names the place
  if (all.largest_b == 0) return {};

  for (std::size_t l = 1; l < levels.size(); ++l) {
    Level& g = levels[l];
    const std::size_t coarse_grain = std::max<std::size_t>(1, (std::size_t{1} << 12) * g.nz() / g.cells());
    parallel_for(g.nz(), coarse_grain, [&](std::size_t begin, std::size_t end) {
      const detail::FlushDenormals flush;
      for (std::size_t k = begin; k < end; ++k) coarsen_slice(levels[l - 1], g, k);
    });
  }
  return {all.largest_b, all.sum_b / levels[0].cells()};
}

}  // namespace dynasurf::field::multigrid
