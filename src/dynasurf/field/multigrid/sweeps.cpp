#include <algorithm>

#include "dynasurf/field/multigrid/level.hpp"

namespace dynasurf::multigrid {

namespace {

/// The cells of one colour of a row, of the x component, and their neighbours. Beyond a wall a cell meets itself or
/// anything finite: its diffusion there is 0. Component c lies 2 c slots further.
struct Row {
  float* own;
  const float *left, *right, *ym, *yp, *zm, *zp;
};

DYNASURF_INLINE Row row_of(const Level& l, int j, int k, int half) {
  float* u = l.u.data();
  const int shift = half * l.slot;
  float* base = u + l.row(j, k);
  const float* left = base + (1 - half) * l.slot + (half - 1);
  return {base + shift,
          left,
          left + 1,
          u + l.row(std::max(j - 1, 0), k) + shift,
          u + l.row(std::min(j + 1, l.ny() - 1), k) + shift,
          u + l.row(j, std::max(k - 1, 0)) + shift,
          u + l.row(j, std::min(k + 1, l.nz() - 1)) + shift};
}

/// Diffusion towards the four neighbours in y and z; on the finest level either side of an axis is alike.
struct Rates {
  float ym, yp, zm, zp;
};

DYNASURF_INLINE Rates rates_of(const Level& l, int j, int k) {
  const auto y = static_cast<std::size_t>(j), z = static_cast<std::size_t>(k);
  return {l.axis[1].left[y], l.axis[1].right[y], l.axis[2].left[z], l.axis[2].right[z]};
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

DYNASURF_INLINE Rates finest_rates(const Level& l) {
  const auto regular = [](const Axis& a) { return a.count > 1 ? a.right[0] : 0.0f; };
  return {regular(l.axis[1]), 0, regular(l.axis[2]), 0};
}

template <Start start>
DYNASURF_INLINE void sweep_coarse_row(const Level& l, int j, int k, int half) {
  const Row r = row_of(l, j, k, half);
  const Rates rates = rates_of(l, j, k);
  const float* rhs = l.rhs.data() + l.row(j, k) + half * l.slot;
  const float* b = l.b.data() + l.scalar_row(j, k) + half * l.slot;
  const float* d = l.d.data() + l.scalar_row(j, k) + half * l.slot;
  const float *left = l.lane_left(half), *right = l.lane_right(half);
  for (int m = 0; m < l.slot; m += lanes) {
    const Vec16 kl = load(left + m), kr = load(right + m), dm = load(d + m), bm = load(b + m);
    for (int c = 0; c < 3; ++c) {
      const std::ptrdiff_t at = 2 * c * l.slot + m;
      if constexpr (start == Start::from_rhs) {
        store(r.own + at, dm * load(rhs + at));
      } else {
        const Vec16 u = start == Start::cold ? Vec16{} : load(r.own + at);
        store(r.own + at, u + dm * ((load(rhs + at) - bm * u) + inflow<false>(r, at, u, kl, kr, rates)));
      }
    }
  }
}

DYNASURF_INLINE double sum_of(Vec16 v) {
  double sum = 0;
  for (int i = 0; i < lanes; ++i) sum += static_cast<double>(v[i]);
  return sum;
}

template <Start start>
DYNASURF_INLINE void sweep_finest_row(Level& l, int j, int k, int half) {
  const Row r = row_of(l, j, k, half);
  // A row that meets itself beyond a wall must not meet the old values that a cold start ignores.
  constexpr bool alike = start != Start::cold;
  const Rates rates = alike ? finest_rates(l) : rates_of(l, j, k);
  const float *left = l.lane_left(half), *right = l.lane_right(half), *empty_d = l.empty_d_of(j, k, half);
  const std::int32_t* block_of = l.blocks_of(j, k, half);
  Vec16 changes{}, sizes{};
  for (int m = 0; m < l.slot; m += lanes) {
    const Vec16 kl = load(left + m), kr = load(right + m);
    const std::int32_t number = block_of[m / lanes];
    const float* data = l.blocks.data() + 80 * static_cast<std::ptrdiff_t>(std::max(number, 0));
    const Vec16 d = load(number < 0 ? empty_d + m : data);
    for (int c = 0; c < 3; ++c) {
      const std::ptrdiff_t at = 2 * c * l.slot + m;
      const Vec16 u = start == Start::cold ? Vec16{} : load(r.own + at);
      Vec16 flow = inflow<alike>(r, at, u, kl, kr, rates);
      if (number >= 0) flow += load(data + 16) * (load(data + 32 + 16 * c) - u);
      const Vec16 change = d * flow, next = u + change;
      store(r.own + at, next);
      if constexpr (start == Start::measured) {
        changes += change * change;
        sizes += next * next;
      }
    }
  }
  if constexpr (start == Start::measured) {
    l.change[l.row_number(j, k)] = sum_of(changes);
    l.size[l.row_number(j, k)] = sum_of(sizes);
  }
}

DYNASURF_INLINE int half_of(int colour, int j, int k) { return (colour + j + k) & 1; }

/// Even and odd lanes of 32 floats, and back.
DYNASURF_INLINE void split(const float* natural, float* even, float* odd) {
  const Vec16 a = load(natural), b = load(natural + lanes);
  store(even, __builtin_shufflevector(a, b, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30));
  store(odd, __builtin_shufflevector(a, b, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31));
}

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
DYNASURF_INLINE void add_residual(const Level& l, int j, int k, float area, float* sum, int sum_step) {
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
    const float* data = finest ? l.blocks.data() + 80 * static_cast<std::ptrdiff_t>(std::max(number, 0)) : nullptr;
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
        const float* rhs = l.rhs.data() + l.row(j, k) + half * l.slot;
        const std::size_t scalars = l.scalar_row(j, k) + static_cast<std::size_t>(half * l.slot + m);
        flow = spread * (load(l.d.data() + scalars) * ((load(rhs + at) - load(l.b.data() + scalars) * u) + flow));
      }
      store(sum + c * sum_step + m, load(sum + c * sum_step + m) + flow);
    }
  }
}

/// Cells of an axis that a coarser cell holds: [first, last].
struct Children {
  int first, last;
};
DYNASURF_INLINE Children children_of(const Axis& a, int i) {
  return a.halved ? Children{2 * i, std::min(2 * i + 1, a.count - 1)} : Children{i, i};
}

template <bool finest>
DYNASURF_INLINE void restrict_rows(const Level& f, Level& g, int k, int j0, int j1) {
  const bool halved = f.axis[0].halved;
  // Sums over pairs along x lie in natural order and are split at the end; without pairs they lie split already.
  const int step = halved ? std::max(f.slot, 2 * g.slot) : 2 * f.slot;
  float* sum = scratch(static_cast<std::size_t>(3 * step));
  const Children slices = children_of(f.axis[2], k);
  for (int j = j0; j < j1; ++j) {
    std::fill_n(sum, 3 * step, 0.0f);
    const Children rows = children_of(f.axis[1], j);
    for (int z = slices.first; z <= slices.last; ++z)
      for (int y = rows.first; y <= rows.last; ++y) {
        const float area = f.axis[1].share[static_cast<std::size_t>(y)] * f.axis[2].share[static_cast<std::size_t>(z)];
        float* into = halved ? sum : sum + half_of(0, y, z) * f.slot;
        add_residual<finest>(f, y, z, area, into, step);
      }
    float* rhs = g.rhs.data() + g.row(j, k);
    for (int c = 0; c < 3; ++c) {
      if (halved)
        for (int m = 0; m < g.slot; m += lanes)
          split(sum + c * step + 2 * m, rhs + 2 * c * g.slot + m, rhs + (2 * c + 1) * g.slot + m);
      else
        std::copy_n(sum + c * step, 2 * f.slot, rhs + 2 * c * g.slot);
    }
  }
}

/// Rows of the coarser level between slices, in natural order along x where pairs were joined: the last four asked for.
class Interpolated {
 public:
  Interpolated(const Level& fine, const Level& coarse, int k)
      : g_(coarse),
        halved_(fine.axis[0].halved),
        step_(2 * coarse.slot + 2 * lanes),
        rows_(scratch(12 * static_cast<std::size_t>(step_))) {
    std::fill_n(rows_, 12 * step_, 0.0f);
    const Axis& z = fine.axis[2];
    own_ = z.halved ? k / 2 : k;
    next_ = z.halved ? std::clamp(own_ + (k % 2 == 0 ? -1 : 1), 0, g_.nz() - 1) : own_;
  }

  /// Component 0; the others follow at `step()`. Lanes -1 and `count` repeat the ends.
  DYNASURF_INLINE const float* row(int j) {
    float* out = rows_ + 3 * static_cast<std::ptrdiff_t>(step_) * (j & 3) + lanes;
    if (held_[static_cast<std::size_t>(j & 3)] == j) return out;
    held_[static_cast<std::size_t>(j & 3)] = j;
    const float *p = g_.u.data() + g_.row(j, own_), *q = g_.u.data() + g_.row(j, next_);
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
      to[g_.nx()] = to[g_.nx() - 1];
    }
    return out;
  }
  int step() const { return step_; }

 private:
  const Level& g_;
  bool halved_;
  int step_, own_, next_;
  float* rows_;
  std::array<int, 4> held_{-1, -1, -1, -1};
};

/// A correction is stretched a little: the averaged data term of the coarser level holds it back.
constexpr float stretch = 1.1f;

template <bool finest, bool first>
DYNASURF_INLINE void interpolate_rows(Level& f, const Level& g, int k, int j0, int j1) {
  Interpolated between(f, g, k);
  const bool halved = f.axis[0].halved;
  const int step = between.step();
  for (int j = j0; j < j1; ++j) {
    const int half = half_of(1, j, k);
    const int own = f.axis[1].halved ? j / 2 : j;
    const int next = f.axis[1].halved ? std::clamp(own + (j % 2 == 0 ? -1 : 1), 0, g.ny() - 1) : own;
    const float *p = between.row(own), *q = between.row(next);
    const int beside = halved ? (half == 0 ? -1 : 1) : 0, shift = halved ? 0 : half * f.slot;
    const float *diagonal = f.lane_diagonal(half), yz = f.yz_diagonal(j, k);
    float* u = f.u.data() + f.row(j, k) + half * f.slot;
    const std::size_t scalars = f.scalar_row(j, k) + static_cast<std::size_t>(half * f.slot);
    for (int m = 0; m < f.slot; m += lanes) {
      const std::int32_t number = finest ? f.blocks_of(j, k, half)[m / lanes] : 0;
      const float* data = finest ? f.blocks.data() + 80 * static_cast<std::ptrdiff_t>(std::max(number, 0)) : nullptr;
      Vec16 d{}, share{};
      if (!finest || number >= 0) {
        d = finest ? load(data) : load(f.d.data() + scalars + m);
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
            t += d * load(f.rhs.data() + f.row(j, k) + half * f.slot + at);
          }
          store(u + at, t);
        } else {
          store(u + at, load(u + at) + stretch * t);
        }
      }
    }
  }
}

}  // namespace

DYNASURF_CLONES void sweep(Level& l, int k, int j0, int j1, int colour, Start start) {
  for (int j = j0; j < j1; ++j) {
    const int half = half_of(colour, j, k);
    if (l.finest)
      start == Start::warm   ? sweep_finest_row<Start::warm>(l, j, k, half)
      : start == Start::cold ? sweep_finest_row<Start::cold>(l, j, k, half)
                             : sweep_finest_row<Start::measured>(l, j, k, half);
    else if (start == Start::warm)
      sweep_coarse_row<Start::warm>(l, j, k, half);
    else if (start == Start::cold)
      sweep_coarse_row<Start::cold>(l, j, k, half);
    else
      sweep_coarse_row<Start::from_rhs>(l, j, k, half);
  }
}

DYNASURF_CLONES void restrict_residual(Level& fine, Level& coarse, int k, int j0, int j1) {
  fine.finest ? restrict_rows<true>(fine, coarse, k, j0, j1) : restrict_rows<false>(fine, coarse, k, j0, j1);
}

DYNASURF_CLONES void correct_black(Level& fine, const Level& coarse, int k, int j0, int j1) {
  fine.finest ? interpolate_rows<true, false>(fine, coarse, k, j0, j1)
              : interpolate_rows<false, false>(fine, coarse, k, j0, j1);
}

DYNASURF_CLONES void start_black(Level& fine, const Level& coarse, int k, int j0, int j1) {
  fine.finest ? interpolate_rows<true, true>(fine, coarse, k, j0, j1)
              : interpolate_rows<false, true>(fine, coarse, k, j0, j1);
}

namespace {

DYNASURF_CLONES void copy_row(const float* even, const float* odd, int count, float* out) {
  int i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) join(load(even + i / 2), load(odd + i / 2), out + i);
  for (; i < count; ++i) out[i] = (i % 2 == 0 ? even : odd)[i / 2];
}

}  // namespace

void copy_out(const Level& l, int k0, int k1, std::array<float*, 3> out) {
  for (int k = k0; k < k1; ++k)
    for (int j = 0; j < l.ny(); ++j)
      for (int c = 0; c < 3; ++c) {
        const float* even = l.u.data() + l.row(j, k) + 2 * c * l.slot;
        copy_row(even, even + l.slot, l.nx(),
                 out[static_cast<std::size_t>(c)] + l.row_number(j, k) * static_cast<std::size_t>(l.nx()));
      }
}

}  // namespace dynasurf::multigrid
