// Prints what the libraries make of a few small tasks as one number for each, which is the same wherever this program
// is compiled and runs. What comes first is made of least, so the first line that differs tells where to look.
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/organ/organ.hpp"
#include "dynasurf/synthetic/cloud_shapes.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "bytes_hash.hpp"

namespace dynasurf {

static Hash& operator<<(Hash& hash, const TriMesh& mesh) { return hash << mesh.vertices << mesh.triangles; }
static Hash& operator<<(Hash& hash, const heart::Estimate& e) { return hash << e.value << e.sd; }

namespace {

synthetic::VirtualPatient patient_options() {
  synthetic::VirtualPatient o;
  o.gates = 4;
  o.gut_amplitude = 0.8;
  o.noise.seed = 3;
  return o;
}

void print_images(const std::string& name, const std::vector<Image>& images) {
  Hash hash;
  for (const Image& image : images) hash << image.values;
  hash.print(name);
}

void print_stages(const ventricle::Intermediates& s) {
  const std::string gate = "gate " + std::to_string(s.gate);
  if (s.endo.border) print_images(gate + " inner border", {*s.endo.border});
  if (s.epi.border) print_images(gate + " outer border", {*s.epi.border});
  for (const field::VectorField* field : {s.endo.field, s.epi.field}) {
    if (!field) continue;
    Hash hash;
    hash << field->x << field->y << field->z;
    hash.print(gate + (field == s.endo.field ? " inner field" : " outer field"));
  }
}

void print_ventricle(const std::string& name, const Study& study, const ventricle::Options& options) {
  const ventricle::Result r = ventricle::reconstruct(study, options, {}, {.keep = print_stages});
  Hash edges, surfaces, numbers;
  for (const ventricle::Gate& g : r.gates) {
    edges << g.edges.values << g.base_slice;
    const ventricle::EdgeSurfaces& edge = g.edge_surfaces;
    if (edge.endo) surfaces << edge.endo->mesh << edge.endo->steps;
    if (edge.epi) surfaces << edge.epi->mesh << edge.epi->steps;
    numbers << edge.wall_ml;
  }
  const auto value = [](const std::optional<heart::Estimate>& e) { return e ? std::optional(e->value) : std::nullopt; };
  const ventricle::Reading& edge = r.readings.edge;
  numbers << value(edge.edv_ml) << value(edge.esv_ml) << value(edge.ef_percent) << r.wall_variation;
  if (r.measures) {
    numbers << r.measures->area_mm2 << r.measures->muscle_g;
    for (const auto& map : {r.measures->maps.thickness_ed_mm, r.measures->maps.motion_mm}) numbers << map;
  }
  edges.print(name + " edges");
  surfaces.print(name + " surfaces");
  numbers.print(name + " numbers");
  if (!r.readings.psf_corrected) return;
  Hash fit;
  const psf_fit::FittedBeat& beat = *r.readings.psf_corrected;
  for (const psf_fit::FittedGate& g : beat.gates) fit << g.endo << g.epi;
  fit.print(name + " fit");
  Hash estimates;
  estimates << beat.uptake << beat.wall_ml << beat.edv_ml << beat.esv_ml << beat.ef_percent << beat.thickness_mm
            << beat.fwhm_mm << beat.objective << beat.steps;
  estimates.print(name + " estimates");
}

void ventricles() {
  const synthetic::Phantom phantom = synthetic::make_phantom(patient_options());
  Hash truth;
  for (const synthetic::TrueGate& g : phantom.truth) truth << g.endo << g.epi << g.endo_ml << g.epi_ml;
  truth.print("patient truth");
  print_images("patient images", phantom.study.gates);
  print_ventricle("thesis", phantom.study, ventricle::preset("thesis"));
  print_ventricle("psf_corrected", phantom.study, ventricle::preset("psf_corrected"));
}

void organs() {
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::Organ{});
  print_images("organ images", phantom.study.gates);
  const organ::Result r = organ::reconstruct(phantom.study.gates.front(), organ::preset("ct"));
  Hash hash;
  if (r.surface) hash << r.surface->mesh;
  hash << r.voxels_ml << r.threshold;
  hash.print("organ surface");
}

void clouds() {
  struct Task {
    synthetic::CloudShape shape;
    double noise, missing;
    bool normals;
    const char* preset;
  };
  for (const Task& t : {Task{synthetic::CloudShape::vase, 0.5, 0, false, "shaped"},
                        Task{synthetic::CloudShape::blobs, 0.3, 5, true, "faithful"},
                        Task{synthetic::CloudShape::cube, 0, 0, false, "shaped"}}) {
    synthetic::CloudPhantom o;
    o.shape = t.shape;
    o.points = 12000;
    o.noise_percent = t.noise;
    o.missing_percent = t.missing;
    o.normals = t.normals;
    const PointCloud cloud = synthetic::make_cloud(o);
    const std::string name =
        std::string(synthetic::names_of(synthetic::CloudShape{})[static_cast<std::size_t>(t.shape)]);
    Hash points;
    points << cloud.points << cloud.normals;
    points.print(name + " points");
    cloud::Options options = cloud::preset(t.preset);
    options.triangles = {1280, 320};
    const cloud::Result r = cloud::reconstruct(cloud, options);
    Hash used, levels;
    used << r.used.points << r.facts.spacing << r.facts.noise << r.facts.cells;
    for (const cloud::Level& l : r.levels) levels << l.mesh << l.errors;
    used.print(name + " facts");
    levels.print(name + " levels");
  }
}

}  // namespace
}  // namespace dynasurf

// bytes_probe [widest vectors, in floats [threads [bytes of the first cache, as Eigen is told]]]
int main(int count, char** words) {
  if (count > 1) dynasurf::field::detail::widest_vectors = std::atoi(words[1]);
  if (const int cache = count > 3 ? std::atoi(words[3]) : 0) Eigen::setCpuCacheSizes(cache, 8 * cache, 8 * cache);
  const dynasurf::ThreadLimit limit(count > 2 ? std::atoi(words[2]) : 0);
  dynasurf::organs();
  dynasurf::clouds();
  dynasurf::ventricles();
  return 0;
}
