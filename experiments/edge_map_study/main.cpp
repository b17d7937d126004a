// Prints the table of README.md: of every edge map of fig 3.20, where its field points.
#include <algorithm>
#include <cstdio>

#include "dynasurf/field/edge_map.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/detail/border_distance.hpp"
#include "dynasurf/synthetic/detail/voxel_truth.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

using namespace dynasurf;

namespace {

struct Trial {
  const char* name;
  field::EdgeMapOptions map;
  double mu;
  int iterations;
};

/// The share of the voxels outside the wall, where the field is not negligible, at which it leads nearer to the border.
double share_towards(const field::VectorField& field, const Mask& solid, const mesh::BorderDistance& border) {
  double longest = 0;
  const auto at = [&](std::size_t v) { return Vec3(field.x[v], field.y[v], field.z[v]); };
  for (std::size_t v = 0; v < field.x.size(); ++v) longest = std::max(longest, at(v).norm());
  std::size_t seen = 0, towards = 0;
  const Grid& g = field.grid;
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const std::size_t v = g.index(i, j, k);
        const double length = at(v).norm();
        if (solid.values[v] != 0 || length <= 1e-3 * longest) continue;
        ++seen;
        const Vec3 here = centre_of(g, {i, j, k}), ahead = here + 0.5 * g.spacing.minCoeff() / length * at(v);
        towards += border.mm(ahead) < border.mm(here) ? 1 : 0;
      }
  return seen > 0 ? static_cast<double>(towards) / static_cast<double>(seen) : 0;
}

}  // namespace

int main() {
  const Image image = synthetic::make_phantom(synthetic::Hebron{}).study.gates.front();
  const Mask solid = synthetic::filled_solid(image);
  const mesh::BorderDistance border(synthetic::surface_voxels(solid));
  const field::EdgeMapOptions slope{.of = field::EdgeOperator::gradient}, square{},
      grey{.of = field::EdgeOperator::intensity}, down{.of = field::EdgeOperator::intensity, .reversed = true};
  const Trial trials[] = {{"1: gradient", slope, 0.4, 200},
                          {"2: gradient", slope, 0.2, 100},
                          {"3: gradient", slope, 0.2, 200},
                          {"4: -I", down, 0.2, 100},
                          {"5: +I", grey, 0.2, 100},
                          {"6: test 5 reversed", down, 0.2, 100},
                          {"squared gradient", square, 0.2, 200}};
  std::printf("# Results\n\n| test | mu | iterations | share that points to the wall |\n|---|---|---|---|\n");
  for (const Trial& t : trials) {
    field::Gvf gvf;
    gvf.mu = t.mu;
    gvf.iterations = t.iterations;
    std::printf("| %s | %.1f | %d | %.3f |\n", t.name, t.mu, t.iterations,
                share_towards(field::flow_field(field::edge_map_of(image, t.map), gvf).field, solid, border));
  }
}
