#include "dynasurf/field/multigrid/detail/sweep_rows.hpp"

namespace dynasurf::field::multigrid {
namespace {

template <Start start>
void sweep_coarse(const Level& l, int k0, int k1, int j0, int j1, int colour) {
  with_vectors_for(l, [&]<class V>() DYNASURF_INLINE_LAMBDA {
    Measure<V> unused;
    if constexpr (start == Start::warm)
      sweep_in_tiles<V, start, false>(View(l), k0, k1, j0, j1, colour, unused);
    else
      sweep_rows<V, start, false>(View(l), k0, k1, j0, j1, colour, unused);
  });
}

template <class V>
DYNASURF_INLINE void add_operator_with(Level& l, float stretch, int k0, int k1, int j0, int j1) {
  const View v(l);
  for (int k = k0; k < k1; ++k)
    for (int j = j0; j < j1; ++j)
      for (int half : {0, 1}) {
        const Row r = row_of(v, j, k, half);
        const Rates rates = rates_of<false>(v, j, k);
        const float* towards_far = half == 0 ? v.lane_left(0) : v.lane_right(1);
        const float* towards_near = half == 0 ? v.lane_right(0) : v.lane_left(1);
        float* rhs = v.rhs + v.row(j, k) + half * v.slot;
        const float* b = v.b + v.scalar_row(j, k) + half * v.slot;
        for (int m = 0; m < end_of<V>(v.slot); m += V::count)
          for (int c = 0; c < 3; ++c) {
            const Index at = 2 * c * v.slot + m;
            const V u = load<V>(r.own + at);
            const V x = load<V>(towards_far + m) * (u - load<V>(r.far + at)) +
                        load<V>(towards_near + m) * (u - load<V>(r.near + at));
            const V y = rates.ym * (u - load<V>(r.ym + at)) + rates.yp * (u - load<V>(r.yp + at));
            const V z = rates.zm * (u - load<V>(r.zm + at)) + rates.zp * (u - load<V>(r.zp + at));
            store(rhs + at, stretch * load<V>(rhs + at) + (load<V>(b + m) * u + (x + (y + z))));
          }
      }
}

}  // namespace

void sweep(Level& level, int k0, int k1, int j0, int j1, int colour, Start start) {
  if (level.finest) return sweep_finest(level, k0, k1, j0, j1, colour, start);
  if (start == Start::warm) return sweep_coarse<Start::warm>(level, k0, k1, j0, j1, colour);
  sweep_coarse<Start::from_rhs>(level, k0, k1, j0, j1, colour);
}

void add_operator(Level& coarse, float stretch, int k0, int k1, int j0, int j1) {
  detail::with_native_vectors(
      [&]<int native>() DYNASURF_INLINE_LAMBDA { add_operator_with<Floats<native>>(coarse, stretch, k0, k1, j0, j1); });
}

}  // namespace dynasurf::field::multigrid
