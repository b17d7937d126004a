#include <algorithm>
#include <array>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/field/band.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::field {

namespace {

constexpr std::array<std::string_view, 3> sampling_names{"nearest", "trilinear", "neighbour"};

Vec3 at(const VectorField& f, int i, int j, int k) {
  const std::size_t v = f.grid.index(i, j, k);
  return {f.x[v], f.y[v], f.z[v]};
}
const Grid& grid_of(const VectorField& f) { return f.grid; }

Vec3 at(const BandField& f, int i, int j, int k) { return f.at(i, j, k); }
const Grid& grid_of(const BandField& f) { return f.grid(); }

Index3 nearest_voxel(const Grid& g, const Vec3& p) {
  Index3 v;
  for (int a = 0; a < 3; ++a) v[a] = whole_within(p[a] / g.spacing[a] + 0.5, g.dims[a]);
  return v;
}

/// Mean of the eight corners of the block from voxel `a` to voxel `b`, which may coincide along an axis.
template <class F>
Vec3 mean_of_block(const F& f, const Index3& a, const Index3& b) {
  Vec3 sum = Vec3::Zero();
  for (int k : {a[2], b[2]})
    for (int j : {a[1], b[1]})
      for (int i : {a[0], b[0]}) sum += at(f, i, j, k);
  return sum / 8;
}

template <class F>
Vec3 trilinear(const F& f, const Vec3& p) {
  const Grid& g = grid_of(f);
  Index3 low, high;
  Vec3 t;
  for (int a = 0; a < 3; ++a) {
    const int last = g.dims[a] - 1;
    const double position = std::clamp<double>(p[a] / g.spacing[a], 0, last);
    low[a] = whole_within(position, g.dims[a]);
    high[a] = std::min(low[a] + 1, last);
    t[a] = position - low[a];
  }
  const auto along_x = [&](int j, int k) -> Vec3 {
    return (1 - t[0]) * at(f, low[0], j, k) + t[0] * at(f, high[0], j, k);
  };
  const auto along_y = [&](int k) -> Vec3 { return (1 - t[1]) * along_x(low[1], k) + t[1] * along_x(high[1], k); };
  return (1 - t[2]) * along_y(low[2]) + t[2] * along_y(high[2]);
}

template <class F>
Vec3 sample_any(const F& field, const Vec3& grid_mm, Sampling how, const Vec3& velocity) {
  if (how == Sampling::trilinear) return trilinear(field, grid_mm);
  const Grid& g = grid_of(field);
  const Index3 own = nearest_voxel(g, grid_mm);
  if (how == Sampling::nearest) return at(field, own[0], own[1], own[2]);
  Index3 ahead = own;
  for (std::size_t a = 0; a < 3; ++a) {
    const double v = velocity[a];
    ahead[a] = std::clamp(own[a] + (v > 0) - (v < 0), 0, g.dims[a] - 1);
  }
  return mean_of_block(field, own, ahead);
}

}  // namespace

std::span<const std::string_view> names_of(Sampling) { return sampling_names; }

Vec3 sample(const VectorField& field, const Vec3& grid_mm, Sampling how, const Vec3& velocity) {
  return sample_any(field, grid_mm, how, velocity);
}

Vec3 sample(const BandField& field, const Vec3& grid_mm, Sampling how, const Vec3& velocity) {
  return sample_any(field, grid_mm, how, velocity);
}

}  // namespace dynasurf::field
