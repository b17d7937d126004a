#pragma once
#include <array>
#include <cstddef>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::cloud {

/// A cubic lattice. Node (i,j,k) lies at origin + side (i,j,k); the outermost nodes are held outside.
struct Lattice {
  Index3 dims;
  double side;
  Vec3 origin;
  std::size_t size() const { return size_of(dims); }
  std::size_t row() const { return dims[0]; }
  std::size_t slab() const { return size_of({dims[0], dims[1], 1}); }
};

/// The first of the eight nodes around a place, and their weights.
struct Corner {
  std::size_t at = 0;
  std::array<float, 8> weight{};
};

/// Of a place less `shift` steps; false when that is not within the lattice.
inline bool corner_of(const Lattice& l, const Vec3& p, const Vec3& shift, Corner& c) {
  const Vec3 q = (p - l.origin) / l.side - shift;
  std::array<std::size_t, 3> base{};
  std::array<double, 3> part{};
  for (std::size_t a = 0; a < 3; ++a) {
    if (!(q[a] >= 0) || q[a] >= l.dims[a] - 1) return false;
    base[a] = q[a];
    part[a] = q[a] - base[a];
  }
  c.at = base[0] + l.row() * base[1] + l.slab() * base[2];
  for (std::size_t n = 0; n < 8; ++n)
    c.weight[n] = (n & 1 ? part[0] : 1 - part[0]) * (n & 2 ? part[1] : 1 - part[1]) * (n & 4 ? part[2] : 1 - part[2]);
  return true;
}

/// From the first of the eight nodes to each of them.
inline std::array<std::size_t, 8> steps_of(const Lattice& l) {
  std::array<std::size_t, 8> s{};
  for (std::size_t n = 0; n < 8; ++n) s[n] = (n & 1) + (n & 2 ? l.row() : 0) + (n & 4 ? l.slab() : 0);
  return s;
}

}  // namespace dynasurf::cloud
