// How far published surfaces lie from the true border of the blurred image: where its gradient is largest. The image is
// made a second time without noise on a lattice twice as fine, and every vertex of the side wall looks along the
// gradient there for the place of the steepest slope.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include <gtest/gtest.h>

#include "dynasurf/image/intensity.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::ventricle {
namespace {

constexpr double voxel_mm = 2.87;
constexpr double slice_mm = 5.74;

Vec3 gradient_at(const Image& image, const Vec3& p) {
  constexpr double h = 0.7;
  Vec3 g;
  for (int a = 0; a < 3; ++a)
    g[a] = (image::sample_cubic(image, p + h * Vec3::Unit(a)) - image::sample_cubic(image, p - h * Vec3::Unit(a))) /
           (2 * h);
  return g;
}

/// Distance along the gradient to the nearest place where the slope is largest; none within 8 mm: 8.
double to_steepest_mm(const Image& image, const Vec3& p) {
  constexpr double step = 0.25, reach = 8;
  const Vec3 way = gradient_at(image, p).normalized();
  const auto slope = [&](double s) { return gradient_at(image, p + s * way).dot(way); };
  double best = reach;
  double before = slope(-reach - step), here = slope(-reach);
  for (double s = -reach; s <= reach; s += step) {
    const double after = slope(s + step);
    if (here > 0 && here >= before && here > after) {
      const double bend = before - 2 * here + after;
      const double top = s + step * (bend < 0 ? 0.5 * (before - after) / bend : 0);
      best = std::min(best, std::abs(top));
    }
    before = here, here = after;
  }
  return best;
}

template <class Options>
Image fine_image(Options options) {
  options.lattice = {128, 128, 46, voxel_mm / 2, voxel_mm / 2, slice_mm / 2};
  options.noise = {0, 0, 0, 1};
  return synthetic::make_phantom(options).study.gates.front();
}

struct Error {
  double mean_voxels = 0;
  int vertices = 0;
};

/// Of the vertices whose slices have the wall on their side: not those on the caps that close a surface at its ends.
Error error_of(const Surface& surface, const Gate& gate, const Image& fine) {
  double lowest = 1e9;
  const Vec3 up = fine.grid.direction.col(2);
  for (const Vec3& p : surface.mesh.vertices) lowest = std::min(lowest, p.dot(up));
  Error error;
  for (const Vec3& p : surface.mesh.vertices) {
    if (p.dot(up) < lowest + 2 * slice_mm) continue;
    if (gate.edge_surfaces.base_plane && gate.edge_surfaces.base_plane->height(p) > -1.5 * slice_mm) continue;
    error.mean_voxels += to_steepest_mm(fine, to_grid(fine.grid, p)) / voxel_mm;
    ++error.vertices;
  }
  error.mean_voxels /= std::max(1, error.vertices);
  return error;
}

/// Mean error of both surfaces in voxels, with particles that stop at one point of their voxels or another, and with or
/// without the last way to the steepest slope.
Error error_with(dynamics::StopPoint point, int rounds, const Study& study, const Image& fine, const char* name) {
  Options options = preset("edges");
  options.evolution.stop.point = point;
  options.settle.rounds = rounds;
  options.field = field::SteadyGvf{};
  const Result result = reconstruct(study, options);
  const Gate& gate = result.gates.front();
  Error both;
  if (!gate.edge_surfaces.endo || !gate.edge_surfaces.epi) return both;
  const Error endo = error_of(*gate.edge_surfaces.endo, gate, fine),
              epi = error_of(*gate.edge_surfaces.epi, gate, fine);
  both.vertices = endo.vertices + epi.vertices;
  both.mean_voxels = (endo.mean_voxels * endo.vertices + epi.mean_voxels * epi.vertices) / both.vertices;
  // The source of the figures in docs/validation.md.
  std::printf("%s, stop %s, %d rounds: endo %.3f, epi %.3f voxels\n", name, std::string(word_of(point)).c_str(), rounds,
              endo.mean_voxels, epi.mean_voxels);
  return both;
}

void expect_subvoxel(const Study& study, const Image& fine, const char* name) {
  const Error entry = error_with(dynamics::StopPoint::entry, 0, study, fine, name);
  const Error subvoxel = error_with(dynamics::StopPoint::subvoxel, 0, study, fine, name);
  const Error settled = error_with(dynamics::StopPoint::subvoxel, Settle{}.rounds, study, fine, name);
  for (const Error& error : {entry, subvoxel, settled}) ASSERT_GT(error.vertices, 500);
  EXPECT_GT(entry.mean_voxels, 0.35) << name;  // about half a voxel: the near face of a voxel round the border
  // The stop alone: the edge detector's own blur (1 pixel) moves edges of curved walls inwards.
  EXPECT_LT(subvoxel.mean_voxels, 0.4) << name;
  EXPECT_LT(subvoxel.mean_voxels, 0.65 * entry.mean_voxels) << name;
  EXPECT_LT(settled.mean_voxels, 0.15) << name;  // the aim is 0.25
}

TEST(SubvoxelStop, PutsTheSurfacesOfTheHebronPhantomOnTheSteepestSlope) {
  expect_subvoxel(synthetic::make_phantom(synthetic::Hebron{}).study, fine_image(synthetic::Hebron{}), "hebron");
}

TEST(SubvoxelStop, PutsTheSurfacesOfVirtualPatientsOnTheSteepestSlope) {
  for (const double edv_ml : {110.0, 200.0}) {
    synthetic::VirtualPatient patient;
    patient.gates = 1;
    patient.edv_ml = edv_ml;
    for (const bool noisy : {false, true}) {
      patient.noise = noisy ? synthetic::Noise{120, 8, 0, 3} : synthetic::Noise{0, 0, 0, 1};
      const std::string name =
          "patient of " + std::to_string(static_cast<int>(edv_ml)) + (noisy ? " mL, noisy" : " mL, without noise");
      expect_subvoxel(synthetic::make_phantom(patient).study, fine_image(patient), name.c_str());
    }
  }
}

}  // namespace
}  // namespace dynasurf::ventricle
