#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/synthetic/detail/assembly.hpp"
#include "dynasurf/synthetic/detail/solids.hpp"

namespace dynasurf::synthetic {
namespace {

double ball_ml(double radius_mm) { return 4.0 / 3.0 * M_PI * radius_mm * radius_mm * radius_mm / 1000; }

/// Voxels whose centre lies between two radii are 1, all others 0.
Phantom binary_shell(std::string_view kind, int size, double spacing, double inner_voxels, double outer_voxels) {
  const Grid grid = make_grid({size, size, size, spacing, spacing, spacing});
  const Frame frame = make_frame(grid, {}, {0, 0, 0});
  Image image(grid);
  for (int k = 0; k < size; ++k)
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) {
        const double r = frame.to_object(centre_of(grid, {i, j, k})).norm() / spacing;
        image(i, j, k) = r >= inner_voxels && r <= outer_voxels ? 1.0f : 0.0f;
      }
  Phantom phantom;
  phantom.kind = kind;
  TrueGate truth;
  if (inner_voxels > 0) truth.endo = place_in_world(grid, frame, sphere_surface(inner_voxels * spacing));
  truth.epi = place_in_world(grid, frame, sphere_surface(outer_voxels * spacing));
  truth.endo_ml = ball_ml(inner_voxels * spacing);
  truth.epi_ml = ball_ml(outer_voxels * spacing);
  phantom.truth.push_back(std::move(truth));
  phantom.study = make_study({std::move(image)}, 0);
  return phantom;
}

}  // namespace

Phantom make_phantom(const TwoSpheres& options) {
  TwoSpheres o = options;
  check_options(o, std::string(TwoSpheres::name));
  if (o.inner_radius_voxels >= o.outer_radius_voxels) {
    TextOutput text;
    text << "option spheres.inner_radius_voxels is " << o.inner_radius_voxels
         << "; expected a number < outer_radius_voxels (" << o.outer_radius_voxels << ")";
    throw OptionError(text.str());
  }
  Phantom phantom = binary_shell(TwoSpheres::name, o.size, o.spacing_mm, o.inner_radius_voxels, o.outer_radius_voxels);
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const VoxelSphere& options) {
  VoxelSphere o = options;
  check_options(o, std::string(VoxelSphere::name));
  Phantom phantom = binary_shell(VoxelSphere::name, o.size, o.spacing_mm, 0, o.radius_voxels);
  phantom.options = o;
  return phantom;
}

Phantom make_phantom(const PhantomOptions& options) {
  return std::visit([](const auto& o) { return make_phantom(o); }, options);
}

}  // namespace dynasurf::synthetic
