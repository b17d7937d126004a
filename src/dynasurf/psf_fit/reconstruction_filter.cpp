#include "dynasurf/psf_fit/detail/reconstruction_filter.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include <Eigen/QR>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/fourier.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::psf_fit {
namespace {

using Tables = std::array<FourierTable, 3>;

Tables tables_for(const Index3& size) {
  return {make_fourier_table(size[0]), make_fourier_table(size[1]), make_fourier_table(size[2])};
}

/// value(|f|², index) for all frequencies of a box, first axis fastest; f in cycles per mm.
template <class F>
void for_all_frequencies(const Index3& size, const Vec3& spacing, const F& value) {
  const auto frequency = [&](int axis, int k) {
    const int n = size[axis];
    return (k < (n + 1) / 2 ? k : k - n) / (n * spacing[axis]);
  };
  std::size_t at = 0;
  for (int k = 0; k < size[2]; ++k)
    for (int j = 0; j < size[1]; ++j)
      for (int i = 0; i < size[0]; ++i, ++at)
        value(Vec3(frequency(0, i), frequency(1, j), frequency(2, k)).squaredNorm(), at);
}

/// The middle of a study, at most this many voxels along each axis: noise is known well enough from it.
constexpr int most_voxels = 64;
VoxelBox middle_of(const Grid& grid) {
  VoxelBox box;
  for (std::size_t a = 0; a < 3; ++a) {
    box.count[a] = std::min(grid.dims[a], most_voxels);
    box.first[a] = (grid.dims[a] - box.count[a]) / 2;
  }
  return box;
}

/// Third differences of the gates in a box, which fades out towards its rim; two of them as one complex box.
std::vector<Complex> differences(const Study& study, std::size_t gate, const VoxelBox& box, const Index3& size) {
  std::vector<double> fade[3];
  for (std::size_t a = 0; a < 3; ++a)
    for (int n = 0; n < box.count[a]; ++n)
      fade[a].push_back(0.5 - 0.5 * own::cos(2 * M_PI * (n + 1) / (box.count[a] + 1)));
  const std::size_t gates = study.gates.size();
  const auto difference = [&](std::size_t g, int i, int j, int k) {
    const auto of = [&](std::size_t later) -> double { return study.gates[(g + later) % gates](i, j, k); };
    const double value = of(0) - 3 * of(1) + 3 * of(2) - of(3);
    return std::isfinite(value) ? value : 0.0;
  };
  std::vector<Complex> noise(size_of(size));
  for (int k = 0; k < box.count[2]; ++k)
    for (int j = 0; j < box.count[1]; ++j)
      for (int i = 0; i < box.count[0]; ++i) {
        const double share = fade[0][i] * fade[1][j] * fade[2][k];
        const int x = box.first[0] + i, y = box.first[1] + j, z = box.first[2] + k;
        const std::size_t at = index_in(size, {i, j, k});
        noise[at] = {share * difference(gate, x, y, z), gate + 1 < gates ? share * difference(gate + 1, x, y, z) : 0.0};
      }
  return noise;
}

/// Power of the noise by |f|.
struct Spectrum {
  std::vector<double> frequency, log_power;
};
Spectrum spectrum_of_noise(const Study& study) {
  const Grid& grid = study.grid();
  const VoxelBox box = middle_of(grid);
  Index3 size;
  for (std::size_t a = 0; a < 3; ++a) size[a] = power_of_two(box.count[a]);
  const Tables tables = tables_for(size);
  const std::size_t pairs = (study.gates.size() + 1) / 2;
  constexpr int shells = 34;
  const double nyquist = 0.5 / grid.spacing.maxCoeff(), lowest = 0.1 * nyquist, width = 0.85 * nyquist / shells;
  std::vector<std::uint8_t> shell(size_of(size));  // `shells` where a frequency lies in none
  std::array<double, shells> number{};
  for_all_frequencies(size, grid.spacing, [&](double square, std::size_t at) {
    const double place = (std::sqrt(square) - lowest) / width;
    const bool is_in = place >= 0 && place < shells;
    shell[at] = is_in ? place : shells;
    if (is_in) number[shell[at]] += 1;
  });
  std::vector<std::array<double, shells + 1>> power(pairs);
  parallel_for(pairs, 1, [&](std::size_t pair, std::size_t) {
    std::vector<Complex> noise = differences(study, 2 * pair, box, size);
    transform_box(tables, noise, -1);
    power[pair].fill(0);
    // Summed over both signs of f the real and the imaginary part's powers add.
    for (std::size_t at = 0; at < noise.size(); ++at)
      power[pair][shell[at]] += noise[at].re * noise[at].re + noise[at].im * noise[at].im;
  });
  Spectrum spectrum;
  for (std::size_t s = 0; s < shells; ++s) {
    double sum = 0;
    for (const auto& of_pair : power) sum += of_pair[s];
    if (!(sum > 0) || number[s] == 0) continue;
    spectrum.frequency.push_back(lowest + (s + 0.5) * width);
    spectrum.log_power.push_back(own::log(sum / number[s]));
  }
  return spectrum;
}

/// Root mean square of what a ramp, a Gaussian and a Butterworth filter (cutoff 0: none) leave of the logarithm.
double misfit(const Spectrum& spectrum, const ReconstructionFilter& filter) {
  const Eigen::Index n = spectrum.frequency.size();
  Eigen::MatrixXd shape(n, 3);
  Eigen::VectorXd left(n);
  for (Eigen::Index s = 0; s < n; ++s) {
    const double f = spectrum.frequency[s];
    shape.row(s) << 1, own::log(f), -f * f;
    left[s] = spectrum.log_power[s];
    if (filter.cutoff_per_mm > 0) left[s] += own::log(1 + own::pow(f / filter.cutoff_per_mm, 2 * filter.order));
  }
  const Eigen::VectorXd three = shape.householderQr().solve(left);
  if (three[2] >= 0) return std::sqrt((shape * three - left).squaredNorm() / n);
  // No filter makes the fine ones stronger.
  const Eigen::MatrixXd two = shape.leftCols(2);
  return std::sqrt((two * two.householderQr().solve(left) - left).squaredNorm() / n);
}

/// What it makes of a frequency, f² given, when a Gaussian takes the filter's place.
double exchanged(const ReconstructionFilter& filter, double sigma_mm, double square) {
  const double gaussian = own::exp(-2 * M_PI * M_PI * sigma_mm * sigma_mm * square);
  return gaussian * std::sqrt(1 + own::pow(square / (filter.cutoff_per_mm * filter.cutoff_per_mm), filter.order));
}

}  // namespace

std::optional<ReconstructionFilter> filter_in_noise(const Study& study) {
  constexpr std::size_t least_gates = 6, least_shells = 20;
  if (study.gates.size() < least_gates) return std::nullopt;
  const Spectrum spectrum = spectrum_of_noise(study);
  if (spectrum.frequency.size() < least_shells) return std::nullopt;
  const double gaussian = misfit(spectrum, {0, 0});
  ReconstructionFilter best;
  double least = std::numeric_limits<double>::infinity();
  constexpr double step_per_mm = 0.001;
  for (double cutoff = 0.015; cutoff < 0.9 * spectrum.frequency.back(); cutoff += step_per_mm)
    for (const double order : {3.0, 4.0, 5.0, 6.0, 8.0, 10.0}) {
      const double rms = misfit(spectrum, {cutoff, order});
      if (rms < least) least = rms, best = {cutoff, order};
    }
  // Filtered backprojections of experiments/camera leave 0.06 to 0.10, a third of what a Gaussian does; others as much.
  if (!(least < 0.15 && least < 0.5 * gaussian)) return std::nullopt;
  return best;
}

double gaussian_in_place_of(const ReconstructionFilter& filter) {
  constexpr double most = 1.5;
  double low = 0, high = 1 / filter.cutoff_per_mm;
  for (int halving = 0; halving < 40; ++halving) {
    const double sigma = 0.5 * (low + high);
    double largest = 0;
    for (int n = 1; n <= 80; ++n)
      largest = std::max(largest, exchanged(filter, sigma, own::pow(0.05 * n * filter.cutoff_per_mm, 2)));
    (largest > most ? low : high) = sigma;
  }
  return high;
}

Study with_gaussian_filter(const Study& study, const ReconstructionFilter& filter, double sigma_mm,
                           const VoxelBox& box) {
  // As far as the filter's lobes reach.
  const Grid& grid = study.grid();
  Index3 size;
  for (int a = 0; a < 3; ++a) {
    size[a] = power_of_two(box.count[a] + ceil_int(1 / (filter.cutoff_per_mm * grid.spacing[a])));
  }
  const Tables tables = tables_for(size);
  std::vector<double> factor(size_of(size));
  for_all_frequencies(size, grid.spacing, [&](double square, std::size_t at) {
    factor[at] = exchanged(filter, sigma_mm, square) / factor.size();
  });
  // Beyond the box half of what is added continues its end, half its beginning.
  std::vector<int> source[3];
  for (std::size_t a = 0; a < 3; ++a)
    for (int n = 0; n < size[a]; ++n) {
      const int added = n - box.count[a];
      const int inside = added < 0 ? n : added < (size[a] - box.count[a]) / 2 ? box.count[a] - 1 : 0;
      source[a].push_back(box.first[a] + inside);
    }
  Study refiltered = study;
  const std::size_t gates = study.gates.size();
  parallel_for((gates + 1) / 2, 1, [&](std::size_t pair, std::size_t) {
    const std::size_t first = 2 * pair, second = std::min(first + 1, gates - 1);
    std::vector<Complex> values(size_of(size));
    std::size_t at = 0;
    for (const int k : source[2])
      for (const int j : source[1])
        for (const int i : source[0]) values[at++] = {study.gates[first](i, j, k), study.gates[second](i, j, k)};
    transform_box(tables, values, -1);
    for (std::size_t n = 0; n < values.size(); ++n) values[n].re *= factor[n], values[n].im *= factor[n];
    transform_box(tables, values, 1, {{0, 0, 0}, box.count});
    for (int k = 0; k < box.count[2]; ++k)
      for (int j = 0; j < box.count[1]; ++j)
        for (int i = 0; i < box.count[0]; ++i) {
          const Complex& v = values[index_in(size, {i, j, k})];
          const int x = box.first[0] + i, y = box.first[1] + j, z = box.first[2] + k;
          refiltered.gates[first](x, y, z) = v.re;
          refiltered.gates[second](x, y, z) = first == second ? v.re : v.im;
        }
  });
  return refiltered;
}

}  // namespace dynasurf::psf_fit
