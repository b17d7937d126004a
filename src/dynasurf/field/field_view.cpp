#include "dynasurf/field/detail/field_view.hpp"

#include <cmath>

namespace dynasurf::field {

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
  double largest = 0;
  for (std::size_t v = 0; v < dense_->x.size(); ++v) {
    const double x = dense_->x[v], y = dense_->y[v], z = dense_->z[v];
    const double squared = x * x + y * y + z * z;
    if (!(squared <= largest)) largest = squared;  // lets NaN through, and keeps it
    if (std::isnan(largest)) break;
  }
  return std::sqrt(largest);
}

}  // namespace dynasurf::field
