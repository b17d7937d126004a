#include "dynasurf/core/detail/fourier.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf {
namespace {

/// Lines of a box that are transformed together.
constexpr std::size_t together = 16;

/// Numbers of lines side by side, in the order of the table's `turned`.
struct Lines {
  Lines(std::size_t length, std::size_t count) : re(length * count), im(length * count) {}
  std::vector<double> re, im;  // [place][line]
};

/// Numbers of lines at two places become their sums and differences, the second ones turned before.
template <std::size_t count>
DYNASURF_INLINE void butterfly(double c, double s, double* __restrict a_re, double* __restrict a_im,
                               double* __restrict b_re, double* __restrict b_im) {
  for (std::size_t l = 0; l < count; ++l) {
    const double turned_re = b_re[l] * c - b_im[l] * s, turned_im = b_re[l] * s + b_im[l] * c;
    b_re[l] = a_re[l] - turned_re, b_im[l] = a_im[l] - turned_im;
    a_re[l] = a_re[l] + turned_re, a_im[l] = a_im[l] + turned_im;
  }
}

template <std::size_t count>
DYNASURF_INLINE void butterflies(const FourierTable& table, double* re, double* im, int sign) {
  const std::size_t n = table.size;
  for (std::size_t half = 1; half < n; half *= 2)
    for (std::size_t start = 0; start < n; start += 2 * half)
      for (std::size_t k = 0; k < half; ++k) {
        const std::size_t turn = k * (n / (2 * half)), a = (start + k) * count, b = a + half * count;
        butterfly<count>(table.cosine[turn], sign * table.sine[turn], re + a, im + a, re + b, im + b);
      }
}

/// Some lines of a box: how far the next one is, and in a line the next number. Either is 1.
struct Bundle {
  std::size_t apart, stride, count;
};

/// at(place in the box, place in the line, line) for all numbers, as they lie in the box.
template <class F>
DYNASURF_INLINE void for_all_numbers(const Bundle& bundle, std::size_t length, const F& at) {
  if (bundle.apart == 1)
    for (std::size_t n = 0; n < length; ++n)
      for (std::size_t l = 0; l < bundle.count; ++l) at(n * bundle.stride + l, n, l);
  else
    for (std::size_t l = 0; l < bundle.count; ++l)
      for (std::size_t n = 0; n < length; ++n) at(l * bundle.apart + n, n, l);
}

/// Transforms lines, unless all are zeros.
DYNASURF_CLONES
void transform_bundle(const FourierTable& table, int sign, const Bundle& bundle, Lines& lines,
                      Complex* __restrict box) {
  double* const __restrict re = lines.re.data(), * const __restrict im = lines.im.data();
  const std::uint32_t* const turned = table.turned.data();
  const std::size_t length = table.size;
  std::uint64_t any = 0;  // bits but for signs: what compares numbers is no vector loop
  for_all_numbers(bundle, length, [&](std::size_t at, std::size_t n, std::size_t l) DYNASURF_INLINE_LAMBDA {
    const std::size_t to = turned[n] * together + l;
    re[to] = box[at].re, im[to] = box[at].im;
    any |= (std::bit_cast<std::uint64_t>(box[at].re) | std::bit_cast<std::uint64_t>(box[at].im)) << 1;
  });
  if (any == 0) return;
  butterflies<together>(table, re, im, sign);
  for_all_numbers(bundle, length, [&](std::size_t at, std::size_t n, std::size_t l) DYNASURF_INLINE_LAMBDA {
    box[at] = {re[n * together + l], im[n * together + l]};
  });
}

}  // namespace

int power_of_two(int n) {
  int size = 1;
  while (size < n) size *= 2;
  return size;
}

FourierTable make_fourier_table(int size) {
  FourierTable table;
  table.size = size;
  std::uint32_t turned = 0;
  for (int k = 0; k < size; ++k) {
    table.cosine.push_back(own::cos(2 * M_PI * k / size));
    table.sine.push_back(own::sin(2 * M_PI * k / size));
    table.turned.push_back(turned);
    std::uint32_t bit = size / 2;
    for (; (turned & bit) != 0; bit /= 2) turned ^= bit;
    turned ^= bit;
  }
  return table;
}

void transform(const FourierTable& table, std::span<Complex> line, int sign) {
  Lines one(line.size(), 1);
  for (std::size_t n = 0; n < line.size(); ++n)
    one.re[table.turned[n]] = line[n].re, one.im[table.turned[n]] = line[n].im;
  butterflies<1>(table, one.re.data(), one.im.data(), sign);
  for (std::size_t n = 0; n < line.size(); ++n) line[n] = {one.re[n], one.im[n]};
}

void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign) {
  transform_box(tables, box, sign, {{0, 0, 0}, {tables[0].size, tables[1].size, tables[2].size}});
}

void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign, const VoxelBox& part) {
  const Index3 size{tables[0].size, tables[1].size, tables[2].size};
  const std::size_t row = size[0], slice = row * size[1];
  constexpr int most = together;
  Lines lines(std::max({size[0], size[1], size[2]}), together);
  // Of axes that are done, lines beside the part are no longer needed. A slice stays near while two axes are done.
  const int first_x = part.first[0], end_x = first_x + part.count[0];
  const int first_y = part.first[1], end_y = first_y + part.count[1];
  const auto transform_from = [&](const Index3& at, std::size_t axis, const Bundle& bundle) {
    transform_bundle(tables[axis], sign, bundle, lines, &box[index_in(size, at)]);
  };
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; j += most)
      transform_from({0, j, k}, 0, {row, 1, static_cast<std::size_t>(std::min(most, size[1] - j))});
    for (int i = first_x; i < end_x; i += most)
      transform_from({i, 0, k}, 1, {1, row, static_cast<std::size_t>(std::min(most, end_x - i))});
  }
  for (int j = first_y; j < end_y; ++j)
    for (int i = first_x; i < end_x; i += most)
      transform_from({i, j, 0}, 2, {1, slice, static_cast<std::size_t>(std::min(most, end_x - i))});
}

}  // namespace dynasurf
