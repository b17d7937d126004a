#pragma once
#include "dynasurf/dynamics/contour/discrete.hpp"

namespace dynasurf::dynamics {

/// The classical snake (SNK-CLASSIC, thesis 3.3.1, eqs 3.20, 3.25, 3.37).
struct Snake {
  double alpha = 0.2;
  double beta = 0.05;
  double step = 0.5;
  double external = 1;
  double edge_px = 1.5;
  int respace_every = 20;
  double still_px = 1e-3;
  int max_steps = 2000;
};
void describe(auto& visit, Snake& o) {
  visit("alpha", o.alpha, OptionInfo{"tension: resists stretching", "", 0, 1e6});
  visit("beta", o.beta, OptionInfo{"rigidity: resists bending", "", 0, 1e6});
  visit("step", o.step, OptionInfo{"time step", "", 1e-6, 1e6});
  visit("external", o.external, OptionInfo{"weight of the field, whose largest vector should be 1", "", 0, 1e3});
  visit("edge_px", o.edge_px, OptionInfo{"distance of the points", "px", 0.1, 1000});
  visit("respace_every", o.respace_every,
        OptionInfo{"steps between two spacings at equal arcs; 0 never", "", 0, 1000000});
  visit("still_px", o.still_px, OptionInfo{"at rest when no point moves farther in a step", "px", 0, 1});
  visit("max_steps", o.max_steps, OptionInfo{"the run ends here in any case", "", 1, 100000000});
}

/// x_t = alpha x'' - beta x'''' + V(x), points one unit of the parameter apart, implicit in the internal part:
/// (I + dt A) x_new = x + dt V(x) with A cyclic and pentadiagonal. Stable for any step as far as the internal part
/// goes. `field` is -grad E of a snake energy, or a gradient vector flow. Closed contours only; an empty field stands
/// for none. Throws InputError and OptionError like `evolve_contour`.
ContourResult evolve_snake(const Contour& start, const field::VectorField& field, const Snake& options);

/// Solves (I + dt A) x = b for a ring of n unknowns, n >= 5, in O(n): the band is factored with its corners
/// eliminated by a small dense system.
std::vector<Vec2> solve_cyclic_pentadiagonal(double main, double next, double second, const std::vector<Vec2>& b);

}  // namespace dynasurf::dynamics
