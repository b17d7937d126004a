#pragma once
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/io/detail/png.hpp"

namespace dynasurf::report {

/// An instant of the beat with its walls in the world frame; a wall that is not there is null.
struct SplashRow {
  const Image* image = nullptr;
  const TriMesh *endo = nullptr, *epi = nullptr;
};
/// The same eight slices of the heart at several instants, a row each, from the apex on: the inner wall blue, the outer
/// one orange. Without words: the same bytes wherever it is drawn. `rows` are not empty, and the first has a wall.
io::Picture draw_splash(const std::vector<SplashRow>& rows);

}  // namespace dynasurf::report
