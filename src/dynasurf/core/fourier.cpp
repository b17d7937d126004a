#include "dynasurf/core/detail/fourier.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf {
namespace {

/// Lines of numbers, each number beside those of the other lines at the same place.
struct Lines {
  Lines(std::size_t length, std::size_t count) : re(length * count), im(length * count) {}
  std::vector<double> re, im;  // [place][line]
};

/// Lines of a box that are transformed together.
constexpr std::size_t together = 16;

template <std::size_t count>
DYNASURF_INLINE void butterflies(const FourierTable& table, double* re, double* im, int sign) {
  const std::size_t n = table.size;
  for (std::size_t i = 1, j = 0; i < n; ++i) {
    std::size_t bit = n >> 1;
    for (; (j & bit) != 0; bit >>= 1) j ^= bit;
    j ^= bit;
    if (i >= j) continue;
    std::swap_ranges(re + i * count, re + (i + 1) * count, re + j * count);
    std::swap_ranges(im + i * count, im + (i + 1) * count, im + j * count);
  }
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

DYNASURF_CLONES
void transform_together(const FourierTable& table, double* re, double* im, int sign) {
  butterflies<together>(table, re, im, sign);
}

/// Fetches lines of which each begins somewhere and whose numbers are `stride` apart. False if all are zeros.
bool fetch(const Complex* box, std::span<const std::size_t> begin, std::size_t stride, std::size_t length,
           Lines& lines) {
  bool any = false;
  for (std::size_t n = 0; n < length; ++n)
    for (std::size_t l = 0; l < begin.size(); ++l) {
      const Complex& v = box[begin[l] + n * stride];
      lines.re[n * together + l] = v.re, lines.im[n * together + l] = v.im;
      any = any || v.re != 0 || v.im != 0;
    }
  return any;
}

void put_back(const Lines& lines, std::span<const std::size_t> begin, std::size_t stride, std::size_t length,
              Complex* box) {
  for (std::size_t n = 0; n < length; ++n)
    for (std::size_t l = 0; l < begin.size(); ++l)
      box[begin[l] + n * stride] = {lines.re[n * together + l], lines.im[n * together + l]};
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
  for (int k = 0; k < size; ++k) {
    table.cosine.push_back(own::cos(2 * M_PI * k / size));
    table.sine.push_back(own::sin(2 * M_PI * k / size));
  }
  return table;
}

void transform(const FourierTable& table, std::span<Complex> line, int sign) {
  Lines one(line.size(), 1);
  for (std::size_t n = 0; n < line.size(); ++n) one.re[n] = line[n].re, one.im[n] = line[n].im;
  butterflies<1>(table, one.re.data(), one.im.data(), sign);
  for (std::size_t n = 0; n < line.size(); ++n) line[n] = {one.re[n], one.im[n]};
}

void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign) {
  transform_box(tables, box, sign, {{0, 0, 0}, {tables[0].size, tables[1].size, tables[2].size}});
}

void transform_box(std::span<const FourierTable, 3> tables, std::span<Complex> box, int sign, const VoxelBox& part) {
  const Index3 size{tables[0].size, tables[1].size, tables[2].size};
  Lines lines(std::max({size[0], size[1], size[2]}), together);
  std::vector<std::size_t> begin;
  // Of axes that are done, lines beside the part are no longer needed.
  Index3 first{0, 0, 0}, end = size;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t length = size[axis];
    std::size_t stride = 1;
    for (std::size_t a = 0; a < axis; ++a) stride *= size[a];
    const auto finish = [&] {
      if (fetch(box.data(), begin, stride, length, lines)) {
        transform_together(tables[axis], lines.re.data(), lines.im.data(), sign);
        put_back(lines, begin, stride, length, box.data());
      }
      begin.clear();
    };
    first[axis] = 0, end[axis] = 1;
    for (int k = first[2]; k < end[2]; ++k)
      for (int j = first[1]; j < end[1]; ++j)
        for (int i = first[0]; i < end[0]; ++i) {
          begin.push_back(index_in(size, {i, j, k}));
          if (begin.size() == together) finish();
        }
    finish();
    first[axis] = part.first[axis], end[axis] = part.first[axis] + part.count[axis];
  }
}

}  // namespace dynasurf
