#include <algorithm>
#include <cstdint>

#include "dynasurf/field/multigrid/detail/view.hpp"

namespace dynasurf::field::multigrid {

namespace {

/// Memory for a few rows, kept by the thread.
float* scratch(std::size_t count) {
  thread_local detail::FloatBuffer buffer;
  if (buffer.size() < count) buffer = detail::FloatBuffer(count);
  return buffer.data();
}

/// Adds to `sum` what the red cells of a row pass to the coarser level: D times the change that their next sweep would
/// make. With s = D/(D+b), the share of a cell that diffusion rules, this is s times the residual: a cell that the data
/// hold fast does not speak for its neighbourhood. `area` is the row's share in the coarser cell.
template <class V, bool finest>
DYNASURF_INLINE void add_residual(const View& l, int j, int k, float area, float* sum, int sum_step) {
  const int half = half_of(0, j, k);
  const Row r = row_of(l, j, k, half);
  const Rates rates = rates_of<finest>(l, j, k);
  const float* towards_far = half == 0 ? l.lane_left(0) : l.lane_right(1);
  const float *diagonal = l.lane_diagonal(half), *share = l.lane_share(half);
  const float yz = l.yz_diagonal(j, k);
  for (int m = 0; m < end_of<V>(l.slot); m += V::count) {
    const V kx = load<V>(towards_far + m), weight = area * load<V>(share + m);
    const V spread = (load<V>(diagonal + m) + yz) * weight;
    const std::int32_t number = finest ? l.blocks_of(j, k, half)[m / lanes] : 0;
    const float* data = finest ? l.block(std::max(number, 0)) : nullptr;
    for (int c = 0; c < 3; ++c) {
      const std::ptrdiff_t at = 2 * c * l.slot + m;
      const Around<V> n = around<V>(r, at);
      const V step = n.near - load<V>(r.own + at);
      V flow = inflow<finest>(n, kx, rates);
      if constexpr (finest) {
        if (number < 0)
          flow = spread * step + weight * flow;  // D d is 1 where there are no data
        else
          flow = spread * (step + load<V>(data) * (load<V>(data + 16) * (load<V>(data + 32 + 16 * c) - n.near) + flow));
      } else {
        const float* rhs = l.rhs + l.row(j, k) + half * l.slot;
        const std::ptrdiff_t scalars = l.scalar_row(j, k) + half * l.slot + m;
        flow =
            spread * (step + load<V>(l.d + scalars) * ((load<V>(rhs + at) - load<V>(l.b + scalars) * n.near) + flow));
      }
      store(sum + c * sum_step + m, load<V>(sum + c * sum_step + m) + flow);
    }
  }
}

/// Cells of an axis that a coarser cell holds: [first, last].
struct Children {
  int first, last;
};
DYNASURF_INLINE Children children_of(bool halved, int count, int i) {
  return halved ? Children{2 * i, std::min(2 * i + 1, count - 1)} : Children{i, i};
}

/// The same of the rows j and j+1 of the slices k and k+1, joined along x and y: into `sum[0]`, or into one per slice.
/// What the sums held before is forgotten.
template <class V, bool finest, int first, int usual_slot>
DYNASURF_INLINE void sum_residuals(const View& l, int j, int k, float* const (&sum)[2], int sum_step) {
  const Tile<V, first, usual_slot> t(l, j, k);
  const bool together = sum[0] == sum[1];
  const int chunks = static_cast<int>(t.slot) / lanes;
  const std::ptrdiff_t scalars = 2 * t.slot * l.row_number(j, k), slice = 2 * t.slot * l.ny;
  const float *rhs0 = l.rhs + lanes + 3 * scalars, *rhs1 = rhs0 + 3 * slice;
  const float *b0 = l.b + scalars, *b1 = b0 + slice, *d0 = l.d + scalars, *d1 = d0 + slice;
  // In an array: gcc 12 takes a wrong element of `(r < 2 ? p : q)[i / lanes]` where it looks for undefined behaviour.
  const std::int32_t* const numbers[2] = {l.block_of + scalars / lanes, l.block_of + (scalars + slice) / lanes};
  Rates rates[4];
  float area[4], yz[4];
  for (int r = 0; r < 4; ++r) {
    rates[r] = rates_of<finest>(l, j + r % 2, k + r / 2);
    area[r] = l.share[1][j + r % 2] * l.share[2][k + r / 2];
    yz[r] = l.yz_diagonal(j + r % 2, k + r / 2);
  }
  for (int m = 0; m < end_of<V>(t.slot); m += V::count) {
    const auto lane = [&](int kind, int half)
                          DYNASURF_INLINE_LAMBDA { return load<V>(l.lane_values + (2 * kind + half) * t.slot + m); };
    const V kx[2] = {lane(0, 0), lane(1, 1)};
    const V diagonal[2] = {lane(2, 0), lane(2, 1)}, share[2] = {lane(3, 0), lane(3, 1)};
    const float* data[4] = {};
    if constexpr (finest)
      for (int r = 0; r < 4; ++r) {
        const std::int32_t number = numbers[r / 2][(r % 2 * 2 + t.half(r)) * chunks + m / lanes];
        if (number >= 0) data[r] = l.block(number);
      }
    for (int c = 0; c < 3; ++c) {
      const std::ptrdiff_t at = 2 * c * t.slot + m;
      V passed[2] = {};
      t.each_row(at, [&](auto r, const Around<V>& n) DYNASURF_INLINE_LAMBDA {
        constexpr int half = t.half(r);
        const V step = n.near - load<V>(t.own(r) + at), spread = diagonal[half] + yz[r];
        V flow = inflow<finest>(n, kx[half], rates[r]);
        if constexpr (finest) {
          if (data[r] == nullptr)
            flow = spread * step + flow;  // D d is 1 where there are no data
          else
            flow = spread * (step + load<V>(data[r]) *
                                        (load<V>(data[r] + 16) * (load<V>(data[r] + 32 + 16 * c) - n.near) + flow));
        } else {
          const std::ptrdiff_t scalar = (r % 2 * 2 + half) * t.slot + m;
          const V rhs = load<V>((r < 2 ? rhs0 : rhs1) + (r % 2 * 6 + half) * t.slot + at);
          const V b = load<V>((r < 2 ? b0 : b1) + scalar), dm = load<V>((r < 2 ? d0 : d1) + scalar);
          flow = spread * (step + dm * ((rhs - b * n.near) + flow));
        }
        passed[r / 2] += (area[r] * share[half]) * flow;
      });
      const std::ptrdiff_t to = c * sum_step + m;
      store(sum[0] + to, together ? passed[0] + passed[1] : passed[0]);
      if (!together) store(sum[1] + to, passed[1]);
    }
  }
}

/// Right-hand side of a row from sums in natural order.
template <class V>
DYNASURF_INLINE void split_row(const View& g, int j, int k, const float* sum, int step) {
  float* rhs = g.rhs + g.row(j, k);
  for (int c = 0; c < 3; ++c)
    for (int m = 0; m < end_of<V>(g.slot); m += V::count) {
      V even, odd;
      const float* from = sum + c * step + 2 * m;
      split(load<V>(from), load<V>(from + V::count), even, odd);
      store(rhs + 2 * c * g.slot + m, even);
      store(rhs + (2 * c + 1) * g.slot + m, odd);
    }
}

template <class V, bool finest>
DYNASURF_INLINE void restrict_row(const View& f, const View& g, int j, int k) {
  // Sums over pairs along x lie in natural order and are split at the end; without pairs they lie split already.
  const bool joined = f.halved[0];
  const int step = joined ? std::max(f.slot, 2 * g.slot) : 2 * f.slot;
  float* sum = scratch(3 * step);
  std::fill_n(sum, 3 * step, 0.0f);
  const Children rows = children_of(f.halved[1], f.ny, j), slices = children_of(f.halved[2], f.nz, k);
  for (int z = slices.first; z <= slices.last; ++z)
    for (int y = rows.first; y <= rows.last; ++y) {
      const float area = f.share[1][y] * f.share[2][z];
      add_residual<V, finest>(f, y, z, area, joined ? sum : sum + half_of(0, y, z) * f.slot, step);
    }
  if (joined) return split_row<V>(g, j, k, sum, step);
  for (int c = 0; c < 3; ++c) std::copy_n(sum + c * step, 2 * f.slot, g.rhs + g.row(j, k) + 2 * c * g.slot);
}

/// The rows [j0, j1) of slice k, or of k and k+1 where slices are not joined, from pairs of rows and slices.
template <class V, bool finest, int first, int usual_slot>
DYNASURF_INLINE void restrict_pairs(const View& f, const View& g, int k, int j0, int j1) {
  const int step = std::max(f.slot, 2 * g.slot);
  float* both = scratch(6 * step);
  std::fill_n(both, 6 * step, 0.0f);
  float* const sum[2] = {both, f.halved[2] ? both : both + 3 * step};
  for (int j = j0; j < j1; ++j) {
    sum_residuals<V, finest, first, usual_slot>(f, 2 * j, f.halved[2] ? 2 * k : k, sum, step);
    split_row<V>(g, j, k, sum[0], step);
    if (!f.halved[2]) split_row<V>(g, j, k + 1, sum[1], step);
  }
}

template <class V, bool finest>
DYNASURF_INLINE void restrict_rows(const View& f, const View& g, int k0, int k1, int j0, int j1) {
  for (int k = k0; k < k1;) {
    const bool in_pairs = f.halved[0] && f.halved[1] && (f.halved[2] ? 2 * k + 1 < f.nz : k + 1 < k1);
    const int last = in_pairs ? std::min(j1, f.ny / 2) : j0, next = in_pairs && !f.halved[2] ? k + 2 : k + 1;
    if (in_pairs)
      with_usual_slot<V>(f.slot, [&](auto slot) DYNASURF_INLINE_LAMBDA {
        f.halved[2] || k % 2 == 0 ? restrict_pairs<V, finest, 0, slot>(f, g, k, j0, last)
                                  : restrict_pairs<V, finest, 1, slot>(f, g, k, j0, last);
      });
    for (; k < next; ++k)
      for (int j = last; j < j1; ++j) restrict_row<V, finest>(f, g, j, k);
  }
}

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
        rows_(scratch(24 * static_cast<std::size_t>(fine_slot_))) {
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
    const auto between = [&](std::ptrdiff_t at)
                             DYNASURF_INLINE_LAMBDA { return 0.75f * load<V>(p + at) + 0.25f * load<V>(q + at); };
    for (int c = 0; c < 3; ++c) {
      float* to = out + 2 * c * fine_slot_;
      const std::ptrdiff_t from = 2 * c * slot_;
      if constexpr (joined)
        join_halves([&](std::ptrdiff_t m) DYNASURF_INLINE_LAMBDA { return between(from + m); }, to);
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
    for (std::ptrdiff_t m = 0;; m += V::count) {
      const std::ptrdiff_t after = m + V::count;
      if (after < slot_) join(values(after), values(slot_ + after), next[0], next[1]);
      for (int i : {0, 1}) {
        const std::ptrdiff_t at = 2 * m + i * V::count;
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

  std::ptrdiff_t fine_slot_, slot_, end_;
  const float *own_, *next_;
  float* rows_;
  int held_[4] = {-1, -1, -1, -1};
};

/// Asks for a row that the first stage of a pass will soon need: that stage touches every other half row alone, which
/// the processor does not foresee. Smaller levels are in the cache.
template <bool finest>
DYNASURF_INLINE void fetch_ahead(const View& v, int j, int k) {
  constexpr int ahead = 2, short_row = 64;
  if (v.slot < short_row || j + ahead >= v.ny) return;
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
  const std::ptrdiff_t slot = usual_slot > 0 ? usual_slot : f.slot;
  const int own = f.halved[1] ? j / 2 : j;
  const int next = f.halved[1] ? std::clamp(own + (j % 2 == 0 ? -1 : 1), 0, g.ny - 1) : own;
  const float *p = between.row(own) + half * slot, *q = between.row(next) + half * slot;
  const float *diagonal = f.lane_values + (4 + half) * slot, yz = f.yz_diagonal(j, k);
  const std::ptrdiff_t row = f.row_number(j, k);
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
      const std::ptrdiff_t at = 2 * c * slot + m;
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

}  // namespace

void restrict_residual(Level& fine, Level& coarse, int k0, int k1, int j0, int j1) {
  const View f(fine), g(coarse);
  if (fine.finest)
    with_whole_vectors([&]<class V>() DYNASURF_INLINE_LAMBDA { restrict_rows<V, true>(f, g, k0, k1, j0, j1); });
  else
    with_vectors_for(fine, [&]<class V>() DYNASURF_INLINE_LAMBDA { restrict_rows<V, false>(f, g, k0, k1, j0, j1); });
}

void correct_black(Level& fine, const Level& coarse, float stretch, int k0, int k1, int j0, int j1) {
  interpolate<false>(fine, coarse, stretch, k0, k1, j0, j1);
}

void start_black(Level& fine, const Level& coarse, int k0, int k1, int j0, int j1) {
  interpolate<true>(fine, coarse, 1, k0, k1, j0, j1);
}

namespace {

template <class V, bool past_caches>
DYNASURF_INLINE void copy_row(const float* even, const float* odd, int count, float* out) {
  const auto put = [](V a, V b, float* to) DYNASURF_INLINE_LAMBDA {
    V first, second;
    join(a, b, first, second);
    past_caches ? stream(to, first) : store(to, first);
    past_caches ? stream(to + lanes, second) : store(to + lanes, second);
  };
  int i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) put(load<V>(even + i / 2), load<V>(odd + i / 2), out + i);
  if (i == count) return;
  if (i > 0) {  // the last whole vectors overlap those before
    i = count - 2 * lanes;
    i % 2 == 0 ? put(load<V>(even + i / 2), load<V>(odd + i / 2), out + i)
               : put(load<V>(odd + i / 2), load<V>(even + i / 2 + 1), out + i);
    return;
  }
  float rest[2 * lanes];
  V first, second;
  join(load<V>(even), load<V>(odd), first, second);
  store(rest, first);
  store(rest + lanes, second);
  std::copy_n(rest, count, out);
}

template <class V, bool past_caches>
DYNASURF_INLINE void copy_rows(const View& v, int k, int j0, int j1, const std::array<float*, 3>& out) {
  for (int j = j0; j < j1; ++j)
    for (int c = 0; c < 3; ++c) {
      const float* even = v.u + v.row(j, k) + 2 * c * v.slot;
      copy_row<V, past_caches>(even, even + v.slot, v.nx, out[c] + v.row_number(j, k) * v.nx);
    }
}

}  // namespace

void copy_out(const Level& l, int k, int j0, int j1, std::array<float*, 3> out) {
  constexpr std::size_t too_large_for_caches = 1'000'000;
  const bool aligned = l.nx() % 4 == 0 && std::all_of(out.begin(), out.end(), [](const float* p) {
                         return reinterpret_cast<std::uintptr_t>(p) % 16 == 0;
                       });
  const bool past_caches = l.cells() >= too_large_for_caches && aligned;
  detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    past_caches ? copy_rows<Floats<native>, true>(View(l), k, j0, j1, out)
                : copy_rows<Floats<native>, false>(View(l), k, j0, j1, out);
  });
#if defined(__SSE2__)
  if (past_caches) _mm_sfence();  // other threads see it
#endif
}

}  // namespace dynasurf::field::multigrid
