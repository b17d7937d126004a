#include "dynasurf/field/multigrid/detail/prolong_rows.hpp"

namespace dynasurf::field::multigrid {

void start_black(Level& fine, const Level& coarse, int k0, int k1, int j0, int j1) {
  interpolate<true>(fine, coarse, 1, k0, k1, j0, j1);
}

}  // namespace dynasurf::field::multigrid
