#pragma once
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/heart/lv_volumes.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/detail/readings.hpp"

namespace dynasurf::test {

/// A result put together by hand, without the pipeline: two truncated ellipsoids that beat, an image of the muscle
/// between them, and borders where they cut the slices. What it holds is known before any of our code has run.
struct SampleStudy {
  int gates = 8;
  Index3 dims{64, 64, 23};
  int mesh_level = 3;
};

inline Grid sample_grid(const Index3& dims) {
  Grid grid;
  grid.dims = dims;
  grid.spacing = {4.4 * 64 / dims[0], 4.4 * 64 / dims[1], 4.9 * 23 / dims[2]};
  // Apex to base runs to the right, to the back and up, as a heart lies.
  const Vec3 k = Vec3(-0.62, 0.55, 0.56).normalized();
  const Vec3 i = Vec3(0.0, 0.56, -0.55).cross(k).cross(k).normalized();
  grid.direction.col(0) = i;
  grid.direction.col(1) = k.cross(i);
  grid.direction.col(2) = k;
  const Vec3 middle(0.5 * (dims[0] - 1) * grid.spacing[0], 0.5 * (dims[1] - 1) * grid.spacing[1],
                    0.5 * (dims[2] - 1) * grid.spacing[2]);
  grid.origin = Vec3(30, -20, 15) - grid.direction * middle;
  return grid;
}

/// Half axes of one wall at one moment, mm: across, and along the long axis.
struct Ellipsoid {
  Vec3 centre;
  double across_mm = 0, along_mm = 0, base_mm = 0;  // cut flat at base_mm above the centre
  double level(const Vec3& p) const {
    const Vec3 d = p - centre;
    return std::sqrt((d[0] * d[0] + d[1] * d[1]) / (across_mm * across_mm) + d[2] * d[2] / (along_mm * along_mm));
  }
  bool below_base(const Vec3& p) const { return p[2] - centre[2] <= base_mm; }
};

inline Ellipsoid sample_wall(const Grid& grid, ventricle::Border wall, double phase) {
  const double squeeze = 0.5 - 0.5 * std::cos(2 * std::numbers::pi * std::pow(phase, 0.8));  // 0: end diastole
  Ellipsoid e;
  e.centre = centre_of(grid, {grid.dims[0] / 2 + 2, grid.dims[1] / 2 - 1, grid.dims[2] / 2 + 2});
  e.base_mm = 20 - 7 * squeeze;
  e.across_mm = wall == ventricle::Border::endo ? 25 - 7.5 * squeeze : 35 - 4.0 * squeeze;
  e.along_mm = wall == ventricle::Border::endo ? 43 - 7.0 * squeeze : 52 - 4.0 * squeeze;
  return e;
}

inline ventricle::Surface sample_surface(const Grid& grid, const TriMesh& sphere, const Ellipsoid& shape) {
  ventricle::Surface surface;
  TriMesh mesh = sphere;
  for (Vec3& p : mesh.vertices) {
    p = shape.centre + Vec3(p[0] * shape.across_mm, p[1] * shape.across_mm, p[2] * shape.along_mm);
    p[2] = std::min(p[2], shape.centre[2] + shape.base_mm);
  }
  surface.mesh = to_world(grid, std::move(mesh));
  surface.volume_ml = mesh::volume_mm3(surface.mesh) / 1000;
  surface.quality = mesh::triangle_quality(surface.mesh);
  surface.repair.check = {true, true, true, 0, 0};
  surface.stop_reason = dynamics::StopReason::all_stopped;
  surface.steps = 412;
  surface.stopped_fraction = 0.991;
  surface.within_one_voxel = 0.984;
  surface.border_reached = 0.99;
  surface.mean_distance_mm = 1.62;
  return surface;
}

/// Bright muscle, blurred, on a faint background with noise from a fixed sequence.
inline Image sample_image(const Grid& grid, double phase) {
  const Ellipsoid endo = sample_wall(grid, ventricle::Border::endo, phase),
                  epi = sample_wall(grid, ventricle::Border::epi, phase);
  Image image(grid);
  std::uint32_t noise = 12345;
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const Vec3 p = centre_of(grid, {i, j, k});
        noise = noise * 1664525u + 1013904223u;
        const double from_endo = (endo.level(p) - 1) * endo.across_mm;
        const double from_epi = (epi.level(p) - 1) * epi.across_mm;
        const double middle = 0.5 * (from_endo + from_epi);
        const double above = std::max(0.0, p[2] - endo.centre[2] - endo.base_mm);
        const double muscle = std::exp(-middle * middle / 72 - above * above / 60);
        image(i, j, k) = static_cast<float>(0.88 * muscle + 0.05 + 0.07 * (noise >> 8) / 16777216.0);
      }
  image(0, 0, 0) = 1;
  return image;
}

/// A voxel is of a border when the surface passes between it and a neighbour in the slice.
inline ventricle::Labels sample_labels(const Grid& grid, double phase) {
  ventricle::Labels labels;
  labels.borders = Mask(grid);
  for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
    const Ellipsoid shape = sample_wall(grid, wall, phase);
    const auto inside = [&](int i, int j, int k) { return shape.level(centre_of(grid, {i, j, k})) < 1; };
    for (int k = 0; k < grid.dims[2]; ++k)
      for (int j = 1; j + 1 < grid.dims[1]; ++j)
        for (int i = 1; i + 1 < grid.dims[0]; ++i)
          if (inside(i, j, k) && shape.below_base(centre_of(grid, {i, j, k})) &&
              !(inside(i - 1, j, k) && inside(i + 1, j, k) && inside(i, j - 1, k) && inside(i, j + 1, k)))
            labels.borders(i, j, k) |=
                wall == ventricle::Border::endo ? ventricle::Labels::endo_bit : ventricle::Labels::epi_bit;
  }
  const Ellipsoid epi = sample_wall(grid, ventricle::Border::epi, 0);
  labels.circle = {epi.centre[0] / grid.spacing[0], epi.centre[1] / grid.spacing[1],
                   epi.across_mm / grid.spacing[0] + 2};
  labels.big_slice = grid.dims[2] / 2 + 2;
  labels.division_slice = 4;
  labels.local.resize(static_cast<std::size_t>(grid.dims[2]));
  return labels;
}

/// The numbers over the beat, from the surfaces that are there.
inline void measure_sample(ventricle::Result& result) {
  for (ventricle::Gate& gate : result.gates) {
    ventricle::EdgeSurfaces& edge = gate.edge_surfaces;
    edge.wall_ml = edge.endo && edge.epi ? std::optional(edge.epi->volume_ml - edge.endo->volume_ml) : std::nullopt;
  }
  result.phases = std::nullopt;
  ventricle::measure_cycle(result);
  ventricle::choose_leading(result);
  result.measures = ventricle::measure_study(result, {});
}

inline ventricle::Result sample_result(const SampleStudy& study = {}) {
  ventricle::Result result;
  const Grid grid = sample_grid(study.dims);
  const TriMesh sphere = mesh::icosphere(study.mesh_level);
  result.study.format = "DICOM";
  result.study.modality = "NM";
  result.study.view = View::short_axis;
  result.study.slice_order = SliceOrder::apex_to_base;
  result.study.image_type = study.gates > 1 ? "RECON GATED TOMO" : "RECON TOMO";
  result.study.cycle_ms = study.gates > 1 ? 880 : 0;
  for (int g = 0; g < study.gates; ++g) {
    const double phase = static_cast<double>(g) / study.gates;
    ventricle::Gate gate;
    gate.gate = g;
    if (study.gates > 1) {
      gate.time_ms = phase * result.study.cycle_ms;
      result.study.time_ms.push_back(*gate.time_ms);
    }
    result.study.gates.push_back(sample_image(grid, phase));
    gate.labels = sample_labels(grid, phase);
    gate.edges = Mask(grid);
    for (std::size_t v = 0; v < gate.edges.values.size(); ++v)
      gate.edges.values[v] = gate.labels.borders.values[v] != 0 ? 2 : v % 397 == 0 ? 1 : 0;
    gate.base_slice = 17;
    gate.edge_surfaces.endo = sample_surface(grid, sphere, sample_wall(grid, ventricle::Border::endo, phase));
    gate.edge_surfaces.epi = sample_surface(grid, sphere, sample_wall(grid, ventricle::Border::epi, phase));
    result.gates.push_back(std::move(gate));
  }
  measure_sample(result);
  result.wall_variation = 0.06;
  result.verdict = ventricle::Verdict::ok;
  result.notes = {{Severity::info, "slice_refine.case_3", "the division slice was moved from 5 to 4", 0, 4}};
  result.seconds = {{"edges", 0.052}, {"labels", 0.019}, {"field", 0.611}, {"surfaces", 0.744}, {"measures", 0.031}};
  return result;
}

/// The same heart with walls fitted through the blur: a little wider than the edges, with error bars.
inline ventricle::Result sample_fitted() {
  ventricle::Result result = sample_result();
  psf_fit::FittedBeat fit;
  for (const ventricle::Gate& gate : result.gates) {
    psf_fit::FittedGate fitted;
    fitted.endo = gate.edge_surfaces.endo->mesh, fitted.epi = gate.edge_surfaces.epi->mesh;
    fitted.endo_ml = {1.2 * gate.edge_surfaces.endo->volume_ml, 3};
    fitted.epi_ml = {1.1 * gate.edge_surfaces.epi->volume_ml, 5};
    fit.gates.push_back(std::move(fitted));
  }
  const double edv = 1.2 * result.leading.edv_ml->value, esv = 1.2 * result.leading.esv_ml->value;
  fit.edv_ml = {edv, 4}, fit.esv_ml = {esv, 2}, fit.sv_ml = {edv - esv, 3};
  fit.ef_percent = heart::Estimate{100 * (edv - esv) / edv, 1.5};
  fit.wall_ml = {130, 6}, fit.thickness_mm = {9.5, 0.5}, fit.fwhm_mm = {12, 0.4};
  fit.ed_gate = *result.leading.ed_gate, fit.es_gate = *result.leading.es_gate;
  fit.uptake.assign(fit.gates[0].endo.vertices.size(), 1.0);
  fit.steps = 9, fit.converged = true;
  fit.images.data = fit.images.model = result.study.gates;
  for (Image& model : fit.images.model)
    for (float& v : model.values) v *= 0.9F;
  fit.images.weight = Image(result.study.grid(), 1.0F);
  result.readings.psf_corrected = std::move(fit);
  ventricle::choose_leading(result);
  return result;
}

/// A field that points at a wall from both sides and gets weaker with the distance from it.
inline field::VectorField sample_field(const Grid& grid, const Ellipsoid& shape) {
  field::VectorField field(grid);
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j)
      for (int i = 0; i < grid.dims[0]; ++i) {
        const Vec3 p = centre_of(grid, {i, j, k});
        const double from_wall_mm = (shape.level(p) - 1) * shape.across_mm;
        const Vec3 outwards = (p - shape.centre).normalized();
        const Vec3 v = -std::copysign(0.1 * std::exp(-std::abs(from_wall_mm) / 12), from_wall_mm) * outwards;
        const std::size_t n = grid.index(i, j, k);
        field.x[n] = static_cast<float>(v[0]), field.y[n] = static_cast<float>(v[1]),
        field.z[n] = static_cast<float>(v[2]);
      }
  return field;
}

/// The same with the way of its meshes at end diastole: from twice as wide straight to their places in eleven kept
/// steps. The upper half of the particles has stopped from the sixth one on. The drag is ten times as large near the
/// outer wall.
inline ventricle::Result sample_moving() {
  ventricle::Result result = sample_result();
  ventricle::Gate& gate = result.gates[static_cast<std::size_t>(*result.leading.ed_gate)];
  ventricle::EdgeSurfaces& surfaces = gate.edge_surfaces;
  const Grid& grid = result.study.grid();
  for (std::optional<ventricle::Surface>* surface : {&surfaces.endo, &surfaces.epi}) {
    const std::vector<Vec3>& rest = (*surface)->mesh.vertices;
    Vec3 middle = Vec3::Zero();
    for (const Vec3& p : rest) middle += p / static_cast<double>(rest.size());
    const bool is_epi = surface == &surfaces.epi;
    Image border(grid);
    for (std::size_t n = 0; n < border.values.size(); ++n)
      border.values[n] =
          gate.labels.borders.values[n] & (is_epi ? ventricle::Labels::epi_bit : ventricle::Labels::endo_bit) ? 1 : 0;
    const Ellipsoid shape =
        sample_wall(grid, is_epi ? ventricle::Border::epi : ventricle::Border::endo, gate.gate / 8.0);
    ventricle::Motion motion{(*surface)->mesh.triangles, {}, {}, border, sample_field(grid, shape), {}};
    if (is_epi) {
      motion.drag = Image(grid, 0.1F);
      for (std::size_t n = 0; n < border.values.size(); ++n)
        if (border.values[n] > 0) motion.drag->values[n] = 1;
    }
    for (int n = 0; n <= 10; ++n) {
      dynamics::TrajectoryStep step{20 * n, {}, {}, {}};
      std::vector<double>& distances = motion.distances.emplace_back();
      for (const Vec3& p : rest) {
        const bool has_stopped = n == 10 || (n >= 5 && (p - middle).dot(grid.direction.col(2)) > 0);
        step.places.emplace_back(p + (has_stopped ? 0 : 0.1 * (10 - n)) * (p - middle));
        step.pulls.emplace_back(has_stopped ? Vec3(Vec3::Zero()) : Vec3((middle - p) * 0.001));
        step.stopped.push_back(has_stopped ? 1 : 0);
        distances.push_back(has_stopped ? -0.5 : 0.4 * (10 - n));
      }
      motion.steps.push_back(std::move(step));
    }
    (*surface)->motion = std::move(motion);
  }
  return result;
}

/// The same by contours: in each slice a regular polygon of 40 points, that of the sixteenth slice found first. The
/// field pulls outwards.
inline ventricle::Result sample_contours() {
  ventricle::Result result = sample_result();
  const Grid& grid = result.study.grid();
  for (ventricle::Gate& gate : result.gates)
    for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
      const Ellipsoid shape = sample_wall(grid, wall, gate.gate / 8.0);
      ventricle::WallContours contours;
      contours.slices.resize(static_cast<std::size_t>(grid.dims[2]));
      contours.pulls.resize(contours.slices.size());
      contours.bends.resize(contours.slices.size());
      contours.best_slice = 15;
      for (std::size_t k = 0; k < contours.slices.size(); ++k) {
        const double up = (static_cast<double>(k) * grid.spacing[2] - shape.centre[2]) / shape.along_mm;
        if (std::abs(up) >= 0.98 || up * shape.along_mm > shape.base_mm) continue;
        const double radius = std::sqrt(1 - up * up) * shape.across_mm / grid.spacing[0];
        contours.slices[k].emplace();
        for (int n = 0; n < 40; ++n) {
          const Vec2 out(std::cos(2 * std::numbers::pi * n / 40), std::sin(2 * std::numbers::pi * n / 40));
          contours.slices[k]->points.push_back(shape.centre.head<2>() / grid.spacing[0] + radius * out);
          contours.pulls[k].push_back(0.5 * out);
          contours.bends[k].push_back(-0.1 * out);
        }
      }
      (wall == ventricle::Border::endo ? gate.edge_surfaces.endo : gate.edge_surfaces.epi)->contours =
          std::move(contours);
    }
  return result;
}

/// Surfaces that one should look at twice.
inline ventricle::Result sample_to_check() {
  ventricle::Result result = sample_result();
  result.verdict = ventricle::Verdict::check;
  result.wall_variation = 0.24;
  result.gates[3].edge_surfaces.endo->stopped_fraction = 0.83;
  result.gates[3].edge_surfaces.endo->stop_reason = dynamics::StopReason::max_steps;
  result.flags = {
      {"surface_incomplete", Severity::warning,
       "fewer than 90 % of the particles of the endocardial surface reached the border in gate 4", 1},
      {"wall_volume_varies", Severity::warning,
       "the wall's volume varies by 24 % over the beat (coefficient of variation); muscle keeps its volume", 0.24}};
  result.notes.push_back({Severity::warning, "gvf.step_limited",
                          "the time step of the field was shortened from 2.77 to 1.94 for stability", -1, -1});
  return result;
}

/// No border could be told apart: slices and edges are all there is.
inline ventricle::Result sample_failed() {
  ventricle::Result result = sample_result();
  for (ventricle::Gate& gate : result.gates) {
    gate.edge_surfaces = {};
    gate.labels.borders = Mask(result.study.grid());
    gate.labels.circle = {};
    gate.labels.division_slice = gate.labels.big_slice = gate.base_slice = -1;
    gate.labels.notes.push_back({Severity::failure, "labels.no_circle",
                                 "no edge of any slice is close enough to a circle to be a border", gate.gate, -1});
  }
  measure_sample(result);
  result.wall_variation = std::nullopt;
  result.verdict = ventricle::Verdict::fail;
  result.flags = {
      {"surface_missing", Severity::failure, "no endocardial border was found in gates 1, 2, 3, 4, 5, 6, 7, 8", 8},
      {"surface_missing", Severity::failure, "no epicardial border was found in gates 1, 2, 3, 4, 5, 6, 7, 8", 8}};
  return result;
}

/// One volume: surfaces and their volumes, but no curve and no ejection fraction.
inline ventricle::Result sample_ungated() {
  ventricle::Result result = sample_result({.gates = 1});
  result.wall_variation = std::nullopt;
  return result;
}

inline ventricle::Result sample_without_endo() {
  ventricle::Result result = sample_result();
  for (ventricle::Gate& gate : result.gates) gate.edge_surfaces.endo = std::nullopt;
  measure_sample(result);
  result.wall_variation = std::nullopt;
  result.verdict = ventricle::Verdict::fail;
  result.flags = {
      {"surface_missing", Severity::failure, "no endocardial border was found in gates 1, 2, 3, 4, 5, 6, 7, 8", 8}};
  return result;
}

/// An image of the blood pool: the cavity alone.
inline ventricle::Result sample_blood_pool() {
  ventricle::Result result = sample_result();
  for (ventricle::Gate& gate : result.gates) gate.edge_surfaces.epi = std::nullopt;
  measure_sample(result);
  result.wall_variation = std::nullopt;
  result.verdict = ventricle::Verdict::check;
  result.flags = {{"blood_pool", Severity::warning, "the cavity is bright and no wall is seen", 1}};
  for (int n = 1; n <= 8; ++n)  // a page must have room for them
    result.flags.push_back({"flag_" + std::to_string(n), Severity::warning,
                            "something else that a reader should look at before the numbers are believed", 1.0 * n});
  return result;
}

inline report::Provenance sample_provenance() {
  report::Provenance provenance;
  provenance.program_version = "0.1.0";
  provenance.commit = "0123456789abcdef0123456789abcdef01234567";
  provenance.command = "dynasurf ventricle patient.dcm --out result";
  provenance.inputs = {{"patient.dcm", "9f86d081884c7d659a2feaa0c55ad015a3bf4f1b2b0b822cd15d6c15b0f00a08", 4}};
  provenance.options_json =
      R"({"noise_fraction":0,"edges":{"method":"canny","sigma_px":1.8,"low":0.3,"high":0.7,"threshold":"max_fraction"},)"
      R"("labels":{"coarse":{"x_px":null,"y_px":null,"radius_px":null},"method":{"method":"mlc","min_gap_px":2}},)"
      R"("field":{"method":"gvf","mu":2,"iterations":150,"scheme":"thesis","safe_step":true},"mesh_level":3,)"
      R"("evolution":{"solver":{"method":"rk4"},"mass_kg":1,"force":{"strength":10,"drag":0.1,"sampling":"nearest"}}})";
  return provenance;
}

}  // namespace dynasurf::test
