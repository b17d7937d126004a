#include "dynasurf/ventricle/labels/detail/slice_flow.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::ventricle {

field::VectorField slice_flow(const Image& image, const SliceFlow& options) {
  Image strength = image::detect_edges(image, image::GradientEdges{}).gradient;
  const float max = strength.values.empty() ? 0 : *std::max_element(strength.values.begin(), strength.values.end());
  field::VectorField field(image.grid);
  if (!(max > 0)) return field;
  for (float& v : strength.values) v /= max;

  Grid one = image.grid;
  // Alone in its grid a slice has no neighbours above and below: the flow is that of the plane.
  one.dims[2] = 1;
  const Index area = one.size();
  parallel_for(image.grid.dims[2], 1, [&](Index k, Index) {
    Image slice(one);
    const Index begin = area * k;
    std::copy_n(strength.values.begin() + begin, area, slice.values.begin());
    const field::FlowResult flow =
        field::flow_field(slice, field::Gvf{.mu = options.mu, .iterations = options.iterations});
    std::copy_n(flow.field.x.begin(), area, field.x.begin() + begin);
    std::copy_n(flow.field.y.begin(), area, field.y.begin() + begin);
  });
  return field;
}

void for_each_line(const Image& image, const field::VectorField& field, int k,
                   const std::function<void(const FieldLine&, double)>& read) {
  const int width = image.grid.dims[0], height = image.grid.dims[1];
  const auto length_at = [&](std::size_t n) -> float {
    const double x = field.x[n], y = field.y[n];
    return std::sqrt(x * x + y * y);
  };
  double longest = 0;
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) longest = std::max<double>(longest, length_at(image.grid.index(i, j, k)));

  const auto add = [&](FieldLine& line, int i, int j, const std::vector<float>& component) {
    const std::size_t n = image.grid.index(i, j, k);
    line.pixels.push_back({i, j});
    line.along.push_back(component[n]);
    line.length.push_back(length_at(n));
    line.value.push_back(image.values[n]);
  };
  for (int j = 0; j < height; ++j) {
    FieldLine row;
    for (int i = 0; i < width; ++i) add(row, i, j, field.x);
    read(row, longest);
  }
  for (int i = 0; i < width; ++i) {
    FieldLine column;
    for (int j = 0; j < height; ++j) add(column, i, j, field.y);
    read(column, longest);
  }
}

std::vector<std::size_t> meeting_points(const FieldLine& line, double least) {
  std::vector<std::size_t> points;
  const auto& u = line.along;
  for (std::size_t n = 0; n + 1 < u.size(); ++n) {
    if (!(u[n] > 0)) continue;
    const double along = u[n];
    if (u[n + 1] < 0 && along - u[n + 1] > least) {
      const float here = u[n], there = -u[n + 1];
      points.push_back(here < there || (here == there && line.value[n] > line.value[n + 1]) ? n : n + 1);
      // A component of exactly 0 between the two is where they meet.
    } else if (u[n + 1] == 0 && n + 2 < u.size() && u[n + 2] < 0 && along - u[n + 2] > least) {
      points.push_back(n + 1);
    }
  }
  return points;
}

std::vector<std::size_t> quiet_points(const FieldLine& line, double longest, const QuietPoints& o) {
  std::vector<std::size_t> points;
  const auto& length = line.length;
  const std::size_t width = o.width_px;
  for (std::size_t n = 1; n + 1 < length.size(); ++n) {
    if (!(length[n] < o.low * longest)) continue;
    // One side may be as low: on a plateau of two pixels both would be lost otherwise.
    const bool minimum = length[n] <= length[n - 1] && length[n] <= length[n + 1] &&
                         (length[n] < length[n - 1] || length[n] < length[n + 1]);
    const std::size_t first = n > width ? n - width : 0, last = std::min(length.size() - 1, n + width);
    float before = 0, after = 0;
    for (std::size_t m = first; m < n; ++m) before = std::max(before, length[m]);
    for (std::size_t m = n + 1; m <= last; ++m) after = std::max(after, length[m]);
    if (minimum && std::min(before, after) > o.high * longest) points.push_back(n);
  }
  return points;
}

}  // namespace dynasurf::ventricle
