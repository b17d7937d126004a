#pragma once
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::ventricle {

/// Moves a surface from where its particles stopped onto the steepest slope of the image. An edge detector blurs the
/// image once more, which moves the edges of curved walls inwards, and sees one slice at a time; reading the image
/// along the surface's normals does neither.
struct Settle {
  int rounds = 2;
  double reach_voxels = 1.5;
};
void describe(auto& visit, Settle& o) {
  visit("rounds", o.rounds,
        OptionInfo{
            "how often the surface moves to the steepest slope of the image along its normals; 0: it stays where its "
            "particles stopped (thesis)",
            "", 0, 100});
  visit("reach_voxels", o.reach_voxels,
        OptionInfo{"how far to both sides a round looks for it", "smallest voxel sides", 0.1, 10});
}

/// Moves the vertices of a closed surface (grid frame of `image`, oriented outwards) along their normals to where the
/// image rises or falls most steeply; which of the two, the surface as a whole decides. Slopes are averaged over each
/// vertex and its neighbours, along their own normals: that takes noise away without moving the edge of a curved wall.
/// Where no slope is steepest within reach, or it is weak, a vertex moves by the surface's median. Vertices that face
/// `base` (unit; zero: none do) within 60 degrees stay: there a surface is closed by a lid that no image shows.
TriMesh settle_on_slope(TriMesh mesh, const Image& image, const Vec3& base, const Settle& options);

}  // namespace dynasurf::ventricle
