#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dynasurf/ventricle/labels/detail/method.hpp"
#include "dynasurf/ventricle/labels/detail/mlc.hpp"
#include "dynasurf/ventricle/labels/detail/slice_flow.hpp"

namespace dynasurf::ventricle {
namespace {

/// Quiet points inside the coarse circle where vectors meet; those where they part lie in the middle of the wall.
std::vector<std::size_t> crossings(const FieldLine& line, double longest, const QuietPoints& o, const Circle& coarse) {
  std::vector<std::size_t> points = quiet_points(line, longest, o);
  std::erase_if(points, [&](std::size_t n) {
    const double dx = line.pixels[n].i - coarse.x_px, dy = line.pixels[n].j - coarse.y_px;
    return dx * dx + dy * dy > coarse.radius_px * coarse.radius_px || !(line.along[n - 1] > 0 && line.along[n + 1] < 0);
  });
  return points;
}

}  // namespace

Mask label(const LabelScene& scene, const CaseLabels& method, Labels& labels) {
  const Image& image = scene.image;
  const field::VectorField field = slice_flow(image, method.quiet.flow);
  constexpr std::array<std::uint8_t, 4> four{Labels::epi_bit, Labels::endo_bit, Labels::endo_bit, Labels::epi_bit};
  Mask borders(image.grid);
  int unknown = 0;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for_each_line(image, field, k, [&](const FieldLine& line, double longest) {
      const auto points = crossings(line, longest, method.quiet, scene.coarse);
      unknown += points.size() != 0 && points.size() != 2 && points.size() != 4;
      if (points.size() != 2 && points.size() != 4) return;
      for (std::size_t n = 0; n < points.size(); ++n) {
        const image::Pixel p = line.pixels[points[n]];
        borders(p.i, p.j, k) |= points.size() == 4 ? four[n] : Labels::epi_bit;
      }
    });
  if (unknown > 0)
    labels.notes.push_back(
        {Severity::warning, "case.unknown",
         std::to_string(unknown) + " rows and columns cross neither two nor four borders; they were left out."});
  for (int k = 0; k < image.grid.dims[2] && count_borders(borders, k, scene.axis, 0) < 2; ++k)
    if (!pixels_of(borders, k, Labels::epi_bit).empty()) labels.division_slice = k;
  return borders;
}

}  // namespace dynasurf::ventricle
