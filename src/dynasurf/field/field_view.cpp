#include "dynasurf/field/detail/field_view.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf::field {
namespace {

/// Largest square of a vector's length; NaN where one is. Bits of doubles that are not negative grow as they do, and
/// those of NaN are the largest: whole numbers have a maximum that vectors take.
DYNASURF_CLONES
double largest_square(const float* __restrict x, const float* __restrict y, const float* __restrict z,
                      std::size_t count) {
  std::uint64_t largest = 0;
  for (std::size_t v = 0; v < count; ++v) {
    const double a = x[v], b = y[v], c = z[v];
    largest = std::max(largest, std::bit_cast<std::uint64_t>(a * a + b * b + c * c));
  }
  return std::bit_cast<double>(largest);
}

}  // namespace

Vec3 FieldView::at(int i, int j, int k) const {
  if (dense_ == nullptr) return band_->at(i, j, k);
  const std::size_t v = dense_->grid.index(i, j, k);
  return {dense_->x[v], dense_->y[v], dense_->z[v]};
}

Vec3 FieldView::at_point(const Vec3& grid_mm, Sampling how, const Vec3& velocity) const {
  return dense_ != nullptr ? sample(*dense_, grid_mm, how, velocity) : sample(*band_, grid_mm, how, velocity);
}

double FieldView::largest() const {
  if (dense_ == nullptr) return band_->largest();
  return std::sqrt(largest_square(dense_->x.data(), dense_->y.data(), dense_->z.data(), dense_->x.size()));
}

}  // namespace dynasurf::field
