#include "dynasurf/synthetic/detail/solids.hpp"

#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::synthetic {
namespace {

constexpr int segments = 96, steps = 108;

}  // namespace

TriMesh revolve(const std::vector<ProfilePoint>& profile, int segment_count) {
  DYNASURF_ASSERT(profile.size() >= 3 && segment_count >= 3);
  const double step = 2 * M_PI / segment_count, widen = std::sqrt(step / own::sin(step));
  const std::uint32_t n = segment_count;
  const std::uint32_t rings = profile.size() - 2;
  TriMesh mesh;
  mesh.vertices.push_back({0, 0, profile.front()[1]});
  for (std::uint32_t r = 0; r < rings; ++r)
    for (std::uint32_t s = 0; s < n; ++s) {
      const auto [radius, height] = profile[r + 1];
      mesh.vertices.push_back({widen * radius * own::cos(s * step), widen * radius * own::sin(s * step), height});
    }
  mesh.vertices.push_back({0, 0, profile.back()[1]});

  const auto at = [&](std::uint32_t r, std::uint32_t s) { return 1 + r * n + s % n; };
  const std::uint32_t last = 1 + rings * n;
  for (std::uint32_t s = 0; s < n; ++s) {
    mesh.triangles.push_back({0, at(0, s + 1), at(0, s)});
    for (std::uint32_t r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, s), at(r, s + 1), at(r + 1, s + 1)});
      mesh.triangles.push_back({at(r, s), at(r + 1, s + 1), at(r + 1, s)});
    }
    mesh.triangles.push_back({last, at(rings - 1, s), at(rings - 1, s + 1)});
  }
  return mesh;
}

double volume_ml(const CylinderCup& cup) {
  const double r = cup.radius_mm;
  return (2.0 / 3.0 * M_PI * r * r * r + M_PI * r * r * cup.height_mm) / 1000;
}

TriMesh surface(const CylinderCup& cup) {
  constexpr int half = steps / 2, quarter = steps / 4;
  const double r = cup.radius_mm;
  std::vector<ProfilePoint> profile;
  for (int n = 0; n <= half; ++n) {
    const double angle = M_PI / 2 * n / half;
    profile.push_back({n == 0 ? 0 : r * own::sin(angle), -r * own::cos(angle)});
  }
  for (int n = 1; n <= quarter; ++n) profile.push_back({r, cup.height_mm * n / quarter});
  for (int n = quarter - 1; n >= 0; --n) profile.push_back({r * n / quarter, cup.height_mm});
  return revolve(profile, segments);
}

TriMesh sphere_surface(double radius_mm) {
  std::vector<ProfilePoint> profile;
  for (int n = 0; n <= steps; ++n) {
    const double angle = M_PI * n / steps;
    profile.push_back({n == 0 || n == steps ? 0 : radius_mm * own::sin(angle), -radius_mm * own::cos(angle)});
  }
  return revolve(profile, segments);
}

}  // namespace dynasurf::synthetic
