#include <array>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/motion.hpp"

namespace dynasurf::mesh {
namespace {

constexpr std::array<std::string_view, 4> kNames{"linear", "periodic_cubic", "catmull_rom", "b_spline"};

/// Share of each key in the point `a` of the way from key `i` to the next. The shares do not depend on the data, so
/// one set of them serves all vertices.
std::vector<double> linear_shares(std::size_t n, std::size_t i, double a) {
  std::vector<double> share(n, 0.0);
  share[i] += 1 - a;
  share[(i + 1) % n] += a;
  return share;
}

/// The periodic cubic spline with equal intervals. Its second derivatives m solve
/// m[k-1] + 4 m[k] + m[k+1] = 6 (p[k+1] - 2 p[k] + p[k-1]) around the cycle; the inverse of this circulant matrix is
/// known in closed form: z^|k| / (2 sqrt 3) with z = sqrt 3 - 2, wrapped around the cycle.
std::vector<double> cubic_shares(std::size_t n, std::size_t i, double a) {
  std::vector<double> share = linear_shares(n, i, a);
  if (a == 0) return share;  // a key is met in its own bytes
  const double b = 1 - a;
  const double m_here = (b * b * b - b) / 6, m_next = (a * a * a - a) / 6;
  const double z = std::sqrt(3.0) - 2;
  const auto inverse = [&](std::size_t k) {
    const double wrapped = own::pow(z, k) + own::pow(z, n - k);
    return wrapped / (1 - own::pow(z, n)) / (2 * std::sqrt(3.0));
  };
  for (std::size_t g = 0; g < n; ++g) {
    const double q = m_here * inverse((g + n - i) % n) + m_next * inverse((g + 2 * n - i - 1) % n);
    share[(g + 1) % n] += 6 * q;
    share[g] -= 12 * q;
    share[(g + n - 1) % n] += 6 * q;
  }
  return share;
}

/// Four neighbouring keys with the weights of a uniform cubic. Fewer keys than four share places around the cycle.
std::vector<double> local_shares(std::size_t n, std::size_t i, const std::array<double, 4>& weights) {
  std::vector<double> share(n, 0.0);
  for (std::size_t k = 0; k < 4; ++k) share[(i + n * 4 + k - 1) % n] += weights[k];
  return share;
}

std::vector<double> catmull_rom_shares(std::size_t n, std::size_t i, double a) {
  const double b = 1 - a;
  return local_shares(
      n, i, {-a * b * b / 2, (2 - 5 * a * a + 3 * a * a * a) / 2, (2 - 5 * b * b + 3 * b * b * b) / 2, -a * a * b / 2});
}

std::vector<double> b_spline_shares(std::size_t n, std::size_t i, double a) {
  const double b = 1 - a;
  return local_shares(
      n, i, {b * b * b / 6, (4 - 6 * a * a + 3 * a * a * a) / 6, (4 - 6 * b * b + 3 * b * b * b) / 6, a * a * a / 6});
}

std::vector<double> shares_of(TimeInterpolation how, std::size_t n, std::size_t i, double a) {
  switch (how) {
    case TimeInterpolation::linear:
      return linear_shares(n, i, a);
    case TimeInterpolation::periodic_cubic:
      return cubic_shares(n, i, a);
    case TimeInterpolation::catmull_rom:
      return catmull_rom_shares(n, i, a);
    case TimeInterpolation::b_spline:
      break;
  }
  return b_spline_shares(n, i, a);
}

void check_same_triangles(std::span<const TriMesh> cycle) {
  if (cycle.empty()) throw InputError("at_phase: no meshes; expected at least one");
  for (std::size_t g = 1; g < cycle.size(); ++g)
    if (cycle[g].vertices.size() != cycle[0].vertices.size() || cycle[g].triangles != cycle[0].triangles)
      throw InputError("at_phase: mesh " + std::to_string(g + 1) +
                       " has other triangles than mesh 1; expected meshes grown from one start");
}

}  // namespace

std::span<const std::string_view> names_of(TimeInterpolation) { return kNames; }

TriMesh at_phase(std::span<const TriMesh> cycle, double phase, TimeInterpolation how) {
  check_same_triangles(cycle);
  if (!std::isfinite(phase)) throw InputError("at_phase: the phase is not finite; expected a number in [0, 1)");
  const std::size_t n = cycle.size();
  double keys_passed = (phase - std::floor(phase)) * n;
  // g/n times n need not be g again.
  if (std::abs(keys_passed - std::round(keys_passed)) < 1e-12 * n) keys_passed = std::round(keys_passed);
  const double whole = std::floor(keys_passed);
  const std::size_t passed = whole, i = passed % n;
  const double a = keys_passed - whole;
  const std::vector<double> share = shares_of(how, n, i, a);

  TriMesh mesh{std::vector<Vec3>(cycle[0].vertices.size(), Vec3::Zero()), cycle[0].triangles};
  for (std::size_t g = 0; g < n; ++g) {
    if (share[g] == 0) continue;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) mesh.vertices[v] += share[g] * cycle[g].vertices[v];
  }
  return mesh;
}

}  // namespace dynasurf::mesh
