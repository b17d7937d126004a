#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/core/contour.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/field/vector_field.hpp"
#include "dynasurf/show/detail/canvas.hpp"
#include "dynasurf/show/detail/scene.hpp"

namespace dynasurf::show {

// The pictures of the thesis (VIS-*), each from plain data. Slices are drawn as stored: columns to the right, rows
// downwards; they are counted from 1 at the apex in what is written, from 0 in the arguments.

/// A surface of a picture, with the name that its legend gives it.
struct NamedSurface {
  std::string name;
  TriMesh mesh;
  io::Colour colour;
};

/// VIS-SLICEVIEW: the vectors of a slice and the image under them, both with the line along a row of voxels; beside
/// them the length of the vectors along the line with the image in the same frame, and their part along the line with a
/// mark at each change of sign from + to -: there vectors from both sides meet. Paths of particles lie over the image,
/// which is on the field's grid.
struct SliceView {
  const Image* image = nullptr;
  const field::VectorField* field = nullptr;
  int slice = 0, row = 0;
  int slice_number = 1;           // as it is written
  const Image* border = nullptr;  // where it is given, its surroundings alone are shown
  std::string title;
  std::vector<std::pair<std::string, std::string>> parameters;
  std::vector<std::vector<Vec2>> paths = {};  // of particles that end in the slice, voxels, start first
};
/// Draws it.
Canvas draw_slice_view(const SliceView& view);

/// VIS-GVFGRID: the same slice of several fields, arrows coloured by their length, and below each the length along a
/// row. All fields lie on one grid; `across` of them stand side by side.
struct NamedField {
  std::string name;
  field::VectorField field;
};
/// Draws them; `border`, where it is given, restricts the view to its surroundings.
Canvas draw_field_grid(std::span<const NamedField> fields, int across, int slice, int row, const std::string& title,
                       const Image* border = nullptr);

/// VIS-GVF3D: the voxels of a border, vectors of the field as short lines, and lines that follow it, both coloured by
/// its length.
Canvas draw_field_3d(const field::VectorField& field, const Image& border, const std::string& title);

/// VIS-VOX3D: voxels in space. `values` above 0 are drawn: each in the colour of its set.
struct NamedVoxels {
  std::string name;
  Image values;
  io::Colour colour;
  double opacity = 1;
};
/// Draws all sets in one space.
Canvas draw_voxels(std::span<const NamedVoxels> sets, const std::string& title);
/// The same for a map such as a drag: voxels of at least a quarter of the largest value, cut open at the middle column,
/// coloured by value.
Canvas draw_voxel_map(const Image& map, const std::string& title, const std::string& unit);

/// VIS-MESH: surfaces flat, smooth (Gouraud), as wires, and as wires over the voxels of their borders.
Canvas draw_mesh(std::span<const NamedSurface> surfaces, std::span<const NamedVoxels> voxels, const std::string& title);

/// VIS-SECTION: surfaces (world frame) cut by twelve slices at most, over the image.
Canvas draw_sections_of(const Image& image, std::span<const NamedSurface> surfaces, const std::string& title);

/// VIS-CYCLE: the surfaces of every gate at one scale, a row for each wall.
Canvas draw_cycle(std::span<const std::vector<NamedSurface>> walls, const std::string& title);

/// VIS-EVOLUTION: a mesh at several steps. Particles that have stopped are red.
struct EvolutionFrame {
  int step = 0;
  TriMesh mesh;
  std::vector<bool> stopped;  // per vertex
};
/// Draws the steps side by side, with the voxels of the border.
Canvas draw_evolution(std::span<const EvolutionFrame> frames, const Image& border, const std::string& title);

/// The same as a film, whose last step stays for a while.
Film film_of_evolution(std::span<const EvolutionFrame> frames, const Image& border, const std::string& title);

/// VIS-CYCLE: a beat in forty meshes interpolated between the gates, the first wall smooth, the second as wires around
/// it. `beat_ms` above 0 tells the length of the beat. Throws InputError unless the meshes of a wall share their
/// triangles.
Film film_of_beat(std::span<const std::vector<TriMesh>> walls, std::span<const io::Colour> colours, double beat_ms,
                  const std::string& title);

/// VIS-MIP: 200 instances of a body, ever farther from the observer, each at the level of detail that its size on the
/// screen asks for, coloured by level. Levels finest first.
Canvas draw_instances(std::span<const TriMesh> levels, const std::string& title);

/// VIS-SCATTER: the signed distance of every particle, voxels, with the zero line.
Canvas draw_scatter(std::span<const double> distances, const std::string& title);

/// VIS-HIST: particles nearer than 1, 2, 3 voxels (each with the former) and the others, after every step.
Canvas draw_history(std::span<const std::array<int, 4>> history, const std::string& title);

/// VIS-AREAS: the area of every triangle and d, area over longest edge, and the mesh with its triangles coloured by
/// shape (1: equilateral).
Canvas draw_areas(const TriMesh& mesh, const std::string& title);

/// VIS-CURVE: a volume over the beat; `half_width`, when given, is the half width of its error band.
struct NamedCurve {
  std::string name;
  std::vector<double> value, half_width;
  io::Colour colour;
};
/// Draws all curves over one axis of time.
Canvas draw_curves(std::span<const double> time, const std::string& time_label, std::span<const NamedCurve> curves,
                   const std::string& title);

/// VIS-SMOOTH: a mesh before and after, each coloured by how far the angles about a vertex miss a full turn.
Canvas draw_smoothing(const TriMesh& before, const TriMesh& after, const std::string& title);

/// VIS-CONTOUR: a contour on its slice before and after its motion, with the pull of the field on its points and its
/// own bending force; what resampling does on the way; and the stack of contours in space.
struct ContourView {
  const Image* image = nullptr;
  int slice = 0;
  Contour start, found;
  Contour unsampled, resampled;  // from a start with long edges, without resampling and with; empty: not shown
  const field::VectorField* field = nullptr;                                       // of the plane, px
  std::vector<std::pair<io::Colour, std::vector<std::optional<Contour>>>> stacks;  // per wall: px per slice
  std::string title;
};
/// Draws it.
Canvas draw_contours(const ContourView& view);

}  // namespace dynasurf::show
