#include "dynasurf/synthetic/detail/plane_filter.hpp"

#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::synthetic {
PlaneFilter make_plane_filter(int n, const std::function<double(int k, int l, int size)>& response) {
  PlaneFilter f;
  f.n = n;
  f.size = power_of_two(2 * n);
  f.table = make_fourier_table(f.size);
  const auto signed_of = [&](int k) { return k < f.size / 2 ? k : k - f.size; };
  for (int k = 0; k < f.size; ++k)
    for (int l = 0; l < f.size; ++l) f.response.push_back(response(signed_of(k), signed_of(l), f.size));
  return f;
}

void filter_planes(const PlaneFilter& f, std::span<float> first, std::span<float> second) {
  const std::size_t n = f.n, size = f.size;
  std::vector<std::vector<Complex>> rows(n, std::vector<Complex>(size));
  for (std::size_t a = 0; a < n; ++a) {
    for (std::size_t z = 0; z < n; ++z) rows[a][z] = {first[a * n + z], second[a * n + z]};
    transform(f.table, rows[a], -1);
  }
  std::vector<Complex> line(size);
  for (std::size_t l = 0; l < size; ++l) {
    for (std::size_t a = 0; a < size; ++a) line[a] = a < n ? rows[a][l] : Complex{};
    transform(f.table, line, -1);
    for (std::size_t k = 0; k < size; ++k)
      line[k].re *= f.response[k * size + l], line[k].im *= f.response[k * size + l];
    transform(f.table, line, 1);
    for (std::size_t a = 0; a < n; ++a) rows[a][l] = line[a];
  }
  const double scale = 1.0 / (size * size);
  for (std::size_t a = 0; a < n; ++a) {
    transform(f.table, rows[a], 1);
    for (std::size_t z = 0; z < n; ++z) {
      first[a * n + z] = rows[a][z].re * scale;
      second[a * n + z] = rows[a][z].im * scale;
    }
  }
}

std::vector<double> ramp_spectrum(int size) {
  std::vector<double> spectrum;
  for (int k = 0; k < size; ++k) {
    double sum = 0.25;
    for (int n = 1; n < size / 2; n += 2)
      sum -= 2 / (M_PI * M_PI * n * n) * own::cos(2 * M_PI * ((static_cast<long>(k) * n) % size) / size);
    spectrum.push_back(sum);
  }
  return spectrum;
}

}  // namespace dynasurf::synthetic
