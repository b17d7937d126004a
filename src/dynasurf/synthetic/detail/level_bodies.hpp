#pragma once
#include "dynasurf/core/grid.hpp"

// Bodies like those whose scans the thesis used (PH-CLOUDS, thesis 6.2.3), as levels: about the distance to the
// surface, positive inside, in the box [-1.3, 1.3]^3. The thesis's own scans were not published; these have their genus
// (0), their features (ears, a fluted handle, a face, hair, a bushy tail that nearly meets the back) and a size of
// about 2.
namespace dynasurf::synthetic {

double rabbit_level(const Vec3& p);
double screwdriver_level(const Vec3& p);
double venus_level(const Vec3& p);
double moai_level(const Vec3& p);
double squirrel_level(const Vec3& p);

}  // namespace dynasurf::synthetic
