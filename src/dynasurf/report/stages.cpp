#include "dynasurf/report/detail/stages.hpp"

#include <array>
#include <cstdio>
#include <string>

#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/stage_io.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::report {
namespace {

namespace fs = std::filesystem;

std::string nine_digits(double value) {
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.9g", value);
  return text.data();
}

/// The contours of a wall in the world, a line for each point.
std::string contour_table(const ventricle::WallContours& contours, const Grid& grid) {
  std::string text = "slice,point,x_mm,y_mm,z_mm\n";
  for (std::size_t k = 0; k < contours.slices.size(); ++k) {
    if (!contours.slices[k]) continue;
    const std::vector<Vec2>& points = contours.slices[k]->points;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Vec3 p = to_world(grid, Vec3(points[n][0], points[n][1], k).cwiseProduct(grid.spacing));
      text += std::to_string(k + 1) + "," + std::to_string(n + 1);
      for (int c = 0; c < 3; ++c) text += "," + nine_digits(p[c]);
      text += "\n";
    }
  }
  return text;
}

/// Particles near the border, step after step (MEAS-DIST).
std::string history_table(const dynamics::EvolutionResult& evolved) {
  std::string text = "step,below_1_voxel,below_2_voxels,below_3_voxels,farther\n";
  for (std::size_t n = 0; n < evolved.histories.size(); ++n) {
    text += std::to_string(n + 1);
    for (const int count : evolved.histories[n]) text += "," + std::to_string(count);
    text += "\n";
  }
  return text;
}

/// Where every particle came to rest: voxels from the nearest centre of a border voxel, negative inside.
std::string distance_table(const dynamics::EvolutionResult& evolved, const Image& border) {
  std::string text = "particle,signed_distance_voxels,stopped\n";
  const std::vector<double> distances = mesh::signed_distances_to_border_voxels(evolved.mesh, border);
  for (std::size_t n = 0; n < distances.size(); ++n)
    text += std::to_string(n) + "," + nine_digits(distances[n]) + "," + (evolved.stopped[n] != 0 ? "1" : "0") + "\n";
  return text;
}

/// Where every particle was on its way, in the world, and the field's force on it, N.
std::string trajectory_table(const dynamics::EvolutionResult& evolved, const Grid& grid) {
  std::string text = "step,particle,x_mm,y_mm,z_mm,pull_x_n,pull_y_n,pull_z_n\n";
  for (const dynamics::TrajectoryStep& kept : evolved.trajectory)
    for (std::size_t n = 0; n < kept.places.size(); ++n) {
      text += std::to_string(kept.step) + "," + std::to_string(n);
      const Vec3 place = to_world(grid, kept.places[n]), pull = grid.direction * kept.pulls[n];
      for (const Vec3* v : {&place, &pull})
        for (int c = 0; c < 3; ++c) text += "," + nine_digits((*v)[c]);
      text += "\n";
    }
  return text;
}

void write_motion(const std::string& prefix, const std::string& ending, const ventricle::WallStages& wall) {
  const Grid& grid = wall.border->grid;
  const dynamics::EvolutionResult& evolved = *wall.evolved;
  io::write_mesh(to_world(grid, evolved.mesh), prefix + "evolved" + ending + ".ply", io::MeshFormat::ply);
  if (!evolved.histories.empty()) io::write_file(prefix + "history" + ending + ".csv", history_table(evolved));
  if (!evolved.trajectory.empty())
    io::write_file(prefix + "trajectories" + ending + ".csv", trajectory_table(evolved, grid));
  if (evolved.stopped.size() == evolved.mesh.vertices.size())
    io::write_file(prefix + "distances" + ending + ".csv", distance_table(evolved, *wall.border));
  if (wall.settled != nullptr)
    io::write_mesh(to_world(grid, *wall.settled), prefix + "settled" + ending + ".ply", io::MeshFormat::ply);
}

void write_wall(const std::string& prefix, std::string_view name, const ventricle::WallStages& wall,
                const Grid& image) {
  if (wall.border == nullptr) return;
  const Grid& grid = wall.border->grid;
  const std::string ending = "_" + std::string(name);
  io::write_nrrd_volume(*wall.border, prefix + "border" + ending + ".nrrd");
  if (wall.edge_map != nullptr) io::write_nrrd_volume(*wall.edge_map, prefix + "edge_map" + ending + ".nrrd");
  if (wall.drag != nullptr) io::write_nrrd_volume(*wall.drag, prefix + "drag" + ending + ".nrrd");
  if (wall.field != nullptr) {
    const io::VectorSpans vectors{wall.field->x, wall.field->y, wall.field->z};
    const io::VoxelArray array{"field", vectors};
    io::write_vti(wall.field->grid, std::span(&array, 1), prefix + "field" + ending + ".vti");
    io::write_nrrd_vectors(wall.field->grid, vectors, prefix + "field" + ending + ".nrrd");
  }
  if (wall.start != nullptr)
    io::write_mesh(to_world(grid, *wall.start), prefix + "start" + ending + ".ply", io::MeshFormat::ply);
  if (wall.contours != nullptr)
    io::write_file(prefix + "contours" + ending + ".csv", contour_table(*wall.contours, image));
  if (wall.evolved != nullptr) write_motion(prefix, ending, wall);
}

/// What the names of a gate's files begin with.
std::string prefix_of(const fs::path& folder, std::size_t gate) {
  return (folder / ((gate < 9 ? "g0" : "g") + std::to_string(gate + 1))).string() + "_";
}

}  // namespace

void StageWriter::operator()(const ventricle::Intermediates& stages) const {
  const std::string prefix = prefix_of(folder_, stages.gate);
  io::write_nrrd_volume(*stages.image, prefix + "image.nrrd");
  io::write_nrrd_volume(stages.edges->edges, prefix + "edges.nrrd");
  io::write_nrrd_volume(stages.edges->gradient, prefix + "gradient.nrrd");
  io::write_nrrd_volume(stages.labels->borders, prefix + "labels.nrrd");
  write_wall(prefix, ventricle::name_of(ventricle::Border::endo), stages.endo, stages.image->grid);
  write_wall(prefix, ventricle::name_of(ventricle::Border::epi), stages.epi, stages.image->grid);
}

void StageWriter::write_fit(const psf_fit::FitImages& images) const {
  for (std::size_t g = 0; g < images.data.size(); ++g) {
    const std::string prefix = prefix_of(folder_, g) + "fit_";
    Image difference = images.data[g];
    for (std::size_t n = 0; n < difference.values.size(); ++n) difference.values[n] -= images.model[g].values[n];
    io::write_nrrd_volume(images.data[g], prefix + "data.nrrd");
    io::write_nrrd_volume(images.model[g], prefix + "model.nrrd");
    io::write_nrrd_volume(difference, prefix + "difference.nrrd");
  }
  io::write_nrrd_volume(images.weight, folder_ / "fit_weight.nrrd");
}

}  // namespace dynasurf::report
