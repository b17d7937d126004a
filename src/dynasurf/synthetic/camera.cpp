#include "dynasurf/synthetic/camera.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "dynasurf/core/detail/degrees.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/mean_point.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/synthetic/detail/assembly.hpp"
#include "dynasurf/synthetic/detail/torso.hpp"

namespace dynasurf::synthetic {
namespace {

/// Where the heart lies against the axis of rotation, as virtual patients have it in the world.
const Vec3& heart_place() {
  static const Vec3 place{45, -35, 10};
  return place;
}

/// The activity of a patient on the fine grid of the camera.
Phantom patient_on(const CameraPhantom& o, const Grid& grid) {
  VirtualPatient patient = o.heart;
  patient.cut = Cut::transaxial;
  patient.base_first = false;
  patient.fwhm_mm = 0;
  patient.noise = {};
  patient.noise.seed = o.seed;
  patient.irregular.tails = 0, patient.irregular.depth = 0;
  patient.lattice = {grid.dims[0], grid.dims[1], grid.dims[2], grid.spacing[0], grid.spacing[1], grid.spacing[2]};
  patient.pose = {};
  // The stack lies around the world's axis, not around the heart.
  patient.pose.offset_x_mm = heart_place()[0];
  patient.pose.offset_y_mm = heart_place()[1];
  return make_phantom(patient);
}

/// An ellipsoid of revolution about the long axis that holds the heart of the first gate.
struct HeartSolid {
  Vec3 middle{0, 0, 0}, axis{0, 0, 1};
  double along = 1, across = 1;
  bool contains(const Vec3& p) const {
    const Vec3 d = p - middle;
    const double z = d.dot(axis), r2 = d.squaredNorm() - z * z;
    return z * z / (along * along) + r2 / (across * across) <= 1;
  }
};

HeartSolid heart_of(const Phantom& patient) {
  constexpr double rim_mm = 15;  // the right ventricle, the atria and the blood about them
  HeartSolid heart;
  const auto& vertices = patient.truth.front().epi.vertices;
  heart.middle = mean_point(vertices);
  heart.axis = *patient.axis;
  for (const Vec3& p : vertices) {
    const Vec3 d = p - heart.middle;
    const double z = d.dot(heart.axis);
    heart.along = std::max(heart.along, std::abs(z) + rim_mm);
    heart.across = std::max(heart.across, std::sqrt(std::max(0.0, d.squaredNorm() - z * z)) + rim_mm);
  }
  return heart;
}

Image attenuation_on(const CameraPhantom& o, const Phantom& patient, const Grid& grid) {
  const HeartSolid heart = heart_of(patient);
  return render(grid,
                [&](const Vec3& p) {
                  const Vec3 world = to_world(grid, p);
                  if (heart.contains(world)) return soft_tissue_per_mm;
                  return torso_attenuation(o.arms_down, world - heart_place());
                },
                {Vec3::Constant(-grid.spacing[0]), Vec3::Constant(grid.dims[0] * grid.spacing[0])}, 0, {1, 1, 1});
}

std::vector<double> radii_of(const CameraPhantom& o) {
  std::vector<double> radius;
  for (const double angle : angles_of(o.acquisition)) {
    const double body = torso_reach_mm(o.arms_down, angle * degrees, heart_place());
    const bool is_circle = o.acquisition.orbit == Orbit::circular;
    radius.push_back(is_circle ? o.acquisition.radius_mm : body + o.acquisition.gap_mm);
    if (radius.back() < body)
      throw OptionError("option acquisition.radius_mm is " + std::to_string(std::lround(o.acquisition.radius_mm)) +
                        "; expected at least " + std::to_string(ceil_int(body)) + ", where the body is");
  }
  return radius;
}

/// The grid of the short-axis stack about the heart: columns to the lateral wall, rows to the inferior one.
Grid short_axis_grid(const Reorientation& o, const Phantom& patient, double voxel_mm) {
  const HeartSolid heart = heart_of(patient);
  const auto across = [](const Vec3& axis) -> Vec3 { return Vec3(axis[1], -axis[0], 0).normalized(); };
  const double towards = o.axis_error_towards_deg * degrees, error = o.axis_error_deg * degrees;
  const Vec3 lateral = across(heart.axis), inferior = heart.axis.cross(lateral);
  const Vec3 wrong =
      own::cos(error) * heart.axis + own::sin(error) * (own::cos(towards) * lateral + own::sin(towards) * inferior);
  Mat3 direction;
  direction.col(2) = wrong.normalized();
  direction.col(0) = across(direction.col(2));
  direction.col(1) = direction.col(2).cross(direction.col(0));
  return make_grid({o.size, o.size, o.slices, voxel_mm, voxel_mm, voxel_mm}, direction, heart.middle);
}

/// As a file holds it.
Study study_of(std::vector<Image> gates, const Phantom& patient, View view, SliceOrder order) {
  for (Image& image : gates)
    for (float& value : image.values) value = std::max(0.0F, value);
  Study study = make_study(std::move(gates), patient.study.cycle_ms);
  study.view = view, study.slice_order = order;
  return study;
}

}  // namespace

CameraStudy make_camera_study(const CameraPhantom& options, const Progress& progress) {
  int stages = 0;
  const auto next_stage = [&](std::string_view stage) {
    progress.check();
    progress(stage, stages++, 3);
  };
  CameraPhantom o = options;
  check_options(o, std::string(CameraPhantom::name));
  if (const Osem* osem = std::get_if<Osem>(&o.reconstruction)) require_even_subsets(*osem, o.acquisition.views);
  const std::vector<double> radius = radii_of(o);
  const Grid fine = activity_grid(o.acquisition, Vec3(0, 0, heart_place()[2]));
  CameraStudy made;
  next_stage("patient");
  made.truth = patient_on(o, fine);
  made.truth.kind = CameraPhantom::name;
  const Image map = attenuation_on(o, made.truth, fine);
  next_stage("views");
  made.projections = acquire(made.truth.study.gates, map, radius, o.acquisition, o.seed);
  made.projections.cycle_ms = made.truth.study.cycle_ms;
  // The mean over the fine voxels of a coarse one is an interpolation at their common corner for 2, else near enough.
  made.attenuation = cut_out(map, transaxial_grid(made.projections));
  next_stage("slices");
  std::vector<Image> gates = reconstruct_views(made.projections, &made.attenuation, o.reconstruction);
  const Grid cut = short_axis_grid(o.reorientation, made.truth, o.acquisition.bin_mm);
  std::vector<Image> turned;
  turned.reserve(gates.size());
  for (const Image& gate : gates) turned.push_back(cut_out(gate, cut));
  const Osem* const osem = std::get_if<Osem>(&o.reconstruction);
  const Attenuation attenuation = osem && osem->attenuation   ? Attenuation::corrected
                                  : o.acquisition.attenuation ? Attenuation::uncorrected
                                                              : Attenuation::unknown;
  made.transaxial = study_of(std::move(gates), made.truth, View::transaxial, SliceOrder::unknown);
  made.short_axis = study_of(std::move(turned), made.truth, View::short_axis, SliceOrder::apex_to_base);
  made.transaxial.attenuation = made.short_axis.attenuation = attenuation;
  return made;
}

}  // namespace dynasurf::synthetic
