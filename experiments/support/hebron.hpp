#pragma once
// The Hebron phantom with its borders and fields, for the experiments on deformable models.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::experiments {

inline const Image& hebron() {
  static const Image image = synthetic::make_phantom(synthetic::Hebron{}).study.gates.front();
  return image;
}

/// Its outer border at 20 % of the maximum, closed by a cover of 35 mm, and the border of its cavity.
inline const Image& outer_border() {
  static const Image border = synthetic::external_border(hebron(), 0.2, 35);
  return border;
}
inline const Image& inner_border() {
  static const Image border = synthetic::internal_border(hebron());
  return border;
}

/// The default field of a border, made once; `border` must outlive the program's last use of it.
inline const field::VectorField& field_of(const Image& border) {
  static std::vector<std::pair<const Image*, std::unique_ptr<field::VectorField>>> fields;
  for (const auto& [of, field] : fields)
    if (of == &border) return *field;
  fields.emplace_back(&border, std::make_unique<field::VectorField>(field::flow_field(border, field::Gvf{}).field));
  return *fields.back().second;
}

/// Share of the vertices closer than one voxel to the centre of a border voxel, in per cent.
inline double near_percent(const TriMesh& mesh, const Image& border) {
  const std::vector<double> d = mesh::distances_to_border_voxels(mesh, border);
  return 100.0 * static_cast<double>(std::count_if(d.begin(), d.end(), [](double x) { return x < 1; })) /
         static_cast<double>(d.size());
}

}  // namespace dynasurf::experiments
