#pragma once
#include <span>

#include "dynasurf/core/grid.hpp"

namespace dynasurf::psf_fit {

/// Number of real spherical harmonics up to a degree.
constexpr int harmonics_up_to(int degree) { return (degree + 1) * (degree + 1); }

/// The highest degree that harmonics are worked out to.
constexpr int most_harmonic_degree = 24;

/// Degree of the harmonic number `k`.
int degree_of_harmonic(int k);

/// Real spherical harmonics up to `degree` at a unit vector, in the order (l, m) = (0,0), (1,-1), (1,0), (1,1), (2,-2),
/// ...; scaled so that the mean of each one's square over the sphere is 1. `out` has `harmonics_up_to(degree)` places;
/// `degree` is `most_harmonic_degree` at most.
void real_spherical_harmonics(const Vec3& unit, int degree, std::span<double> out);

/// `count` unit vectors that cover the sphere evenly (a Fibonacci lattice, the pole -z first). Each stands for the
/// solid angle 4 pi / count.
Vec3 fibonacci_direction(int n, int count);

}  // namespace dynasurf::psf_fit
