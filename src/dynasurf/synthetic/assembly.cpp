#include "dynasurf/synthetic/detail/assembly.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/synthetic/detail/noise.hpp"

namespace dynasurf::synthetic {
namespace {

Vec3 middle_of(const Grid& grid) {
  return {(grid.dims[0] - 1) * grid.spacing[0] / 2, (grid.dims[1] - 1) * grid.spacing[1] / 2,
          (grid.dims[2] - 1) * grid.spacing[2] / 2};
}

}  // namespace

Grid make_grid(const Lattice& lattice, const Mat3& direction, const Vec3& centre_world) {
  Grid grid;
  grid.dims = {lattice.nx, lattice.ny, lattice.nz};
  grid.spacing = {lattice.dx_mm, lattice.dy_mm, lattice.dz_mm};
  grid.direction = direction;
  grid.origin = centre_world - direction * middle_of(grid);
  return grid;
}

/// The rotation about an axis of length 1 (Rodrigues).
Mat3 turn_about(const Vec3& axis, double angle) {
  Mat3 across;
  across << 0, -axis[2], axis[1], axis[2], 0, -axis[0], -axis[1], axis[0], 0;
  return Mat3::Identity() + own::sin(angle) * across + (1 - own::cos(angle)) * (across * across);
}

Frame make_frame(const Grid& grid, const Pose& pose, const Vec3& middle) {
  Frame frame;
  const double towards = pose.tilt_towards_deg * degrees;
  const Vec3 hinge{-own::sin(towards), own::cos(towards), 0};  // turning about it leans +k into the direction asked for
  if (pose.tilt_deg != 0) frame.rotation = turn_about(hinge, pose.tilt_deg * degrees);
  frame.origin = middle_of(grid) + Vec3(pose.offset_x_mm, pose.offset_y_mm, pose.offset_z_mm) - frame.rotation * middle;
  return frame;
}

RightVentricle right_ventricle_beside(double outer_radius, double apex_z, double base_z) {
  RightVentricle v;
  v.radius = 0.95 * outer_radius;
  v.half_length = 0.6 * (base_z - apex_z);
  v.centre = {-0.62 * outer_radius, 0, base_z - 0.35 * (base_z - apex_z)};
  v.base_z = base_z;
  return v;
}

Box box_of(const RightVentricle& v) {
  const Vec3 half{v.radius, v.radius, v.half_length};
  return {v.centre - half, v.centre + half};
}

bool in_sector(const Vec3& p, double towards_deg, double width_deg) {
  // To within half a turn, so that a sector may lie across the seam of the angle.
  const double beside = std::remainder(own::atan2(p[1], p[0]) / degrees - towards_deg, 360.0);
  return std::abs(beside) <= width_deg / 2;
}

Box hull(const Box& a, const Box& b) { return {a.low.cwiseMin(b.low), a.high.cwiseMax(b.high)}; }

Image render_scene(const Grid& grid, const Frame& frame, const Scene& scene, double fwhm_mm,
                   const Index3& sub_samples) {
  Box box;
  box.low.setConstant(std::numeric_limits<double>::infinity());
  box.high = -box.low;
  // The box of a box that was turned.
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 p{(corner & 1 ? scene.support.high : scene.support.low)[0],
                 (corner & 2 ? scene.support.high : scene.support.low)[1],
                 (corner & 4 ? scene.support.high : scene.support.low)[2]};
    box.low = box.low.cwiseMin(frame.to_grid(p));
    box.high = box.high.cwiseMax(frame.to_grid(p));
  }
  return render(
      grid, [&](const Vec3& p) { return scene.activity(frame.to_object(p)); }, box, fwhm_mm, sub_samples);
}

TriMesh place_in_world(const Grid& grid, const Frame& frame, TriMesh mesh) {
  for (Vec3& p : mesh.vertices) p = frame.to_grid(p);
  return to_world(grid, std::move(mesh));
}

double fwhm_before_filter(double fwhm_mm, const Noise& noise) {
  if (noise.peak_counts <= 0) return fwhm_mm;
  // Widths of Gaussians that follow each other add by their squares.
  return std::sqrt(std::max(0.0, fwhm_mm * fwhm_mm - noise.filter_fwhm_mm * noise.filter_fwhm_mm));
}

Noise limit_filter(Noise noise, double fwhm_mm, Notes& notes) {
  if (noise.peak_counts <= 0 || noise.filter_fwhm_mm <= fwhm_mm) return noise;
  TextOutput text;
  text << "the filter of " << noise.filter_fwhm_mm << " mm is wider than the point spread of " << fwhm_mm
       << " mm that it is part of; it was narrowed to that";
  notes.push_back({Severity::warning, "phantom.filter_narrowed", text.str()});
  noise.filter_fwhm_mm = fwhm_mm;
  return noise;
}

namespace {

/// Takes a part of what is slow out of the noise.
Image with_texture(const Image& mean, Image drawn, double texture) {
  if (texture <= 0) return drawn;
  constexpr double slow_voxels = 4;
  const float strength = texture;
  Image noise(mean.grid);
  for (std::size_t v = 0; v < noise.values.size(); ++v) noise.values[v] = drawn.values[v] - mean.values[v];
  const Image slow = blur(noise, slow_voxels * mean.grid.spacing.minCoeff());
  for (std::size_t v = 0; v < noise.values.size(); ++v)
    drawn.values[v] = std::max(0.0F, drawn.values[v] - strength * slow.values[v]);
  return drawn;
}

}  // namespace

std::vector<Image> expose(std::vector<Image> activity, const Noise& noise) {
  constexpr double peak_without_counts = 1000;
  float hottest = 0;
  for (const Image& image : activity)
    for (float value : image.values) hottest = std::max(hottest, value);
  const double peak = noise.peak_counts > 0 ? noise.peak_counts : peak_without_counts;
  const double scale = hottest > 0 ? peak / hottest : 1;
  for (std::size_t gate = 0; gate < activity.size(); ++gate) {
    Image& image = activity[gate];
    for (float& value : image.values) value *= scale;
    if (noise.peak_counts > 0) {
      image = with_texture(image, draw_counts(image, noise.seed, gate), noise.texture);
      if (noise.filter_fwhm_mm > 0) image = blur(image, noise.filter_fwhm_mm);
    }
    if (noise.gaussian_percent > 0)
      image = add_gaussian_noise(std::move(image), peak * noise.gaussian_percent / 100, noise.seed, gate);
  }
  return activity;
}

Study make_study(std::vector<Image> gates, double cycle_ms) {
  Study study;
  study.format = "synthetic";
  study.modality = "NM";
  study.image_type = gates.size() > 1 ? "RECON GATED TOMO" : "RECON TOMO";
  study.view = View::short_axis;
  study.slice_order = SliceOrder::apex_to_base;
  if (gates.size() > 1 && cycle_ms > 0) {
    study.cycle_ms = cycle_ms;
    for (std::size_t g = 0; g < gates.size(); ++g) study.time_ms.push_back(cycle_ms * g / gates.size());
  }
  study.gates = std::move(gates);
  return study;
}

void summarise(Phantom& phantom) {
  if (phantom.truth.size() < 2) return;
  const auto [least, most] =
      std::minmax_element(phantom.truth.begin(), phantom.truth.end(),
                          [](const TrueGate& a, const TrueGate& b) { return a.endo_ml < b.endo_ml; });
  phantom.edv_ml = most->endo_ml;
  phantom.esv_ml = least->endo_ml;
  if (most->endo_ml > 0) phantom.ef_percent = 100 * (most->endo_ml - least->endo_ml) / most->endo_ml;
}

}  // namespace dynasurf::synthetic
