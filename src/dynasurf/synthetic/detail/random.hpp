#pragma once
#include <cstdint>

namespace dynasurf::synthetic {

/// A stream of random numbers that is fully fixed by `seed`, `stream` and `position`, on every machine and for any
/// thread count: give each voxel its own `position` and voxels can be drawn in any order. The generator is SplitMix64;
/// the samplers are written here because those of the standard library may differ between implementations.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0, std::uint64_t position = 0);

  std::uint64_t next();
  /// Uniform in the open interval (0, 1).
  double uniform();
  /// Standard normal, by the polar method.
  double normal();
  /// Poisson with mean >= 0: by multiplication of uniforms below 10, by transformed rejection (Hörmann 1993, PTRS)
  /// from there on. A mean of 0 gives 0.
  double poisson(double mean);

 private:
  std::uint64_t state_;
};

}  // namespace dynasurf::synthetic
