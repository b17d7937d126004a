#include "dynasurf/ventricle/labels/detail/method.hpp"

namespace dynasurf::ventricle {

Mask label(const LabelScene& scene, const NoLabels&, Labels& labels) {
  Mask borders = to_mask(scene.inside, scene.image.grid);
  for (auto& v : borders.values) v = v ? either_wall : 0;
  note_not_told_apart(labels.notes);
  return borders;
}

}  // namespace dynasurf::ventricle
