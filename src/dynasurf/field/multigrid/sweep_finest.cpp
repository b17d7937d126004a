#include "dynasurf/field/multigrid/detail/sweep_rows.hpp"

namespace dynasurf::field::multigrid {
namespace {

/// On the finest level, with the sums of squares of what it changed and left in the first of its rows.
template <class V>
DYNASURF_INLINE void sweep_measured(Level& l, int k0, int k1, int j0, int j1, int colour) {
  Measure<V> measure;
  sweep_in_tiles<V, Start::measured, true>(View(l), k0, k1, j0, j1, colour, measure);
  for (int k = k0; k < k1; ++k) {
    const std::size_t row = l.row_number(j0, k), count = j1 - j0;
    std::fill_n(l.change.begin() + row, count, 0.0);
    std::fill_n(l.size.begin() + row, count, 0.0);
  }
  l.change[l.row_number(j0, k0)] = sum_of(measure.change);
  l.size[l.row_number(j0, k0)] = sum_of(measure.size);
}

template <class V>
DYNASURF_INLINE void sweep_near_data(const Level& l, int k0, int k1, int j0, int j1, int colour) {
  const View v(l);
  Measure<V> measure;
  with_usual_slot<V>(v.slot, [&](auto slot) DYNASURF_INLINE_LAMBDA {
    View known = v;
    if (slot > 0) known.slot = slot, known.stride = 6 * slot;
    sweep_rows<V, Start::near_data, true>(known, k0, k1, j0, j1, colour, measure);
  });
}

}  // namespace

void sweep_finest(Level& l, int k0, int k1, int j0, int j1, int colour, Start start) {
  if (start == Start::warm)
    with_whole_vectors([&]<class V>() DYNASURF_INLINE_LAMBDA {
      Measure<V> unused;
      sweep_in_tiles<V, Start::warm, true>(View(l), k0, k1, j0, j1, colour, unused);
    });
  else if (start == Start::near_data)
    with_whole_vectors([&]<class V>() DYNASURF_INLINE_LAMBDA { sweep_near_data<V>(l, k0, k1, j0, j1, colour); });
  else
    with_whole_vectors([&]<class V>() DYNASURF_INLINE_LAMBDA { sweep_measured<V>(l, k0, k1, j0, j1, colour); });
}

}  // namespace dynasurf::field::multigrid
