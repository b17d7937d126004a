#pragma once
#include <algorithm>

#include "dynasurf/field/multigrid/detail/view.hpp"

namespace dynasurf::field::multigrid {

/// Sum of all lanes, in an order that does not depend on the machine.
template <class V>
DYNASURF_INLINE double sum_of(V v) {
  float lane[lanes];
  store(lane, v);
  double pairs[8];
  for (int i = 0; i < 8; ++i) pairs[i] = lane[i] + static_cast<double>(lane[i + 8]);
  return ((pairs[0] + pairs[4]) + (pairs[1] + pairs[5])) + ((pairs[2] + pairs[6]) + (pairs[3] + pairs[7]));
}

/// Sums of squares of what a sweep changed and of what it left.
template <class V>
struct Measure {
  V change{}, size{};

  /// Unused lanes, whose d is 0, do not count.
  DYNASURF_INLINE void add(V before, V after, V d, bool all_used) {
    V step = after - before, kept = after;
    if (!all_used) step = where_greater(d, V{}, step, V{}), kept = where_greater(d, V{}, kept, V{});
    change += step * step;
    size += kept * kept;
  }
};

/// New values of one colour of a row, from the values of their neighbours. Old values are not read. A value is computed
/// as the neighbour `near` plus a difference, which keeps the rounding small. Unused lanes, whose d is 0, copy `near`.
template <class V, Start start, bool finest>
DYNASURF_INLINE void sweep_row(const View& v, int j, int k, int colour, Measure<V>& measure) {
  const int half = half_of(colour, j, k);
  const Row r = row_of(v, j, k, half);
  const Rates rates = rates_of<finest>(v, j, k);
  const float *empty_d = nullptr, *rhs = nullptr, *b = nullptr, *d = nullptr;
  const std::int32_t* block_of = nullptr;
  if constexpr (finest) {
    empty_d = v.empty_d_of(j, k, half);
    block_of = v.blocks_of(j, k, half);
  } else {
    rhs = v.rhs + v.row(j, k) + half * v.slot;
    b = v.b + v.scalar_row(j, k) + half * v.slot;
    d = v.d + v.scalar_row(j, k) + half * v.slot;
  }
  const float* towards_far = half == 0 ? v.lane_left(0) : v.lane_right(1);
  for (int m = 0; m < end_of<V>(v.slot); m += V::count) {
    const V kx = load<V>(towards_far + m);
    const float* data = nullptr;
    if constexpr (finest) {
      const std::int32_t number = block_of[m / lanes];
      if (start == Start::near_data && number < 0) continue;
      if (number >= 0) data = v.block(number);
    }
    const V dm = load<V>(!finest ? d + m : data != nullptr ? data : empty_d + m);
    for (int c = 0; c < 3; ++c) {
      const Index at = 2 * c * v.slot + m;
      const Around<V> n = around<V>(r, at);
      V flow = inflow<finest>(n, kx, rates);
      if constexpr (finest) {
        if (data != nullptr) flow += load<V>(data + 16) * (load<V>(data + 32 + 16 * c) - n.near);
      } else {
        flow += load<V>(rhs + at) - load<V>(b + m) * n.near;
      }
      const V next = n.near + dm * flow;
      if constexpr (start == Start::measured) measure.add(load<V>(r.own + at), next, dm, false);
      store(r.own + at, next);
    }
  }
}

template <class V, int first, int usual_slot, bool measured>
DYNASURF_INLINE void sweep_finest_tile(const View& v, int j, int k, Measure<V>& measure) {
  const Tile<V, first, usual_slot> t(v, j, k);
  const Rates rates = rates_of<true>(v, j, k);
  const int chunks = static_cast<int>(t.slot) / lanes;
  const std::int32_t* block_of[2] = {v.block_of + v.row_number(j, k) * 2 * chunks,
                                     v.block_of + v.row_number(j, k + 1) * 2 * chunks};
  const float* empty_d[4];
  for (int r = 0; r < 4; ++r) empty_d[r] = v.empty_d_of(j + r % 2, k + r / 2, t.half(r));
  for (int m = 0; m < end_of<V>(t.slot); m += V::count) {
    const V kx[2] = {load<V>(v.lane_values + m), load<V>(v.lane_values + 3 * t.slot + m)};
    const bool all_used = 2 * (m + lanes) <= v.nx;
    const float* data[4];
    V d[4];
    for (int r = 0; r < 4; ++r) {
      const std::int32_t number = block_of[r / 2][(r % 2 * 2 + t.half(r)) * chunks + m / lanes];
      data[r] = number < 0 ? nullptr : v.block(number);
      d[r] = load<V>(number < 0 ? empty_d[r] + m : data[r]);
    }
    for (int c = 0; c < 3; ++c) {
      const Index at = 2 * c * t.slot + m;
      t.each_row(at, [&](auto r, const Around<V>& n) DYNASURF_INLINE_LAMBDA {
        V flow = inflow<true>(n, kx[t.half(r)], rates);
        if (data[r] != nullptr) flow += load<V>(data[r] + 16) * (load<V>(data[r] + 32 + 16 * c) - n.near);
        const V next = n.near + d[r] * flow;
        if constexpr (measured) measure.add(load<V>(t.own(r) + at), next, d[r], all_used);
        store(t.own(r) + at, next);
      });
    }
  }
}

template <class V, int first, int usual_slot>
DYNASURF_INLINE void sweep_coarse_tile(const View& v, int j, int k) {
  const Tile<V, first, usual_slot> t(v, j, k);
  const Index scalars = 2 * t.slot * v.row_number(j, k), slice = 2 * t.slot * v.ny;
  const float *rhs0 = v.rhs + lanes + 3 * scalars, *rhs1 = rhs0 + 3 * slice;
  const float *b0 = v.b + scalars, *b1 = b0 + slice, *d0 = v.d + scalars, *d1 = d0 + slice;
  const float ym[2] = {v.left[1][j], v.left[1][j + 1]}, yp[2] = {v.right[1][j], v.right[1][j + 1]};
  const float zm[2] = {v.left[2][k], v.left[2][k + 1]}, zp[2] = {v.right[2][k], v.right[2][k + 1]};
  for (int m = 0; m < end_of<V>(t.slot); m += V::count) {
    const V kx[2] = {load<V>(v.lane_values + m), load<V>(v.lane_values + 3 * t.slot + m)};
    V b[4], d[4];
    for (int r = 0; r < 4; ++r) {
      const Index at = (r % 2 * 2 + t.half(r)) * t.slot + m;
      b[r] = load<V>((r < 2 ? b0 : b1) + at);
      d[r] = load<V>((r < 2 ? d0 : d1) + at);
    }
    for (int c = 0; c < 3; ++c) {
      const Index at = 2 * c * t.slot + m;
      t.each_row(at, [&](auto r, const Around<V>& n) DYNASURF_INLINE_LAMBDA {
        const V rhs = load<V>((r < 2 ? rhs0 : rhs1) + (r % 2 * 6 + t.half(r)) * t.slot + at);
        const Rates rates{ym[r % 2], yp[r % 2], zm[r / 2], zp[r / 2]};
        const V flow = (rhs - b[r] * n.near) + inflow<false>(n, kx[t.half(r)], rates);
        store(t.own(r) + at, n.near + d[r] * flow);
      });
    }
  }
}

/// Pairs of the rows [j0, j1) in the slices k and k+1.
template <class V, bool finest, bool measured, int first, int usual_slot>
DYNASURF_INLINE void sweep_tiles(const View& v, int k, int j0, int j1, Measure<V>& measure) {
  for (int j = j0; j + 1 < j1; j += 2)
    finest ? sweep_finest_tile<V, first, usual_slot, measured>(v, j, k, measure)
           : sweep_coarse_tile<V, first, usual_slot>(v, j, k);
}

/// All of u counts as 0.
template <class V>
DYNASURF_INLINE void start_row(const View& v, int j, int k, int half) {
  float* own = v.u + v.row(j, k) + half * v.slot;
  const float* rhs = v.rhs + v.row(j, k) + half * v.slot;
  const float* d = v.d + v.scalar_row(j, k) + half * v.slot;
  for (int m = 0; m < end_of<V>(v.slot); m += V::count)
    for (int c = 0; c < 3; ++c) store(own + 2 * c * v.slot + m, load<V>(d + m) * load<V>(rhs + 2 * c * v.slot + m));
}

DYNASURF_INLINE bool has_data(const View& v, int j, int k, int half) {
  const std::int32_t* blocks = v.blocks_of(j, k, half);
  return std::any_of(blocks, blocks + v.slot / lanes, [](std::int32_t number) { return number >= 0; });
}

/// Row by row.
template <class V, Start start, bool finest>
DYNASURF_INLINE void sweep_rows(const View& v, int k0, int k1, int j0, int j1, int colour, Measure<V>& measure) {
  for (int k = k0; k < k1; ++k)
    for (int j = j0; j < j1; ++j) {
      const int half = half_of(colour, j, k);
      if (start == Start::near_data && !has_data(v, j, k, half)) continue;
      if constexpr (start == Start::from_rhs)
        start_row<V>(v, j, k, half);
      else
        sweep_row<V, start, finest>(v, j, k, colour, measure);
    }
}

/// In tiles, and row by row what is left of an odd number of rows or slices.
template <class V, Start start, bool finest>
DYNASURF_INLINE void sweep_in_tiles(const View& v, int k0, int k1, int j0, int j1, int colour, Measure<V>& measure) {
  const int j_end = j1 - (j1 - j0) % 2, k_end = k1 - (k1 - k0) % 2;
  for (int k = k0; k < k_end; k += 2)
    with_usual_slot<V>(v.slot, [&](auto slot) DYNASURF_INLINE_LAMBDA {
      half_of(colour, j0, k) == 0 ? sweep_tiles<V, finest, start == Start::measured, 0, slot>(v, k, j0, j1, measure)
                                  : sweep_tiles<V, finest, start == Start::measured, 1, slot>(v, k, j0, j1, measure);
    });
  // In a loop, so that its body is compiled once.
  const int rest[2][4] = {{k0, k_end, j_end, j1}, {k_end, k1, j0, j1}};
  for (const auto& r : rest) sweep_rows<V, start, finest>(v, r[0], r[1], r[2], r[3], colour, measure);
}

/// `sweep` of the finest level, compiled apart: the copies for each kind of processor take long.
void sweep_finest(Level& l, int k0, int k1, int j0, int j1, int colour, Start start);

}  // namespace dynasurf::field::multigrid
