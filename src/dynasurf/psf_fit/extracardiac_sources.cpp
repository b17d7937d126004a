#include "dynasurf/psf_fit/detail/extracardiac_sources.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::psf_fit {
namespace {

constexpr double own_sigma_mm = 3;    // of a spot before the blur
constexpr float least_seen = 1e-12F;  // of its peak: products of smaller values are subnormal, which slows processors

struct Profiles {
  std::vector<float> along[3];
};

/// Variances add: of the blur, of the spot, and of the mean over a pixel, whose side squared counts a twelfth.
double sigma_of(const BeatProblem& problem) {
  const double coarsest = problem.pixels.spacing.maxCoeff();
  return std::sqrt(problem.sigma_mm * problem.sigma_mm + own_sigma_mm * own_sigma_mm + coarsest * coarsest / 12);
}

Profiles profiles(const BeatProblem& problem, const Vec3& centre) {
  const double sigma = sigma_of(problem);
  Profiles p;
  for (int a = 0; a < 3; ++a)
    for (int n = 0; n < problem.pixels.count[a]; ++n) {
      const double x = problem.pixels.centre(a, n) - centre[a];
      p.along[a].push_back(own::exp(-x * x / (2 * sigma * sigma)));
    }
  return p;
}

/// Sum over all pixels of values times the spot's image around each pixel: separable.
std::vector<float> correlate(const BeatProblem& problem, const std::vector<float>& values, double power) {
  // A power of a Gaussian is a narrower one.
  const double sigma = sigma_of(problem) / std::sqrt(power);
  const Index3 dims = problem.pixels.count;
  std::vector<float> in = values, out;
  const Index stride[3] = {1, dims[0], Index{dims[0]} * dims[1]};
  for (int a = 0; a < 3; ++a) {
    const double pitch = problem.pixels.spacing[a] * problem.pixels.joined[a];
    const int reach = 3 * sigma / pitch;
    const int length = dims[a];
    out.assign(in.size(), 0.0F);
    for (Index n = 0; n < std::ssize(in); ++n) {
      const int at = n / stride[a] % length;
      for (int lag = std::max(-reach, -at); lag <= std::min(reach, length - 1 - at); ++lag) {
        const double x = lag * pitch;
        const float k = own::exp(-x * x / (2 * sigma * sigma));
        out[n] += k * in[n + lag * stride[a]];
      }
    }
    in.swap(out);
  }
  return in;
}

}  // namespace

std::vector<float> blob_image(const BeatProblem& problem, const ExtracardiacSource& blob) {
  const Profiles p = profiles(problem, blob.centre);
  std::vector<float> image;
  image.reserve(problem.pixels.size());
  for (const float z : p.along[2])
    for (const float y : p.along[1])
      for (const float x : p.along[0]) {
        const float seen = x * y * z;
        image.push_back(seen < least_seen ? 0 : seen);
      }
  return image;
}

std::vector<ExtracardiacSource> find_extracardiac_sources(const BeatProblem& problem, const Objective& objective,
                                                          const std::vector<bool>& allowed, double least, int most) {
  constexpr int passes = 6;
  const Index3 dims = problem.pixels.count;
  std::vector<float> missing(problem.pixels.size(), 0.0F);  // data less model, weighted
  const float gates = objective.residual.size();
  for (const auto& residual : objective.residual)
    for (std::size_t n = 0; n < missing.size(); ++n) missing[n] -= residual[n] / gates;
  const std::vector<float> norm = correlate(problem, problem.weight, 2);
  std::vector<ExtracardiacSource> blobs;
  for (int pass = 0; pass < passes && std::ssize(blobs) < most; ++pass) {
    std::vector<float> weighted(missing.size());
    for (std::size_t n = 0; n < missing.size(); ++n) weighted[n] = missing[n] * problem.weight[n];
    std::vector<float> amplitude = correlate(problem, weighted, 1);
    for (std::size_t n = 0; n < missing.size(); ++n)
      // By least squares for a spot at this pixel alone: residual times spot, over spot squared.
      amplitude[n] = allowed[n] && norm[n] > 0 ? amplitude[n] / norm[n] : 0;
    std::vector<std::size_t> order;
    for (std::size_t n = 0; n < missing.size(); ++n)
      if (amplitude[n] > least) order.push_back(n);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return amplitude[a] > amplitude[b]; });
    const double apart = 2.2 * sigma_of(problem);
    std::vector<Vec3> taken;
    for (const std::size_t n : order) {
      const std::size_t row = dims[0], plane = row * dims[1];
      const Vec3 centre(problem.pixels.centre(0, n % row), problem.pixels.centre(1, n % plane / row),
                        problem.pixels.centre(2, n / plane));
      const bool near =
          std::any_of(taken.begin(), taken.end(), [&](const Vec3& t) { return (t - centre).norm() < apart; });
      if (near || std::ssize(blobs) >= most) continue;
      taken.push_back(centre);
      blobs.push_back({centre});
      const std::vector<float> image = blob_image(problem, blobs.back());
      for (std::size_t v = 0; v < missing.size(); ++v) missing[v] -= 0.8F * amplitude[n] * image[v];
    }
    if (taken.empty()) break;
  }
  return blobs;
}

}  // namespace dynasurf::psf_fit
