#include "dynasurf/report/stages.hpp"

#include <string>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/stage_io.hpp"

namespace dynasurf {
namespace {

namespace fs = std::filesystem;

void write_wall(const std::string& prefix, std::string_view wall, const Image* border, const VectorField* field,
                const TriMesh* start) {
  if (border == nullptr) return;
  const std::string ending = "_" + std::string(wall);
  write_nrrd_volume(*border, prefix + "border" + ending + ".nrrd");
  if (field != nullptr) {
    const VectorSpans vectors{field->x, field->y, field->z};
    const VoxelArray array{"field", vectors};
    write_vti(field->grid, std::span(&array, 1), prefix + "field" + ending + ".vti");
    write_nrrd_vectors(field->grid, vectors, prefix + "field" + ending + ".nrrd");
  }
  if (start == nullptr) return;
  write_mesh(to_world(border->grid, *start), prefix + "start" + ending + ".ply", MeshFormat::ply);
}

}  // namespace

void StageWriter::operator()(const Intermediates& stages) const {
  const std::string gate = (stages.gate < 9 ? "g0" : "g") + std::to_string(stages.gate + 1);
  const std::string prefix = (folder_ / gate).string() + "_";
  write_nrrd_volume(*stages.image, prefix + "image.nrrd");
  write_nrrd_volume(stages.edges->edges, prefix + "edges.nrrd");
  write_nrrd_volume(stages.edges->gradient, prefix + "gradient.nrrd");
  write_nrrd_volume(stages.labels->borders, prefix + "labels.nrrd");
  write_wall(prefix, name_of(Border::endo), stages.border_endo, stages.field_endo, stages.start_endo);
  write_wall(prefix, name_of(Border::epi), stages.border_epi, stages.field_epi, stages.start_epi);
}

}  // namespace dynasurf
