#include "dynasurf/field/multigrid/detail/coarsen.hpp"

#include <algorithm>

namespace dynasurf::field::multigrid {
namespace {

/// A row of the finest level and where its neighbours are: what coarsening asks for again and again.
struct DataRow {
  const std::int32_t* numbers;           // of the blocks: two halves
  Index ym, yp, zm, zp;                  // from those to the neighbours'; beyond a wall is the row itself
  float yz, yz_ym, yz_yp, yz_zm, yz_zp;  // D without the part along i
  Rates rates;
};
DYNASURF_INLINE DataRow data_row(const View& l, int j, int k) {
  const Index row = 2 * (l.slot / lanes), slice = row * l.ny;
  const bool ym = j > 0, yp = j + 1 < l.ny, zm = k > 0, zp = k + 1 < l.nz;
  return {l.blocks_of(j, k, 0),
          ym ? -row : 0,
          yp ? row : 0,
          zm ? -slice : 0,
          zp ? slice : 0,
          l.yz_diagonal(j, k),
          l.yz_diagonal(j - ym, k),
          l.yz_diagonal(j + yp, k),
          l.yz_diagonal(j, k - zm),
          l.yz_diagonal(j, k + zp),
          rates_of<false>(l, j, k)};
}

/// s = D/(D+b) of 16 voxels, the share of a voxel that diffusion rules; 1 where there are no data.
template <class V>
DYNASURF_INLINE V freedom(const View& l, std::int32_t number, V diagonal) {
  const V s = diagonal * load<V>(l.block(std::max(number, 0)));
  return where_greater(V{}, V(number), V(1), s);
}

/// How much of its data term a voxel shows to the coarser level. Alone among free voxels it would follow them by s, and
/// show s b; voxels inside a thick or strong border are held by their neighbours too, and show less.
template <class V, int half>
DYNASURF_INLINE V shown(const View& l, const DataRow& r, int m, V d, V s) {
  const int chunks = l.slot / lanes;
  const std::int32_t *own = r.numbers + half * chunks + m / lanes, *other = r.numbers + (1 - half) * chunks + m / lanes;
  const V along = load<V>(l.lane_diagonal(half) + m);
  const float* along_other = l.lane_diagonal(1 - half) + m;
  constexpr int step = half == 0 ? -1 : 1;
  const bool ends = half == 0 ? m == 0 : m + lanes == l.slot;
  const V near = freedom<V>(l, *other, load<V>(along_other) + r.yz);
  const V next = ends ? V(1) : freedom(l, other[step], load<V>(along_other + step * lanes) + r.yz);
  V flow = half == 0 ? load<V>(l.lane_left(0) + m) * shifted_up(next, near) + load<V>(l.lane_right(0) + m) * near
                     : load<V>(l.lane_left(1) + m) * near + load<V>(l.lane_right(1) + m) * shifted_down(near, next);
  flow += r.rates.ym * freedom(l, own[r.ym], along + r.yz_ym);
  flow += r.rates.yp * freedom(l, own[r.yp], along + r.yz_yp);
  flow += r.rates.zm * freedom(l, own[r.zm], along + r.yz_zm);
  flow += r.rates.zp * freedom(l, own[r.zp], along + r.yz_zp);
  const V held = 0.3f + s;  // as measured on borders of all strengths
  return held * (d * flow) + (1 - held) * s;
}

/// What a coarser level gets from the level above: b and the right-hand side of 16 cells.
template <class V>
struct CoarseData {
  V b{}, rhs[3]{};
};

/// Adds the data of 16 cells of row (j, k) to the coarser ones: the data term as far as it shows, and the right-hand
/// side weighed with s. A thin strong shell would otherwise hold the whole coarse cell fast.
template <class V, bool finest, int half>
DYNASURF_INLINE void add_data(const View& l, int j, int k, const DataRow& r, int m, float area, CoarseData<V>& sum) {
  const float* data = nullptr;
  if constexpr (finest) {
    const std::int32_t number = r.numbers[(half * l.slot + m) / lanes];
    if (number < 0) return;
    data = l.block(number);
  }
  const Index scalars = l.scalar_row(j, k) + half * l.slot + m;
  const float yz = finest ? r.yz : l.yz_diagonal(j, k);
  const V d = load<V>(finest ? data : l.d + scalars), b = load<V>(finest ? data + 16 : l.b + scalars);
  const V part = area * load<V>(l.lane_share(half) + m), s = (load<V>(l.lane_diagonal(half) + m) + yz) * d;
  if constexpr (finest)
    sum.b += part * b * shown<V, half>(l, r, m, d, s);
  else
    sum.b += part * b * s;
  for (int c = 0; c < 3; ++c) {
    const V rhs = finest ? b * load<V>(data + 32 + 16 * c) : load<V>(l.rhs + l.row(j, k) + (2 * c + half) * l.slot + m);
    sum.rhs[c] += part * s * rhs;
  }
}

/// The rows that row j of slice k of the coarser level joins.
struct JoinedRows {
  int count;
  struct {
    int j, k;
    float area;
    DataRow data;
  } row[4];
};

template <bool finest>
DYNASURF_INLINE JoinedRows joined_rows(const View& f, int j, int k) {
  const auto children = [](bool joined, int count, int i) {
    return joined ? std::pair{2 * i, std::min(2 * i + 1, count - 1)} : std::pair{i, i};
  };
  const auto [z0, z1] = children(f.halved[2], f.nz, k);
  const auto [y0, y1] = children(f.halved[1], f.ny, j);
  JoinedRows joined;
  joined.count = 0;
  for (int z = z0; z <= z1; ++z)
    for (int y = y0; y <= y1; ++y) {
      if (finest) {
        const std::int32_t* numbers = f.blocks_of(y, z, 0);
        if (std::all_of(numbers, numbers + 2 * (f.slot / lanes), [](std::int32_t n) { return n < 0; })) continue;
      }
      auto& r = joined.row[joined.count++];
      r.j = y, r.k = z, r.area = f.share[1][y] * f.share[2][z];
      if (finest) r.data = data_row(f, y, z);
    }
  return joined;
}

template <class V, bool finest>
DYNASURF_INLINE void coarsen_rows(const View& f, const View& g, int k) {
  for (int j = 0; j < g.ny; ++j) {
    const JoinedRows joined = joined_rows<finest>(f, j, k);
    float *b_row = g.b + g.scalar_row(j, k), *d_row = g.d + g.scalar_row(j, k), *rhs_row = g.rhs + g.row(j, k);
    const float yz = g.yz_diagonal(j, k);
    for (int m = 0; m < g.slot; m += lanes) {
      const auto sum_of = [&](int from, bool even, bool odd) DYNASURF_INLINE_LAMBDA {
        CoarseData<V> sum;
        for (int n = 0; n < joined.count; ++n) {
          const auto& r = joined.row[n];
          if (even) add_data<V, finest, 0>(f, r.j, r.k, r.data, from, r.area, sum);
          if (odd) add_data<V, finest, 1>(f, r.j, r.k, r.data, from, r.area, sum);
        }
        return sum;
      };
      CoarseData<V> sum[2];
      if (f.halved[0]) {
        sum[0] = sum_of(2 * m, true, true);
        if (2 * m + lanes < f.slot) sum[1] = sum_of(2 * m + lanes, true, true);
      } else {
        sum[0] = sum_of(m, true, false);
        sum[1] = sum_of(m, false, true);
      }
      if (f.halved[0]) {
        split(sum[0].b, sum[1].b, sum[0].b, sum[1].b);
        for (int c = 0; c < 3; ++c) split(sum[0].rhs[c], sum[1].rhs[c], sum[0].rhs[c], sum[1].rhs[c]);
      }
      for (int half : {0, 1}) {
        const V diagonal = sum[half].b + (load<V>(g.lane_diagonal(half) + m) + yz);
        store(b_row + half * g.slot + m, sum[half].b);
        store(d_row + half * g.slot + m, inverse(diagonal, load<V>(g.lane_share(half) + m)));
        for (int c = 0; c < 3; ++c) store(rhs_row + (2 * c + half) * g.slot + m, sum[half].rhs[c]);
      }
    }
  }
}

}  // namespace

void coarsen_slice(const Level& f, const Level& g, int k) {
  detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    f.finest ? coarsen_rows<Floats<native>, true>(View(f), View(g), k)
             : coarsen_rows<Floats<native>, false>(View(f), View(g), k);
  });
}

}  // namespace dynasurf::field::multigrid
