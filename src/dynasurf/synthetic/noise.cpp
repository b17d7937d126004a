#include "dynasurf/synthetic/detail/noise.hpp"

#include <algorithm>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf::synthetic {
namespace {

constexpr std::size_t voxels_per_piece = 4096;
// Normal and Poisson deviates of the same voxel must not share their random numbers.
constexpr std::uint64_t gaussian_streams = std::uint64_t{1} << 32;

template <class Draw>
Image redraw(Image image, std::uint64_t seed, std::uint64_t stream, const Draw& draw) {
  parallel_for(image.values.size(), voxels_per_piece, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      Random random(seed, stream, v);
      image.values[v] = draw(random, image.values[v]);
    }
  });
  return image;
}

}  // namespace

Image draw_counts(const Image& mean_counts, std::uint64_t seed, std::uint64_t stream) {
  return redraw(mean_counts, seed, stream,
                [](Random& random, double mean) { return random.poisson(std::max(0.0, mean)); });
}

Image add_gaussian_noise(Image image, double sd, std::uint64_t seed, std::uint64_t stream) {
  return redraw(std::move(image), seed, gaussian_streams + stream,
                [sd](Random& random, double value) { return value + sd * random.normal(); });
}

}  // namespace dynasurf::synthetic
