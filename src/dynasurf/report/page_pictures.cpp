#include "dynasurf/report/detail/page_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/visit_marked.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::report::detail {
namespace {

/// How many bins lie along an axis; the last one may be narrower.
std::size_t bins_along(int voxels, int bin) { return (voxels + bin - 1) / bin; }

float largest_value(const Study& study) {
  float largest = 0;
  for (const Image& gate : study.gates)
    for (const float value : gate.values)
      if (std::isfinite(value)) largest = std::max(largest, value);
  return largest;
}

/// What `bytes_of(gate)` makes of all gates, one after the other.
template <class BytesOf>
Bytes bytes_of_gates(std::size_t gates, const BytesOf& bytes_of) {
  std::vector<Bytes> each(gates);
  parallel_for(gates, 1, [&](std::size_t g, std::size_t) { each[g] = bytes_of(g); });
  Bytes all;
  for (const Bytes& bytes : each) all.insert(all.end(), bytes.begin(), bytes.end());
  return all;
}

Json circle_json(const ventricle::Circle& circle) {
  if (!(circle.radius_px > 0)) return nullptr;
  return {circle.x_px, circle.y_px, circle.radius_px};
}

/// What the slices show beside the pixels: circles in voxels, slices counted from 0.
Json marks_json(const ventricle::Gate& gate) {
  Json local = Json::array();
  for (const auto& circle : gate.labels.local) local.push_back(circle ? circle_json(*circle) : Json(nullptr));
  return {{"circle", circle_json(gate.labels.circle)},
          {"big_slice", gate.labels.big_slice},
          {"division_slice", gate.labels.division_slice},
          {"base_slice", gate.base_slice},
          {"local", std::move(local)}};
}

}  // namespace

int bin_of(const Study& study, std::size_t most_voxels) {
  const auto& dims = study.grid().dims;
  int bin = 1;
  const auto voxels = [&] {
    return bins_along(dims[0], bin) * bins_along(dims[1], bin) * dims[2] * study.gates.size();
  };
  // Pixels are joined within slices alone; slices are few and far apart already.
  while (voxels() > most_voxels && bin < std::max(dims[0], dims[1])) ++bin;
  return bin;
}

Bytes image_bytes(const Study& study, int bin) {
  const float largest = largest_value(study);
  const double scale = largest > 0 ? 255.0 / largest : 0;
  return bytes_of_gates(study.gates.size(), [&](std::size_t g) {
    const Grid& grid = study.gates[g].grid;
    const int width = grid.dims[0], height = grid.dims[1];
    Bytes bytes;
    std::vector<double> sums(bins_along(width, bin));  // of a row of bins
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j0 = 0; j0 < height; j0 += bin) {
        const int j1 = std::min(j0 + bin, height);
        std::fill(sums.begin(), sums.end(), 0.0);
        for (int j = j0; j < j1; ++j) {
          const float* row = &study.gates[g](0, j, k);
          for (int step = 0; step < bin; ++step)
            for (int i = step, n = 0; i < width; i += bin, ++n) sums[n] += std::isfinite(row[i]) ? row[i] : 0;
        }
        for (int i = 0, n = 0; i < width; i += bin, ++n)
          bytes.push_back(byte_of(sums[n] / ((std::min(i + bin, width) - i) * (j1 - j0)) * scale));
      }
    return bytes;
  });
}

Bytes mark_bytes(const Grid& grid, const Mask& borders, const Mask& edges, int bin) {
  const std::size_t columns = bins_along(grid.dims[0], bin), rows = bins_along(grid.dims[1], bin);
  Bytes bytes(columns * rows * grid.dims[2], 0);
  // Marks are joined, where values are averaged: a border one pixel wide must not vanish in a bin.
  const auto put = [&](const Mask& mask, const auto& mark_of) {
    if (mask.values.size() != grid.size()) return;
    for (int k = 0; k < grid.dims[2]; ++k)
      visit_marked(mask, k, [&](int i, int j) {
        bytes[(k * rows + j / bin) * columns + i / bin] |= mark_of(mask.values[grid.index(i, j, k)]);
      });
  };
  put(borders, [](unsigned border) { return border & 3u; });
  put(edges, [](unsigned edge) { return edge == 1 ? 4u : edge == 2 ? 8u : 0u; });
  return bytes;
}

Json grid_json(const Grid& grid) {
  Json direction = Json::array();
  for (int row = 0; row < 3; ++row)
    for (int column = 0; column < 3; ++column) direction.push_back(grid.direction(row, column));
  return {{"dims", grid.dims},
          {"spacing_mm", {grid.spacing[0], grid.spacing[1], grid.spacing[2]}},
          {"origin_mm", {grid.origin[0], grid.origin[1], grid.origin[2]}},
          {"direction", std::move(direction)}};
}

Json pictures_json(const ventricle::Result& result, std::size_t most_voxels) {
  const Study& study = result.study;
  if (study.gates.empty()) return nullptr;
  const int bin = bin_of(study, most_voxels);
  const Index3 dims = study.grid().dims;
  Json marks = Json::array();
  for (const ventricle::Gate& gate : result.gates) marks.push_back(marks_json(gate));
  Json json = Json::object();
  json["grid"] = grid_json(study.grid());
  json["bin"] = bin;
  json["columns"] = bins_along(dims[0], bin);
  json["rows"] = bins_along(dims[1], bin);
  json["gates"] = study.gates.size();
  std::string pixels, drawn;
  parallel_for(2, 1, [&](std::size_t task, std::size_t) {
    if (task == 0)
      pixels = packed(image_bytes(study, bin));
    else
      drawn = packed(bytes_of_gates(result.gates.size(), [&](std::size_t g) {
        return mark_bytes(study.grid(), result.gates[g].labels.borders, result.gates[g].edges, bin);
      }));
  });
  json["pixels"] = std::move(pixels);
  json["marked_gates"] = result.gates.size();
  json["marks"] = std::move(drawn);
  json["labels"] = std::move(marks);
  return json;
}

}  // namespace dynasurf::report::detail
