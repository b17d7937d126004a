#include "dynasurf/report/detail/page_pictures.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/parallel.hpp"

namespace dynasurf::report::detail {
namespace {

/// Calls visit(i0, i1, j0, j1, k) for every bin, in the order of voxels.
template <class Visit>
void for_each_bin(const Index3& dims, int bin, const Visit& visit) {
  for (int k = 0; k < dims[2]; ++k)
    for (int j = 0; j < dims[1]; j += bin)
      for (int i = 0; i < dims[0]; i += bin) visit(i, std::min(i + bin, dims[0]), j, std::min(j + bin, dims[1]), k);
}

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

/// All gates as bytes, 255 the largest value of the study; negative values are black.
Bytes image_bytes(const Study& study, int bin) {
  const float largest = largest_value(study);
  const double scale = largest > 0 ? 255.0 / largest : 0;
  return bytes_of_gates(study.gates.size(), [&](std::size_t g) {
    const Image& gate = study.gates[g];
    Bytes bytes;
    for_each_bin(gate.grid.dims, bin, [&](int i0, int i1, int j0, int j1, int k) {
      double sum = 0;
      for (int j = j0; j < j1; ++j)
        for (int i = i0; i < i1; ++i) {
          const float value = gate(i, j, k);
          sum += std::isfinite(value) ? value : 0;
        }
      const double mean = sum / ((i1 - i0) * (j1 - j0)) * scale;
      bytes.push_back(byte_of(mean));
    });
    return bytes;
  });
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
    const std::size_t columns = (dims[0] + bin - 1) / bin;
    const std::size_t rows = (dims[1] + bin - 1) / bin;
    return columns * rows * dims[2] * study.gates.size();
  };
  // Pixels are joined within slices alone; slices are few and far apart already.
  while (voxels() > most_voxels && bin < std::max(dims[0], dims[1])) ++bin;
  return bin;
}

Bytes mark_bytes(const Grid& grid, const Mask& borders, const Mask& edges, int bin) {
  const auto marks_at = [&](std::size_t v) -> unsigned {
    const unsigned border = borders.values.size() == grid.size() ? borders.values[v] & 3u : 0u;
    const unsigned edge = edges.values.size() == grid.size() ? edges.values[v] : 0u;
    return border | (edge == 1 ? 4u : edge == 2 ? 8u : 0u);
  };
  Bytes bytes;
  for_each_bin(grid.dims, bin, [&](int i0, int i1, int j0, int j1, int k) {
    unsigned marks = 0;
    for (int j = j0; j < j1; ++j)
      // Marks are joined, where values are averaged: a border one pixel wide must not vanish in a bin.
      for (int i = i0; i < i1; ++i) marks |= marks_at(grid.index(i, j, k));
    bytes.push_back(marks);
  });
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
  json["columns"] = (dims[0] + bin - 1) / bin;
  json["rows"] = (dims[1] + bin - 1) / bin;
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
