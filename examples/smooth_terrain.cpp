// Spikes on a terrain are taken down by the thesis's smoothing, the hills stay (thesis fig. 5.16).
// Writes terrain_before.ply and terrain_after.ply, and draws both to terrain.svg.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/mesh/smooth.hpp"
#include "dynasurf/synthetic/terrain.hpp"

#include "svg.hpp"

using namespace dynasurf;

namespace {

const synthetic::Terrain kTerrain;

int count_peaks(const TriMesh& m) {
  const auto deficits = mesh::angle_deficits(m);
  return static_cast<int>(std::count_if(deficits.begin(), deficits.end(), [](double d) { return std::abs(d) > 0.2; }));
}

double farthest_from_hills(const TriMesh& m) {
  double farthest = 0;
  for (const Vec3& p : m.vertices)
    farthest = std::max(farthest, std::abs(p[2] - synthetic::hill_height_mm(kTerrain, p[0], p[1])));
  return farthest;
}

}  // namespace

int main() {
  TriMesh m = synthetic::make_terrain(kTerrain);
  io::write_mesh(m, "terrain_before.ply", io::MeshFormat::ply);
  Drawing drawing;
  drawing.mesh(m.vertices, m.triangles, "grey", Vec3(0, 0, 45));
  const int before = count_peaks(m);
  std::printf("before: %d peaks, up to %.2f mm off the hills\n", before, farthest_from_hills(m));
  for (int sweep = 1; sweep <= 10; ++sweep) {
    mesh::smooth(m, {}, 1.0);
    if (sweep == 1 || sweep == 3 || sweep == 10)
      std::printf("after %2d sweeps: %d peaks, up to %.2f mm off\n", sweep, count_peaks(m), farthest_from_hills(m));
  }
  io::write_mesh(m, "terrain_after.ply", io::MeshFormat::ply);
  drawing.mesh(m.vertices, m.triangles, "teal");
  drawing.save("terrain.svg");
  return count_peaks(m) < before / 10 && farthest_from_hills(m) < 1.5 ? 0 : 1;
}
