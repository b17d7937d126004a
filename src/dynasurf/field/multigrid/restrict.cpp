#include <algorithm>
#include <cstdint>

#include "dynasurf/field/multigrid/detail/scratch.hpp"
#include "dynasurf/field/multigrid/detail/view.hpp"

namespace dynasurf::field::multigrid {
namespace {

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
      const Index at = 2 * c * l.slot + m;
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
        const Index scalars = l.scalar_row(j, k) + half * l.slot + m;
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
  const Index scalars = 2 * t.slot * l.row_number(j, k), slice = 2 * t.slot * l.ny;
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
      const Index at = 2 * c * t.slot + m;
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
          const Index scalar = (r % 2 * 2 + half) * t.slot + m;
          const V rhs = load<V>((r < 2 ? rhs0 : rhs1) + (r % 2 * 6 + half) * t.slot + at);
          const V b = load<V>((r < 2 ? b0 : b1) + scalar), dm = load<V>((r < 2 ? d0 : d1) + scalar);
          flow = spread * (step + dm * ((rhs - b * n.near) + flow));
        }
        passed[r / 2] += (area[r] * share[half]) * flow;
      });
      const Index to = c * sum_step + m;
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

}  // namespace

void restrict_residual(Level& fine, Level& coarse, int k0, int k1, int j0, int j1) {
  const View f(fine), g(coarse);
  if (fine.finest)
    with_whole_vectors([&]<class V>() DYNASURF_INLINE_LAMBDA { restrict_rows<V, true>(f, g, k0, k1, j0, j1); });
  else
    with_vectors_for(fine, [&]<class V>() DYNASURF_INLINE_LAMBDA { restrict_rows<V, false>(f, g, k0, k1, j0, j1); });
}

}  // namespace dynasurf::field::multigrid
