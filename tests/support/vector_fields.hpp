#pragma once
#include <algorithm>

#include "dynasurf/field/vector_field.hpp"

// What tests look at in a field.
namespace dynasurf::test {

inline Vec3 at(const field::VectorField& f, int i, int j, int k) {
  const std::size_t v = f.grid.index(i, j, k);
  return {f.x[v], f.y[v], f.z[v]};
}

/// Length of the longest vector.
inline double largest(const field::VectorField& f) {
  double m = 0;
  for (std::size_t v = 0; v < f.x.size(); ++v) m = std::max(m, Vec3(f.x[v], f.y[v], f.z[v]).norm());
  return m;
}

inline bool same_bytes(const field::VectorField& a, const field::VectorField& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}

}  // namespace dynasurf::test
