#pragma once
#include <algorithm>
#include <type_traits>

#include "dynasurf/field/multigrid/detail/level.hpp"

/// How the loops over a level see it: for the sources of the solver alone.
namespace dynasurf::field::multigrid {

/// What a loop needs of a level, copied: the compiler must believe that writing `u` may change a level itself, and
/// would read its members again after every vector.
struct View {
  int slot, nx, ny, nz;
  float stretch = 1;  // of corrections
  Index stride;
  float *u, *rhs, *b, *d;
  const float *lane_values, *blocks, *empty_d;
  const std::int32_t* block_of;
  const float *left[3], *right[3], *share[3];
  bool halved[3];

  DYNASURF_INLINE explicit View(const Level& l)
      : slot(l.slot),
        nx(l.nx()),
        ny(l.ny()),
        nz(l.nz()),
        stride(static_cast<Index>(l.stride)),
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

  DYNASURF_INLINE Index row_number(int j, int k) const { return j + static_cast<Index>(ny) * k; }
  DYNASURF_INLINE Index row(int j, int k) const { return lanes + stride * row_number(j, k); }
  DYNASURF_INLINE Index scalar_row(int j, int k) const { return 2 * slot * row_number(j, k); }
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
    return blocks + block_size * static_cast<Index>(number);
  }
  DYNASURF_INLINE const float* empty_d_of(int j, int k, int half) const {
    const int y = j == 0 ? 0 : j + 1 == ny ? 2 : 1, z = k == 0 ? 0 : k + 1 == nz ? 2 : 1;
    return empty_d + ((z * 3 + y) * 2 + half) * slot;
  }
};

/// Where the loops over half a row end, a multiple of V::count: few floats are used where they are enough.
template <class V, class Size>
DYNASURF_INLINE Size end_of(Size slot) {
  return V::count < lanes ? V::count : slot;
}

/// Calls `body<V>()` with the vectors that suit the rows of a level, on the machine's best instruction set.
template <class Body>
DYNASURF_INLINE void with_vectors_for(const Level& l, const Body& body) {
  detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    l.nx() <= lanes && !l.finest ? body.template operator()<FewFloats<native>>()
                                 : body.template operator()<Floats<native>>();
  });
}

/// The same with the vectors of the finest level. Each kind of loop gets a call of its own: what a compiler takes for a
/// function grows faster than the function.
template <class Body>
DYNASURF_INLINE void with_whole_vectors(const Body& body) {
  detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA { body.template operator()<Floats<native>>(); });
}

/// Calls `body(std::integral_constant)` with the size of half a row where it is one of the usual ones, else with 0.
/// Processors with narrow vectors alone are not worth the copies, which are what takes longest to compile here.
template <class V, class Body>
DYNASURF_INLINE void with_usual_slot(int slot, Body body) {
  if constexpr (V::count < lanes)
    body(std::integral_constant<int, lanes>{});
  else if constexpr (V::native_count == 4)
    body(std::integral_constant<int, 0>{});
  else
    slot == 16   ? body(std::integral_constant<int, 16>{})
    : slot == 32 ? body(std::integral_constant<int, 32>{})
                 : body(std::integral_constant<int, 0>{});
}

DYNASURF_INLINE int half_of(int colour, int j, int k) { return (colour + j + k) & 1; }

/// The cells of one colour of a row, of the x component, and their neighbours, all of the other colour. Along i one
/// neighbour has the lane of the cell itself (`near`), the other is a lane further (`far`). Beyond a wall along y and z
/// a cell meets `near` again. Component c lies 2 c slots further.
struct Row {
  float* own;
  const float *near, *far, *ym, *yp, *zm, *zp;
};

DYNASURF_INLINE Row row_of(const View& v, int j, int k, int half) {
  float* base = v.u + v.row(j, k);
  float* own = base + half * v.slot;
  const float* near = base + (1 - half) * v.slot;
  const Index slice = v.stride * v.ny;
  return {own,
          near,
          half == 0 ? near - 1 : near + 1,
          j > 0 ? own - v.stride : near,
          j + 1 < v.ny ? own + v.stride : near,
          k > 0 ? own - slice : near,
          k + 1 < v.nz ? own + slice : near};
}

/// Of sixteen cells the value `near` and how far their other neighbours lie from it.
template <class V>
struct Around {
  V near, far, ym, yp, zm, zp;
};

/// Of the cells from lane `at` of a row on.
template <class V>
DYNASURF_INLINE Around<V> around(const Row& r, Index at) {
  const V u = load<V>(r.near + at);
  const auto beyond = [&](const float* p) DYNASURF_INLINE_LAMBDA { return load<V>(p + at) - u; };
  return {u, beyond(r.far), beyond(r.ym), beyond(r.yp), beyond(r.zm), beyond(r.zp)};
}

/// The same of 2 x 2 rows, row r at (j + r % 2, k + r / 2), so that what is a neighbour of two rows is loaded once, and
/// subtracted once where it is that of both.
/// Half `first` of row 0, and the size of half a row where it is one of the usual ones, are known when this is
/// compiled, so that a few pointers do.
template <class V, int first, int usual_slot>
struct Tile {
  Index slot, stride;
  float* slice[2];
  const float *y_low[2], *y_high[2], *z_low[2], *z_high[2];

  static constexpr int half(int r) { return r == 0 || r == 3 ? first : 1 - first; }
  DYNASURF_INLINE float* row(int r) const { return slice[r / 2] + (r % 2) * stride; }
  DYNASURF_INLINE float* own(int r) const { return row(r) + half(r) * slot; }
  DYNASURF_INLINE const float* near(int r) const { return row(r) + (1 - half(r)) * slot; }
  DYNASURF_INLINE const float* far(int r) const { return near(r) + (half(r) == 0 ? -1 : 1); }

  DYNASURF_INLINE Tile(const View& v, int j, int k) : slot(usual_slot > 0 ? usual_slot : v.slot), stride(6 * slot) {
    slice[0] = v.u + lanes + stride * v.row_number(j, k);
    slice[1] = slice[0] + stride * v.ny;
    for (int i = 0; i < 2; ++i) {
      y_low[i] = j > 0 ? own(2 * i) - stride : near(2 * i);
      y_high[i] = j + 2 < v.ny ? own(2 * i + 1) + stride : near(2 * i + 1);
      z_low[i] = k > 0 ? own(i) - stride * v.ny : near(i);
      z_high[i] = k + 2 < v.nz ? own(2 + i) + stride * v.ny : near(2 + i);
    }
  }

  /// Calls `body(row, around)` for every row.
  template <class Body>
  DYNASURF_INLINE void each_row(Index at, Body body) const {
    const V a = load<V>(near(0) + at), b = load<V>(near(1) + at), c = load<V>(near(2) + at), d = load<V>(near(3) + at);
    const V ab = b - a, cd = d - c, ac = c - a, bd = d - b;
    const auto beyond = [&](const float* p, V u) DYNASURF_INLINE_LAMBDA { return load<V>(p + at) - u; };
    body(std::integral_constant<int, 0>{},
         Around<V>{a, beyond(far(0), a), beyond(y_low[0], a), ab, beyond(z_low[0], a), ac});
    body(std::integral_constant<int, 1>{},
         Around<V>{b, beyond(far(1), b), -ab, beyond(y_high[0], b), beyond(z_low[1], b), bd});
    body(std::integral_constant<int, 2>{},
         Around<V>{c, beyond(far(2), c), beyond(y_low[1], c), cd, -ac, beyond(z_high[0], c)});
    body(std::integral_constant<int, 3>{},
         Around<V>{d, beyond(far(3), d), -cd, beyond(y_high[1], d), -bd, beyond(z_high[1], d)});
  }
};

/// Diffusion towards the four neighbours in y and z; on the finest level either side of an axis is alike.
struct Rates {
  float ym, yp, zm, zp;
};

template <bool finest>
DYNASURF_INLINE Rates rates_of(const View& v, int j, int k) {
  if constexpr (finest) return {v.ny > 1 ? v.right[1][0] : 0.0f, 0, v.nz > 1 ? v.right[2][0] : 0.0f, 0};
  return {v.left[1][j], v.right[1][j], v.left[2][k], v.right[2][k]};
}

/// Sum of diffusion times difference from `near` to the other neighbours; `x` is that towards `far`. A cell's new value
/// is `near` and its d times this and what the data add. In differences: single precision then holds the field to its
/// last digits however many voxels there are.
template <bool finest, class V>
DYNASURF_INLINE V inflow(const Around<V>& n, V x, const Rates& k) {
  if constexpr (finest) return x * n.far + (k.ym * (n.yp + n.ym) + k.zm * (n.zp + n.zm));
  return x * n.far + ((k.yp * n.yp + k.ym * n.ym) + (k.zp * n.zp + k.zm * n.zm));
}

}  // namespace dynasurf::field::multigrid
