#pragma once
#include <algorithm>
#include <cstdint>

#include "dynasurf/field/multigrid/detail/scratch.hpp"
#include "dynasurf/field/multigrid/detail/view.hpp"

namespace dynasurf::field::multigrid {

/// Rows of the coarser level for a slice of the finer one, interpolated along z and x: the last four asked for.
template <class V, bool joined, int usual_slot>
class Interpolated {
 public:
  DYNASURF_INLINE Interpolated(const View& fine, const View& coarse, int k)
      : fine_slot_(usual_slot > 0 ? usual_slot : fine.slot),
        slot_(usual_slot == 0 ? coarse.slot
              : joined        ? std::max(usual_slot / 2, lanes)
                              : usual_slot),
        end_(coarse.nx - 1),
        rows_(scratch(24 * fine_slot_)) {
    const int own = fine.halved[2] ? k / 2 : k;
    const int next = fine.halved[2] ? std::clamp(own + (k % 2 == 0 ? -1 : 1), 0, coarse.nz - 1) : own;
    own_ = coarse.u + lanes + 6 * slot_ * coarse.row_number(0, own);
    next_ = coarse.u + lanes + 6 * slot_ * coarse.row_number(0, next);
  }

  /// As the finer level's rows: two halves of each component.
  DYNASURF_INLINE const float* row(int j) {
    float* out = rows_ + 6 * fine_slot_ * (j & 3);
    if (held_[j & 3] == j) return out;
    held_[j & 3] = j;
    const float *p = own_ + 6 * slot_ * j, *q = next_ + 6 * slot_ * j;
    const auto between = [&](Index at)
                             DYNASURF_INLINE_LAMBDA { return 0.75f * load<V>(p + at) + 0.25f * load<V>(q + at); };
    for (int c = 0; c < 3; ++c) {
      float* to = out + 2 * c * fine_slot_;
      const Index from = 2 * c * slot_;
      if constexpr (joined)
        join_halves([&](Index m) DYNASURF_INLINE_LAMBDA { return between(from + m); }, to);
      else
        for (int m = 0; m < 2 * slot_; m += V::count) store(to + m, between(from + m));
    }
    return out;
  }

 private:
  /// A cell of the coarser level lies in its middle between two of the finer one, in the even half and in the odd one
  /// at its own place. Beyond the ends its values go on.
  template <class Values>
  DYNASURF_INLINE void join_halves(const Values& values, float* to) const {
    V v[2], next[2]{};
    join(values(0), values(slot_), v[0], v[1]);
    V before = first_lane(v[0]);
    for (Index m = 0;; m += V::count) {
      const Index after = m + V::count;
      if (after < slot_) join(values(after), values(slot_ + after), next[0], next[1]);
      for (int i : {0, 1}) {
        const Index at = 2 * m + i * V::count;
        if (at >= end_of<V>(fine_slot_)) return;
        const V down = shifted_up(before, v[i]);
        V up = shifted_down(v[i], i == 0 ? v[1] : next[0]);
        if (at + V::count > end_) up = where_equal(lane_numbers<V>(), V(end_ - at), v[i], up);
        store(to + at, 0.75f * v[i] + 0.25f * down);
        store(to + fine_slot_ + at, 0.75f * v[i] + 0.25f * up);
        before = v[i];
      }
      v[0] = next[0], v[1] = next[1];
    }
  }

  Index fine_slot_, slot_, end_;
  const float *own_, *next_;
  float* rows_;
  int held_[4] = {-1, -1, -1, -1};
};

/// Asks for a row that the first stage of a pass will soon need: that stage touches every other half row alone, which
/// the processor does not foresee. For shorter rows it wins nothing.
template <bool finest>
DYNASURF_INLINE void fetch_ahead(const View& v, int j, int k) {
  constexpr int ahead = 2, shortest = 32;
  if (v.slot < shortest || j + ahead >= v.ny) return;
  for (int m = 0; m < 6 * v.slot; m += lanes) {
    __builtin_prefetch(v.u + v.row(j + ahead, k) + m, 1);
    if (!finest) __builtin_prefetch(v.rhs + v.row(j + ahead, k) + m);
  }
  for (int m = 0; !finest && m < 2 * v.slot; m += lanes) {
    __builtin_prefetch(v.b + v.scalar_row(j + ahead, k) + m);
    __builtin_prefetch(v.d + v.scalar_row(j + ahead, k) + m);
  }
}

template <class V, bool finest, bool first, bool joined, int usual_slot, int half>
DYNASURF_INLINE void interpolate_row(const View& f, const View& g, Interpolated<V, joined, usual_slot>& between, int j,
                                     int k) {
  const Index slot = usual_slot > 0 ? usual_slot : f.slot;
  const int own = f.halved[1] ? j / 2 : j;
  const int next = f.halved[1] ? std::clamp(own + (j % 2 == 0 ? -1 : 1), 0, g.ny - 1) : own;
  const float *p = between.row(own) + half * slot, *q = between.row(next) + half * slot;
  const float *diagonal = f.lane_values + (4 + half) * slot, yz = f.yz_diagonal(j, k);
  const Index row = f.row_number(j, k);
  float* u = f.u + lanes + (6 * row + half) * slot;
  const float *rhs = f.rhs + lanes + (6 * row + half) * slot, *d_row = f.d + (2 * row + half) * slot;
  const std::int32_t* block_of = f.block_of + (2 * row + half) * (slot / lanes);
  fetch_ahead<finest>(f, j, k);
  for (int m = 0; m < end_of<V>(slot); m += V::count) {
    const float* data = nullptr;
    if constexpr (finest) {
      const std::int32_t number = block_of[m / lanes];
      if (number >= 0) data = f.block(number);
    }
    V d{}, share{};
    if (!finest || data != nullptr) {
      d = load<V>(finest ? data : d_row + m);
      share = (load<V>(diagonal + m) + yz) * d;
    }
    for (int c = 0; c < 3; ++c) {
      const Index at = 2 * c * slot + m;
      V t = 0.75f * load<V>(p + at) + 0.25f * load<V>(q + at);
      if (!finest || data != nullptr) t *= share;
      if constexpr (first) {
        // One relaxation with the interpolated values as neighbours.
        if (!finest)
          t += d * load<V>(rhs + at);
        else if (data != nullptr)
          t += d * (load<V>(data + 16) * load<V>(data + 32 + 16 * c));
        store(u + at, t);
      } else {
        store(u + at, load<V>(u + at) + f.stretch * t);
      }
    }
  }
}

template <class V, bool finest, bool first, bool joined>
DYNASURF_INLINE void interpolate_rows(const View& f, const View& g, int k0, int k1, int j0, int j1) {
  with_usual_slot<V>(f.slot, [&](auto slot) DYNASURF_INLINE_LAMBDA {
    for (int k = k0; k < k1; ++k) {
      Interpolated<V, joined, slot> between(f, g, k);
      for (int j = j0; j < j1; ++j)
        half_of(1, j, k) == 0 ? interpolate_row<V, finest, first, joined, slot, 0>(f, g, between, j, k)
                              : interpolate_row<V, finest, first, joined, slot, 1>(f, g, between, j, k);
    }
  });
}

template <bool first, bool joined>
void interpolate_joined(const View& f, const View& g, const Level& fine, int k0, int k1, int j0, int j1) {
  if (fine.finest)
    with_whole_vectors([&]<class V>()
                           DYNASURF_INLINE_LAMBDA { interpolate_rows<V, true, first, joined>(f, g, k0, k1, j0, j1); });
  else
    with_vectors_for(fine, [&]<class V>() DYNASURF_INLINE_LAMBDA {
      interpolate_rows<V, false, first, joined>(f, g, k0, k1, j0, j1);
    });
}

template <bool first>
void interpolate(const Level& fine, const Level& coarse, float stretch, int k0, int k1, int j0, int j1) {
  View f(fine);
  const View g(coarse);
  f.stretch = stretch;
  f.halved[0] ? interpolate_joined<first, true>(f, g, fine, k0, k1, j0, j1)
              : interpolate_joined<first, false>(f, g, fine, k0, k1, j0, j1);
}

}  // namespace dynasurf::field::multigrid
