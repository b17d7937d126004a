#include "dynasurf/core/detail/fourier.hpp"

#include <cmath>
#include <utility>

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf {

int power_of_two(int n) {
  int size = 1;
  while (size < n) size *= 2;
  return size;
}

FourierTable make_fourier_table(int size) {
  FourierTable table;
  table.size = size;
  for (int k = 0; k < size; ++k) {
    table.cosine.push_back(own::cos(2 * M_PI * k / size));
    table.sine.push_back(own::sin(2 * M_PI * k / size));
  }
  return table;
}

void transform(const FourierTable& table, std::span<Complex> line, int sign) {
  const int n = table.size;
  for (int i = 1, j = 0; i < n; ++i) {
    int bit = n >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i < j) std::swap(line[i], line[j]);
  }
  for (int half = 1; half < n; half *= 2)
    for (int start = 0; start < n; start += 2 * half)
      for (int k = 0; k < half; ++k) {
        const double c = table.cosine[k * (n / (2 * half))], s = sign * table.sine[k * (n / (2 * half))];
        Complex &a = line[start + k], &b = line[start + k + half];
        const Complex turned{b.re * c - b.im * s, b.re * s + b.im * c};
        b = {a.re - turned.re, a.im - turned.im};
        a = {a.re + turned.re, a.im + turned.im};
      }
}

void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign) {
  std::size_t stride = 1;
  std::vector<Complex> line;
  for (const FourierTable& table : tables) {
    const std::size_t length = table.size;
    line.resize(length);
    for (std::size_t first = 0; first < box.size(); first += stride * length)
      for (std::size_t s = first; s < first + stride; ++s) {
        for (std::size_t n = 0; n < length; ++n) line[n] = box[s + n * stride];
        transform(table, line, sign);
        for (std::size_t n = 0; n < length; ++n) box[s + n * stride] = line[n];
      }
    stride *= length;
  }
}

}  // namespace dynasurf
