#pragma once
#include <cmath>

#include "dynasurf/field/multigrid/detail/view.hpp"

namespace dynasurf::field::multigrid {

/// d of 16 cells; 0 where nothing flows, and in lanes that are not used: they have no share.
template <class V>
DYNASURF_INLINE V inverse(V diagonal, V share) {
  // Not 0 of one condition or of another: gcc 12 joins the two, and then asks for every lane on its own.
  const V d = 1 / where_greater(share, V{}, diagonal, V(INFINITY));
  return where_greater(diagonal, V{}, d, V{});
}

/// Fills slice `k` of level `coarse` with what its cells know of the data of `fine`.
void coarsen_slice(const Level& fine, const Level& coarse, int k);

}  // namespace dynasurf::field::multigrid
