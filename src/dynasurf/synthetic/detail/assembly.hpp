#pragma once
#include <functional>
#include <vector>

#include "dynasurf/synthetic/detail/render.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

// What all phantoms share: placing an object in a grid, seeing it through the camera, counting. Internal.

namespace dynasurf::synthetic {

/// A frame of an object within the grid frame: p_grid = origin + rotation * p_object.
struct Frame {
  Mat3 rotation = Mat3::Identity();
  Vec3 origin{0, 0, 0};
  Vec3 to_grid(const Vec3& p) const { return origin + rotation * p; }
  Vec3 to_object(const Vec3& p) const { return rotation.transpose() * (p - origin); }
};

/// The grid whose middle lies at `centre_world`.
Grid make_grid(const Lattice& lattice, const Mat3& direction = Mat3::Identity(), const Vec3& centre_world = {0, 0, 0});

/// The frame that puts `middle` (a point of the object) at the middle of the grid plus the pose's offset, with the
/// pose's tilt.
Frame make_frame(const Grid& grid, const Pose& pose, const Vec3& middle);

/// Activity of an object in its own frame, above that of its surroundings, and a box that holds it.
struct Scene {
  Density activity;
  Box support;
};

/// A thin-walled right ventricle that lies against the septum (-x) of a left one: an ellipsoid shell of which the part
/// inside the left ventricle's outer surface does not count.
struct RightVentricle {
  Vec3 centre{0, 0, 0};
  double radius = 0, half_length = 0, thickness = 4, base_z = 0;  // mm
  bool in_wall(const Vec3& p) const { return p[2] <= base_z && inside(p, 0) && !inside(p, thickness); }
  bool in_cavity(const Vec3& p) const { return p[2] <= base_z && inside(p, thickness); }

 private:
  bool inside(const Vec3& p, double margin) const {
    const Vec3 d = p - centre;
    const double r = radius - margin, h = half_length - margin;
    return (d[0] * d[0] + d[1] * d[1]) / (r * r) + d[2] * d[2] / (h * h) <= 1;
  }
};
/// The usual one beside a left ventricle of the given outer radius, reaching from `apex_z` to `base_z`.
RightVentricle right_ventricle_beside(double outer_radius, double apex_z, double base_z);
Box box_of(const RightVentricle& ventricle);

/// True when the direction (x, y) lies in a sector of `width_deg` around `towards_deg` (0 is +x, 90 is +y).
bool in_sector(const Vec3& p, double towards_deg, double width_deg);

Box hull(const Box& a, const Box& b);

Image render_scene(const Grid& grid, const Frame& frame, const Scene& scene, double fwhm_mm, const Index3& sub_samples);

TriMesh place_in_world(const Grid& grid, const Frame& frame, TriMesh mesh);

/// The point spread to render with so that it and the filter after counting together have `fwhm_mm`.
double fwhm_before_filter(double fwhm_mm, const Noise& noise);
/// The filter is part of the point spread asked for; a wider one is narrowed to it, with a note.
Noise limit_filter(Noise noise, double fwhm_mm, Notes& notes);

/// Turns activities into counts: scales all gates alike so that the hottest voxel of the study has the peak asked
/// for (1000 without counts), draws, filters, adds Gaussian noise.
std::vector<Image> expose(std::vector<Image> activity, const Noise& noise);

/// Puts the images into a study of one or several gates, timed by `cycle_ms` (0: unknown).
Study make_study(std::vector<Image> gates, double cycle_ms);

/// Fills edv_ml, esv_ml and ef_percent from the truth of the gates when there are several.
void summarise(Phantom& phantom);

}  // namespace dynasurf::synthetic
