#include "dynasurf/field/multigrid/detail/prolong_rows.hpp"

namespace dynasurf::field::multigrid {

void correct_black(Level& fine, const Level& coarse, float stretch, int k0, int k1, int j0, int j1) {
  interpolate<false>(fine, coarse, stretch, k0, k1, j0, j1);
}

}  // namespace dynasurf::field::multigrid
