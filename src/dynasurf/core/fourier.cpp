#include "dynasurf/core/detail/fourier.hpp"

#include <algorithm>
#include <array>
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

template <std::size_t count>
DYNASURF_INLINE void butterflies(const FourierTable& table, double* re, double* im, int sign) {
  const std::size_t n = table.size;
  for (std::size_t half = 1; half < n; half *= 2)
    for (std::size_t start = 0; start < n; start += 2 * half)
      for (std::size_t k = 0; k < half; ++k) {
        const double c = table.cosine[k * (n / (2 * half))], s = sign * table.sine[k * (n / (2 * half))];
        double *const a_re = re + (start + k) * count, *const b_re = a_re + half * count;
        double *const a_im = im + (start + k) * count, *const b_im = a_im + half * count;
        for (std::size_t l = 0; l < count; ++l) {
          const double turned_re = b_re[l] * c - b_im[l] * s, turned_im = b_re[l] * s + b_im[l] * c;
          b_re[l] = a_re[l] - turned_re, b_im[l] = a_im[l] - turned_im;
          a_re[l] = a_re[l] + turned_re, a_im[l] = a_im[l] + turned_im;
        }
      }
}

/// Some lines of a box: where the first begins, how far the next one is and how far the next number.
struct Bundle {
  std::size_t begin, apart, stride, count;
};

/// Fetches the numbers of lines. False if all are zeros.
template <bool adjacent>
DYNASURF_INLINE bool fetch(const Complex* box, const Bundle& from, const FourierTable& table, Lines& lines) {
  const std::size_t length = table.size, apart = adjacent ? 1 : from.apart;
  bool any = false;
  for (std::size_t n = 0; n < length; ++n) {
    const Complex* const value = box + from.begin + n * from.stride;
    double *const re = &lines.re[table.turned[n] * together], *const im = &lines.im[table.turned[n] * together];
    for (std::size_t l = 0; l < from.count; ++l) {
      re[l] = value[l * apart].re, im[l] = value[l * apart].im;
      any |= re[l] != 0 || im[l] != 0;
    }
  }
  return any;
}

template <bool adjacent>
DYNASURF_INLINE void put_back(const Lines& lines, const Bundle& to, const FourierTable& table, Complex* box) {
  const std::size_t length = table.size, apart = adjacent ? 1 : to.apart;
  for (std::size_t n = 0; n < length; ++n) {
    Complex* const value = box + to.begin + n * to.stride;
    const double *const re = &lines.re[n * together], *const im = &lines.im[n * together];
    for (std::size_t l = 0; l < to.count; ++l) value[l * apart] = {re[l], im[l]};
  }
}

template <bool adjacent>
DYNASURF_INLINE void transform_lines(const FourierTable& table, int sign, const Bundle& bundle, Lines& lines,
                                     Complex* box) {
  if (!fetch<adjacent>(box, bundle, table, lines)) return;
  butterflies<together>(table, lines.re.data(), lines.im.data(), sign);
  put_back<adjacent>(lines, bundle, table, box);
}

DYNASURF_CLONES
void transform_bundle(const FourierTable& table, int sign, const Bundle& bundle, Lines& lines, Complex* box) {
  if (bundle.apart == 1)
    transform_lines<true>(table, sign, bundle, lines, box);
  else
    transform_lines<false>(table, sign, bundle, lines, box);
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
  const std::array<std::size_t, 3> stride{1, size_of({size[0], 1, 1}), size_of({size[0], size[1], 1})};
  Lines lines(std::max({size[0], size[1], size[2]}), together);
  // Of axes that are done, lines beside the part are no longer needed.
  Index3 first{0, 0, 0}, end = size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    first[axis] = 0, end[axis] = 1;
    const std::size_t side = axis == 0 ? 1 : 0;  // along which lines lie side by side
    constexpr int most = together;
    for (int k = first[2]; k < end[2]; ++k)
      for (int j = first[1]; j < end[1]; j += side == 1 ? most : 1)
        for (int i = first[0]; i < end[0]; i += side == 0 ? most : 1) {
          const std::size_t count = std::min(most, side == 0 ? end[0] - i : end[1] - j);
          transform_bundle(tables[axis], sign, {index_in(size, {i, j, k}), stride[side], stride[axis], count}, lines,
                           box.data());
        }
    first[axis] = part.first[axis], end[axis] = part.first[axis] + part.count[axis];
  }
}

}  // namespace dynasurf
