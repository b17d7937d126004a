#pragma once
// Deformable models: particles, forces, solvers, contours: all public headers of this module.

#include "dynasurf/dynamics/contour/contours.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/dynamics/options.hpp"
#include "dynasurf/dynamics/particles.hpp"
#include "dynasurf/dynamics/solvers/solver.hpp"
