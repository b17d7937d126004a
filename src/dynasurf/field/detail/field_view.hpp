#pragma once
#include "dynasurf/field/band.hpp"
#include "dynasurf/field/vector_field.hpp"

namespace dynasurf::field {

/// A field as particles read it, wherever its numbers are kept: of every voxel, or near borders alone. Made from either
/// without a cast; what it is made from must outlive it.
class FieldView {
 public:
  FieldView(const VectorField& field) : dense_(&field) {}
  FieldView(const BandField& field) : band_(&field) {}

  const Grid& grid() const { return dense_ != nullptr ? dense_->grid : band_->grid(); }
  const VectorField* dense() const { return dense_; }  // null for a band
  Vec3 at(int i, int j, int k) const;
  /// As `sample` of the field itself: outside the grid, the nearest voxel; beyond a band, what its coarser cells say.
  Vec3 at_point(const Vec3& grid_mm, Sampling how, const Vec3& velocity = Vec3::Zero()) const;
  /// Largest length of a vector, of a band within it: fields at rest are longest where there are data. Not finite when
  /// the field is not.
  double largest() const;

 private:
  const VectorField* dense_ = nullptr;
  const BandField* band_ = nullptr;
};

}  // namespace dynasurf::field
