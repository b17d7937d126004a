#pragma once
// Triangle meshes: shapes, measures, repair, simplification, smoothing, motion: all public headers of this module.

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/contour_stack.hpp"
#include "dynasurf/mesh/edge_order.hpp"
#include "dynasurf/mesh/intersections.hpp"
#include "dynasurf/mesh/marching.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/motion.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/mesh/simplify.hpp"
#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/mesh/tetrahedra.hpp"
