#include <algorithm>

#include "dynasurf/field/multigrid/level.hpp"

namespace dynasurf::multigrid {

namespace {

/// What a loop needs of a level, copied: the compiler must believe that writing `u` may change a level itself, and
/// would read its members again after every vector.
struct View {
  int slot, nx, ny, nz;
  float stretch;
  std::ptrdiff_t stride;
  float *u, *rhs;
  const float *b, *d, *lane_values, *blocks, *empty_d;
  const std::int32_t* block_of;
  const float *left[3], *right[3], *share[3];
  bool halved[3];

  DYNASURF_INLINE explicit View(const Level& l)
      : slot(l.slot),
        nx(l.nx()),
        ny(l.ny()),
        nz(l.nz()),
        stretch(l.stretch),
        stride(static_cast<std::ptrdiff_t>(l.stride)),
        u(l.u.data()),
        rhs(l.rhs.data()),
        b(l.b.data()),
        d(l.d.data()),
        lane_values(l.lane_values.data()),
        blocks(l.blocks.data()),
        empty_d(l.empty_d.data()),
        block_of(l.block_of.data()) {
    for (std::size_t a = 0; a < 3; ++a) {
      left[a] = l.axis[a].left.data();
      right[a] = l.axis[a].right.data();
      share[a] = l.axis[a].share.data();
      halved[a] = l.axis[a].halved;
    }
  }

  DYNASURF_INLINE std::ptrdiff_t row_number(int j, int k) const { return j + static_cast<std::ptrdiff_t>(ny) * k; }
  DYNASURF_INLINE std::ptrdiff_t row(int j, int k) const { return lanes + stride * row_number(j, k); }
  DYNASURF_INLINE std::ptrdiff_t scalar_row(int j, int k) const { return 2 * slot * row_number(j, k); }
  DYNASURF_INLINE const float* lane_left(int half) const { return lane_values + half * slot; }
  DYNASURF_INLINE const float* lane_right(int half) const { return lane_values + (2 + half) * slot; }
  DYNASURF_INLINE const float* lane_diagonal(int half) const { return lane_values + (4 + half) * slot; }
  DYNASURF_INLINE const float* lane_share(int half) const { return lane_values + (6 + half) * slot; }
  DYNASURF_INLINE float yz_diagonal(int j, int k) const {
    return (left[1][j] + right[1][j]) + (left[2][k] + right[2][k]);
  }
  DYNASURF_INLINE const std::int32_t* blocks_of(int j, int k, int half) const {
    return block_of + (row_number(j, k) * 2 + half) * (slot / lanes);
  }
  DYNASURF_INLINE const float* block(std::int32_t number) const {
    return blocks + block_size * static_cast<std::ptrdiff_t>(number);
  }
  DYNASURF_INLINE const float* empty_d_of(int j, int k, int half) const {
    const int y = j == 0 ? 0 : j + 1 == ny ? 2 : 1, z = k == 0 ? 0 : k + 1 == nz ? 2 : 1;
    return empty_d + ((z * 3 + y) * 2 + half) * slot;
  }
};

/// The cells of one colour of a row, of the x component, and their neighbours. Beyond a wall a cell meets itself or
/// anything finite: its diffusion there is 0. Component c lies 2 c slots further.
struct Row {
  float* own;
  const float *left, *right, *ym, *yp, *zm, *zp;
};

DYNASURF_INLINE Row row_of(const View& v, int j, int k, int half) {
  float* base = v.u + v.row(j, k);
  float* own = base + half * v.slot;
  const float* left = base + (1 - half) * v.slot + (half - 1);
  const std::ptrdiff_t slice = v.stride * v.ny;
  return {own,
          left,
          left + 1,
          j > 0 ? own - v.stride : own,
          j + 1 < v.ny ? own + v.stride : own,
          k > 0 ? own - slice : own,
          k + 1 < v.nz ? own + slice : own};
}

/// Diffusion towards the four neighbours in y and z; on the finest level either side of an axis is alike.
struct Rates {
  float ym, yp, zm, zp;
};

DYNASURF_INLINE Rates rates_of(const View& v, int j, int k) {
  return {v.left[1][j], v.right[1][j], v.left[2][k], v.right[2][k]};
}

/// Sum of diffusion times difference to the six neighbours. In differences: single precision then holds the field to
/// its last digits however many voxels there are.
template <bool finest>
DYNASURF_INLINE Vec16 inflow(const Row& r, std::ptrdiff_t at, Vec16 u, Vec16 kl, Vec16 kr, const Rates& k) {
  const Vec16 x = kl * (load(r.left + at) - u) + kr * (load(r.right + at) - u);
  if constexpr (finest) {
    // Beyond a wall of the finest level the row meets itself, so that the regular rate does no harm.
    const Vec16 y = k.ym * ((load(r.ym + at) - u) + (load(r.yp + at) - u));
    const Vec16 z = k.zm * ((load(r.zm + at) - u) + (load(r.zp + at) - u));
    return x + (y + z);
  } else {
    const Vec16 y = k.ym * (load(r.ym + at) - u) + k.yp * (load(r.yp + at) - u);
    const Vec16 z = k.zm * (load(r.zm + at) - u) + k.zp * (load(r.zp + at) - u);
    return x + (y + z);
  }
}

DYNASURF_INLINE Rates finest_rates(const View& v) {
  return {v.ny > 1 ? v.right[1][0] : 0.0f, 0, v.nz > 1 ? v.right[2][0] : 0.0f, 0};
}

template <Start start>
DYNASURF_INLINE void sweep_coarse_row(const View& v, int j, int k, int half) {
  const Row r = row_of(v, j, k, half);
  const Rates rates = rates_of(v, j, k);
  const float* rhs = v.rhs + v.row(j, k) + half * v.slot;
  const float* b = v.b + v.scalar_row(j, k) + half * v.slot;
  const float* d = v.d + v.scalar_row(j, k) + half * v.slot;
  const float *left = v.lane_left(half), *right = v.lane_right(half);
  for (int m = 0; m < v.slot; m += lanes) {
    const Vec16 kl = load(left + m), kr = load(right + m), dm = load(d + m), bm = load(b + m);
    for (int c = 0; c < 3; ++c) {
      const std::ptrdiff_t at = 2 * c * v.slot + m;
      if constexpr (start == Start::from_rhs) {
        store(r.own + at, dm * load(rhs + at));
      } else {
        const Vec16 u = start == Start::cold ? Vec16{} : load(r.own + at);
        store(r.own + at, u + dm * ((load(rhs + at) - bm * u) + inflow<false>(r, at, u, kl, kr, rates)));
      }
    }
  }
}

/// Sum of all lanes, in an order that does not depend on the machine.
DYNASURF_INLINE double sum_of(Vec16 v) {
  double pairs[8];
  for (int i = 0; i < 8; ++i) pairs[i] = static_cast<double>(v[i]) + static_cast<double>(v[i + 8]);
  return ((pairs[0] + pairs[4]) + (pairs[1] + pairs[5])) + ((pairs[2] + pairs[6]) + (pairs[3] + pairs[7]));
}

/// Sums of squares of what a sweep changed and of what it left.
struct Measure {
  Vec16 change{}, size{};
};

template <Start start>
DYNASURF_INLINE void sweep_finest_row(const View& v, int j, int k, int half, Measure& measure) {
  const Row r = row_of(v, j, k, half);
  // A row that meets itself beyond a wall must not meet the old values that a cold start ignores.
  constexpr bool alike = start != Start::cold;
  const Rates rates = alike ? finest_rates(v) : rates_of(v, j, k);
  const float *left = v.lane_left(half), *right = v.lane_right(half), *empty_d = v.empty_d_of(j, k, half);
  const std::int32_t* block_of = v.blocks_of(j, k, half);
  for (int m = 0; m < v.slot; m += lanes) {
    const std::int32_t number = block_of[m / lanes];
    if (start == Start::near_data && number < 0) continue;
    const Vec16 kl = load(left + m), kr = load(right + m);
    const auto relax = [&](int c, Vec16 d, auto pull) DYNASURF_INLINE_LAMBDA {
      const std::ptrdiff_t at = 2 * c * v.slot + m;
      const Vec16 u = start == Start::cold ? Vec16{} : load(r.own + at);
      const Vec16 change = d * pull(u, inflow<alike>(r, at, u, kl, kr, rates)), next = u + change;
      store(r.own + at, next);
      if constexpr (start == Start::measured) {
        measure.change += change * change;
        measure.size += next * next;
      }
    };
    if (number < 0) {
      const Vec16 d = load(empty_d + m);
      for (int c = 0; c < 3; ++c) relax(c, d, [](Vec16, Vec16 flow) DYNASURF_INLINE_LAMBDA { return flow; });
    } else {
      const float* data = v.block(number);
      const Vec16 d = load(data), b = load(data + 16);
      for (int c = 0; c < 3; ++c)
        relax(c, d,
              [&](Vec16 u, Vec16 flow) DYNASURF_INLINE_LAMBDA { return flow + b * (load(data + 32 + 16 * c) - u); });
    }
  }
}

DYNASURF_INLINE int half_of(int colour, int j, int k) { return (colour + j + k) & 1; }

/// 32 floats out of their even and odd lanes.
DYNASURF_INLINE void join(Vec16 even, Vec16 odd, float* natural) {
  store(natural, __builtin_shufflevector(even, odd, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23));
  store(natural + lanes,
        __builtin_shufflevector(even, odd, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31));
}

/// Memory for a few rows, kept by the thread.
float* scratch(std::size_t count) {
  thread_local detail::FloatBuffer buffer;
  if (buffer.size() < count) buffer = detail::FloatBuffer(count);
  return buffer.data();
}

/// Adds to `sum` what the red cells of a row pass to the coarser level: D times the change that their next sweep would
/// make. With s = D/(D+b), the share of a cell that diffusion rules, this is s times the residual: a cell that the data
/// hold fast does not speak for its neighbourhood. `area` is the row's share in the coarser cell.
template <bool finest>
DYNASURF_INLINE void add_residual(const View& l, int j, int k, float area, float* sum, int sum_step) {
  const int half = half_of(0, j, k);
  const Row r = row_of(l, j, k, half);
  const Rates rates = finest ? finest_rates(l) : rates_of(l, j, k);
  const float *left = l.lane_left(half), *right = l.lane_right(half);
  const float *diagonal = l.lane_diagonal(half), *share = l.lane_share(half);
  const float yz = l.yz_diagonal(j, k);
  for (int m = 0; m < l.slot; m += lanes) {
    const Vec16 kl = load(left + m), kr = load(right + m);
    const Vec16 weight = area * load(share + m);
    const Vec16 spread = (load(diagonal + m) + yz) * weight;
    const std::int32_t number = finest ? l.blocks_of(j, k, half)[m / lanes] : 0;
    const float* data = finest ? l.block(std::max(number, 0)) : nullptr;
    for (int c = 0; c < 3; ++c) {
      const std::ptrdiff_t at = 2 * c * l.slot + m;
      const Vec16 u = load(r.own + at);
      Vec16 flow = inflow<finest>(r, at, u, kl, kr, rates);
      if constexpr (finest) {
        if (number < 0) {
          flow *= weight;  // D d is 1 where there are no data
        } else {
          flow = spread * (load(data) * (load(data + 16) * (load(data + 32 + 16 * c) - u) + flow));
        }
      } else {
        const float* rhs = l.rhs + l.row(j, k) + half * l.slot;
        const std::ptrdiff_t scalars = l.scalar_row(j, k) + half * l.slot + m;
        flow = spread * (load(l.d + scalars) * ((load(rhs + at) - load(l.b + scalars) * u) + flow));
      }
      store(sum + c * sum_step + m, load(sum + c * sum_step + m) + flow);
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

template <bool finest>
DYNASURF_INLINE void restrict_rows(const View f, const View g, int k, int j0, int j1) {
  const bool halved = f.halved[0];
  // Sums over pairs along x lie in natural order and are split at the end; without pairs they lie split already.
  const int step = halved ? std::max(f.slot, 2 * g.slot) : 2 * f.slot;
  float* sum = scratch(static_cast<std::size_t>(3 * step));
  const Children slices = children_of(f.halved[2], f.nz, k);
  for (int j = j0; j < j1; ++j) {
    std::fill_n(sum, 3 * step, 0.0f);
    const Children rows = children_of(f.halved[1], f.ny, j);
    for (int z = slices.first; z <= slices.last; ++z)
      for (int y = rows.first; y <= rows.last; ++y) {
        const float area = f.share[1][y] * f.share[2][z];
        float* into = halved ? sum : sum + half_of(0, y, z) * f.slot;
        add_residual<finest>(f, y, z, area, into, step);
      }
    float* rhs = g.rhs + g.row(j, k);
    for (int c = 0; c < 3; ++c) {
      if (halved)
        for (int m = 0; m < g.slot; m += lanes) {
          Vec16 even, odd;
          split(sum + c * step + 2 * m, even, odd);
          store(rhs + 2 * c * g.slot + m, even);
          store(rhs + (2 * c + 1) * g.slot + m, odd);
        }
      else
        std::copy_n(sum + c * step, 2 * f.slot, rhs + 2 * c * g.slot);
    }
  }
}

/// Rows of the coarser level between slices, in natural order along x where pairs were joined: the last four asked for.
class Interpolated {
 public:
  DYNASURF_INLINE Interpolated(const View& fine, const View& coarse, int k)
      : g_(coarse),
        halved_(fine.halved[0]),
        step_(2 * coarse.slot + 2 * lanes),
        rows_(scratch(12 * static_cast<std::size_t>(step_))) {
    std::fill_n(rows_, 12 * step_, 0.0f);
    own_ = fine.halved[2] ? k / 2 : k;
    next_ = fine.halved[2] ? std::clamp(own_ + (k % 2 == 0 ? -1 : 1), 0, g_.nz - 1) : own_;
  }

  /// Component 0; the others follow at `step()`. Lanes -1 and `count` repeat the ends.
  DYNASURF_INLINE const float* row(int j) {
    float* out = rows_ + 3 * static_cast<std::ptrdiff_t>(step_) * (j & 3) + lanes;
    if (held_[static_cast<std::size_t>(j & 3)] == j) return out;
    held_[static_cast<std::size_t>(j & 3)] = j;
    const float *p = g_.u + g_.row(j, own_), *q = g_.u + g_.row(j, next_);
    for (int c = 0; c < 3; ++c, p += 2 * g_.slot, q += 2 * g_.slot) {
      float* to = out + c * step_;
      if (!halved_) {
        for (int m = 0; m < 2 * g_.slot; m += lanes) store(to + m, 0.75f * load(p + m) + 0.25f * load(q + m));
        continue;
      }
      for (int m = 0; m < g_.slot; m += lanes)
        join(0.75f * load(p + m) + 0.25f * load(q + m), 0.75f * load(p + g_.slot + m) + 0.25f * load(q + g_.slot + m),
             to + 2 * m);
      to[-1] = to[0];
      to[g_.nx] = to[g_.nx - 1];
    }
    return out;
  }
  int step() const { return step_; }

 private:
  const View g_;
  bool halved_;
  int step_, own_, next_;
  float* rows_;
  std::array<int, 4> held_{-1, -1, -1, -1};
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

template <bool finest, bool first>
DYNASURF_INLINE void interpolate_rows(const View f, const View g, int k, int j0, int j1) {
  Interpolated between(f, g, k);
  const bool halved = f.halved[0];
  const int step = between.step();
  for (int j = j0; j < j1; ++j) {
    const int half = half_of(1, j, k);
    const int own = f.halved[1] ? j / 2 : j;
    const int next = f.halved[1] ? std::clamp(own + (j % 2 == 0 ? -1 : 1), 0, g.ny - 1) : own;
    const float *p = between.row(own), *q = between.row(next);
    const int beside = halved ? (half == 0 ? -1 : 1) : 0, shift = halved ? 0 : half * f.slot;
    const float *diagonal = f.lane_diagonal(half), yz = f.yz_diagonal(j, k);
    float* u = f.u + f.row(j, k) + half * f.slot;
    fetch_ahead<finest>(f, j, k);
    const std::ptrdiff_t scalars = f.scalar_row(j, k) + half * f.slot;
    for (int m = 0; m < f.slot; m += lanes) {
      const std::int32_t number = finest ? f.blocks_of(j, k, half)[m / lanes] : 0;
      const float* data = finest ? f.block(std::max(number, 0)) : nullptr;
      Vec16 d{}, share{};
      if (!finest || number >= 0) {
        d = finest ? load(data) : load(f.d + scalars + m);
        share = (load(diagonal + m) + yz) * d;
      }
      for (int c = 0; c < 3; ++c) {
        const float *pm = p + c * step + shift + m, *qm = q + c * step + shift + m;
        const Vec16 here = 0.75f * load(pm) + 0.25f * load(qm);
        const Vec16 there = 0.75f * load(pm + beside) + 0.25f * load(qm + beside);
        Vec16 t = 0.75f * here + 0.25f * there;
        const std::ptrdiff_t at = 2 * c * f.slot + m;
        if (!finest || number >= 0) t *= share;
        if constexpr (first) {
          // One relaxation with the interpolated values as neighbours.
          if (finest) {
            if (number >= 0) t += d * (load(data + 16) * load(data + 32 + 16 * c));
          } else {
            t += d * load(f.rhs + f.row(j, k) + half * f.slot + at);
          }
          store(u + at, t);
        } else {
          store(u + at, load(u + at) + f.stretch * t);
        }
      }
    }
  }
}

}  // namespace

namespace {

DYNASURF_INLINE bool has_data(const View& v, int j, int k, int half) {
  const std::int32_t* blocks = v.blocks_of(j, k, half);
  return std::any_of(blocks, blocks + v.slot / lanes, [](std::int32_t number) { return number >= 0; });
}

template <Start start, bool finest>
DYNASURF_INLINE void sweep_rows(Level& l, int k, int j0, int j1, int colour) {
  const View v(l);
  Measure measure;
  for (int j = j0; j < j1; ++j) {
    const int half = half_of(colour, j, k);
    if (start == Start::near_data && !has_data(v, j, k, half)) continue;
    if constexpr (finest)
      sweep_finest_row<start>(v, j, k, half, measure);
    else
      sweep_coarse_row<start>(v, j, k, half);
  }
  if constexpr (start == Start::measured) {
    const std::size_t row = l.row_number(j0, k);
    l.change[row] = sum_of(measure.change);
    l.size[row] = sum_of(measure.size);
    std::fill(l.change.begin() + row + 1, l.change.begin() + row + (j1 - j0), 0.0);
    std::fill(l.size.begin() + row + 1, l.size.begin() + row + (j1 - j0), 0.0);
  }
}

}  // namespace

DYNASURF_CLONES void sweep(Level& l, int k, int j0, int j1, int colour, Start start) {
  if (l.finest)
    start == Start::warm        ? sweep_rows<Start::warm, true>(l, k, j0, j1, colour)
    : start == Start::cold      ? sweep_rows<Start::cold, true>(l, k, j0, j1, colour)
    : start == Start::near_data ? sweep_rows<Start::near_data, true>(l, k, j0, j1, colour)
                                : sweep_rows<Start::measured, true>(l, k, j0, j1, colour);
  else
    start == Start::warm   ? sweep_rows<Start::warm, false>(l, k, j0, j1, colour)
    : start == Start::cold ? sweep_rows<Start::cold, false>(l, k, j0, j1, colour)
                           : sweep_rows<Start::from_rhs, false>(l, k, j0, j1, colour);
}

DYNASURF_CLONES void restrict_residual(Level& fine, Level& coarse, int k, int j0, int j1) {
  const View f(fine), g(coarse);
  fine.finest ? restrict_rows<true>(f, g, k, j0, j1) : restrict_rows<false>(f, g, k, j0, j1);
}

DYNASURF_CLONES void correct_black(Level& fine, const Level& coarse, int k, int j0, int j1) {
  const View f(fine), g(coarse);
  fine.finest ? interpolate_rows<true, false>(f, g, k, j0, j1) : interpolate_rows<false, false>(f, g, k, j0, j1);
}

DYNASURF_CLONES void start_black(Level& fine, const Level& coarse, int k, int j0, int j1) {
  const View f(fine), g(coarse);
  fine.finest ? interpolate_rows<true, true>(f, g, k, j0, j1) : interpolate_rows<false, true>(f, g, k, j0, j1);
}

namespace {

DYNASURF_CLONES void copy_row(const float* even, const float* odd, int count, float* out) {
  int i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) join(load(even + i / 2), load(odd + i / 2), out + i);
  if (i == count) return;
  float rest[2 * lanes];
  join(load(even + i / 2), load(odd + i / 2), rest);
  std::copy_n(rest, count - i, out + i);
}

}  // namespace

void copy_out(const Level& l, int k, int j0, int j1, std::array<float*, 3> out) {
  for (int j = j0; j < j1; ++j)
    for (int c = 0; c < 3; ++c) {
      const float* even = l.u.data() + l.row(j, k) + 2 * c * l.slot;
      copy_row(even, even + l.slot, l.nx(),
               out[static_cast<std::size_t>(c)] + l.row_number(j, k) * static_cast<std::size_t>(l.nx()));
    }
}

}  // namespace dynasurf::multigrid
