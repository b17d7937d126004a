// Prints the table of README.md: both surfaces of a phantom in seven states of illness, and by its blood pool. With an
// argument it draws the labelled voxels of one slice and the cuts through the surfaces into that file (SVG).
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/presets.hpp"

using namespace dynasurf;

namespace {

struct Case {
  std::string name;
  Pathology made;
};

std::vector<Case> cases() {
  const auto ill = [](Disease disease, double amplitude = 0.8) {
    Pathology p;
    p.disease = disease;
    p.amplitude = amplitude;
    return p;
  };
  Pathology healthy = ill(Disease::inferior);
  healthy.uptake = 1;
  return {{"healthy", healthy},
          {"inferior", ill(Disease::inferior)},
          {"apical", ill(Disease::apical)},
          {"lateral", ill(Disease::lateral)},
          {"anteroapical", ill(Disease::anteroapical)},
          {"digestive, 0.5", ill(Disease::digestive, 0.5)},
          {"digestive, 1.0", ill(Disease::digestive, 1.0)},
          {"right ventricle", ill(Disease::right_ventricle, 0.4)},
          {"blood pool", ill(Disease::muga)}};
}

/// Mean distance of the true surface's vertices to a surface, mm: what is missing of it counts too.
double mean_distance_mm(const TriMesh& truth, const TriMesh& mesh) {
  const ClosestPoint nearest(mesh);
  double sum = 0;
  for (const Vec3& p : truth.vertices) sum += std::sqrt(nearest(p).distance2);
  return sum / static_cast<double>(truth.vertices.size());
}

void print_surface(const std::optional<Surface>& surface, const TriMesh& truth, double truth_ml) {
  if (!surface)
    std::printf("        -       -         -");
  else
    std::printf("  %7.1f  %+6.1f  %8.2f", surface->volume_ml, 100 * (surface->volume_ml / truth_ml - 1),
                mean_distance_mm(truth, surface->mesh));
}

VentricleResult reconstructed(const Phantom& phantom) {
  return reconstruct(phantom.study, ventricle_preset("edges"));
}

void print_case(const Case& c) {
  const Phantom phantom = make_phantom(c.made);
  const VentricleResult result = reconstructed(phantom);
  const Gate& gate = result.gates.front();
  const TrueGate& truth = phantom.truth.front();
  double seconds = 0;
  for (const auto& [stage, s] : result.seconds)
    if (stage == "surfaces") seconds += s;
  std::printf("%-16s", c.name.c_str());
  print_surface(gate.endo, truth.endo, truth.endo_ml);
  print_surface(gate.epi, truth.epi, truth.epi_ml);
  std::printf("  %6.3f  %s", seconds, std::string(word_of(result.verdict)).c_str());
  for (const Flag& flag : result.flags) std::printf(" %s", flag.code.c_str());
  std::printf("\n");
}

/// One slice as a panel: border voxels as squares, cuts through both surfaces as lines.
std::string panel(const Case& c, double left, double top) {
  const VentricleResult result = reconstructed(make_phantom(c.made));
  const Gate& gate = result.gates.front();
  const Grid& grid = result.study.grid();
  constexpr double scale = 1.35, side = 200;  // pixels per mm, width of a panel
  const int column = grid.dims[0] / 2;        // along the heart, through its middle
  const Vec3 middle = 0.5 * Vec3(0, (grid.dims[1] - 1) * grid.spacing[1], (grid.dims[2] - 1) * grid.spacing[2]);
  const auto x = [&](double mm) { return std::to_string(left + side / 2 + scale * (mm - middle[1])); };
  const auto y = [&](double mm) { return std::to_string(top + 20 + side / 2 - scale * (mm - middle[2])); };
  std::string svg =
      "<text x=\"" + std::to_string(left + 6) + "\" y=\"" + std::to_string(top + 14) + "\">" + c.name + "</text>\n";
  for (int k = 0; k < grid.dims[2]; ++k)
    for (int j = 0; j < grid.dims[1]; ++j) {
      const auto bits = gate.labels.borders(column, j, k);
      if (bits == 0) continue;
      svg += "<rect x=\"" + x(j * grid.spacing[1] - 1.2) + "\" y=\"" + y(k * grid.spacing[2] + 1.2) +
             "\" width=\"3.2\" height=\"3.2\" fill=\"" + (bits & Labels::epi_bit ? "#d55e00" : "#0072b2") + "\"/>\n";
    }
  for (const auto* surface : {&gate.endo, &gate.epi}) {
    if (!*surface) continue;
    const TriMesh mesh = to_grid(grid, (*surface)->mesh);
    for (const auto& polygon : cross_section(mesh, Vec3((column + 1e-3) * grid.spacing[0], 0, 0), Vec3(1, 0, 0))) {
      svg += "<polyline fill=\"none\" stroke-width=\"1.6\" stroke=\"" +
             std::string(surface == &gate.epi ? "#b34700" : "#004f7c") + "\" points=\"";
      for (const Vec3& p : polygon) svg += x(p[1]) + "," + y(p[2]) + " ";
      svg += "\"/>\n";
    }
  }
  return svg;
}

void draw(const char* path) {
  std::ofstream file(path);
  file << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1000 450\" width=\"1000\">\n"
          "<style>text{font:12px sans-serif}</style><rect width=\"1000\" height=\"450\" fill=\"#fff\"/>\n";
  int n = 0;
  for (const Case& c : cases()) {
    file << panel(c, 200.0 * (n % 5), 225.0 * (n / 5));
    ++n;
  }
  file << "</svg>\n";
}

}  // namespace

int main(int count, char** arguments) {
  std::printf(
      "                 inner                     outer                   surfaces\n"
      "state            mL     error %%   apart mm  mL    error %%   apart mm   s      verdict, flags\n");
  for (const Case& c : cases()) print_case(c);
  if (count > 1) draw(arguments[1]);
}
