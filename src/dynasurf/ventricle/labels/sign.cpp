#include "dynasurf/ventricle/labels/detail/method.hpp"
#include "dynasurf/ventricle/labels/detail/slice_flow.hpp"

namespace dynasurf::ventricle {

Mask label(const LabelScene& scene, const SignLabels& method, Labels& labels) {
  const Image& image = scene.image;
  const field::VectorField field = slice_flow(image, method.flow);
  Mask borders(image.grid);
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for_each_line(image, field, k, [&](const FieldLine& line, double longest) {
      for (const std::size_t n : meeting_points(line, method.least_change * longest))
        borders(line.pixels[n].i, line.pixels[n].j, k) = either_wall;
    });
  note_not_told_apart(labels.notes);
  return clip(std::move(borders), {scene.coarse.x_px, scene.coarse.y_px, 0, 0}, scene.coarse.radius_px);
}

}  // namespace dynasurf::ventricle
