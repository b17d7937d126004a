// Prints the table of README.md: both surfaces of a phantom in seven states of illness, and by its blood pool. With an
// argument it draws the labelled voxels of one slice and the cuts through the surfaces into that file (SVG).
#include <cstdio>
#include <fstream>
#include <string>
#include <tuple>

#include "dynasurf/mesh/measures.hpp"

#include "study.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments::pathologies;

namespace {

void print_surface(const TriMesh* mesh, double volume_ml, const TriMesh& truth, double truth_ml) {
  if (mesh == nullptr)
    std::printf("        -       -         -");
  else
    std::printf("  %7.1f  %+6.1f  %8.2f", volume_ml, 100 * (volume_ml / truth_ml - 1), mean_distance_mm(truth, *mesh));
}

void print_case(const Case& c) {
  const synthetic::Phantom phantom = synthetic::make_phantom(c.made);
  const ventricle::Result result = reconstructed(phantom);
  const ventricle::Gate& gate = result.gates.front();
  const synthetic::TrueGate& truth = phantom.truth.front();
  double seconds = 0;
  for (const auto& [stage, s] : result.seconds)
    if (stage == "surfaces") seconds += s;
  std::printf("%-16s", c.name.c_str());
  for (const auto& [surface, true_mesh, true_ml] : {std::tuple(&gate.edge_surfaces.endo, &truth.endo, truth.endo_ml),
                                                    std::tuple(&gate.edge_surfaces.epi, &truth.epi, truth.epi_ml)})
    print_surface(*surface ? &(*surface)->mesh : nullptr, *surface ? (*surface)->volume_ml : 0, *true_mesh, true_ml);
  std::printf("  %6.3f  %s", seconds, std::string(word_of(result.verdict)).c_str());
  for (const ventricle::QualityFlag& flag : result.flags) std::printf(" %s", flag.code.c_str());
  std::printf("\n");
}

/// The walls that were fitted through the blur.
void print_fit(const Case& c) {
  const synthetic::Phantom phantom = synthetic::make_phantom(c.made);
  const ventricle::Result result = reconstructed(phantom);
  if (!result.readings.psf_corrected) return;
  const psf_fit::FittedGate& gate = result.readings.psf_corrected->gates.front();
  const synthetic::TrueGate& truth = phantom.truth.front();
  std::printf("%-16s", c.name.c_str());
  print_surface(&gate.endo, gate.endo_ml.value, truth.endo, truth.endo_ml);
  print_surface(&gate.epi, gate.epi_ml.value, truth.epi, truth.epi_ml);
  const auto holds = [](const heart::Estimate& e, double ml) { return e.low() <= ml && ml <= e.high() ? "yes" : "no"; };
  std::printf("  %5.1f to %5.1f  %s\n", gate.endo_ml.low(), gate.endo_ml.high(), holds(gate.endo_ml, truth.endo_ml));
}

void print_labels(const Case& c) {
  const synthetic::Phantom phantom = synthetic::make_phantom(c.made);
  const ventricle::Result result = ventricle::reconstruct(phantom.study, ventricle::preset("edges"));
  const synthetic::TrueGate& truth = phantom.truth.front();
  const ventricle::EdgeSurfaces rough = at_rest(phantom, false).gates.front().edge_surfaces,
                                smooth = at_rest(phantom, true).gates.front().edge_surfaces;
  std::printf("%-16s  %8.3f", c.name.c_str(), f1_of(result, truth.endo, ventricle::Labels::endo_bit));
  if (rough.epi && smooth.epi)
    std::printf("  %8.3f  %5d to %4d  %5d to %4d\n", f1_of(result, truth.epi, ventricle::Labels::epi_bit),
                peaks_of(rough.endo, truth.endo), peaks_of(smooth.endo, truth.endo), peaks_of(rough.epi, truth.epi),
                peaks_of(smooth.epi, truth.epi));
  else
    std::printf("         -  %5d to %4d             -\n", peaks_of(rough.endo, truth.endo),
                peaks_of(smooth.endo, truth.endo));
}

/// One slice as a panel: border voxels as squares, cuts through both surfaces as lines.
std::string panel(const Case& c, double left, double top) {
  const ventricle::Result result = reconstructed(synthetic::make_phantom(c.made));
  const ventricle::Gate& gate = result.gates.front();
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
             "\" width=\"3.2\" height=\"3.2\" fill=\"" + (bits & ventricle::Labels::epi_bit ? "#d55e00" : "#0072b2") +
             "\"/>\n";
    }
  for (const auto* surface : {&gate.edge_surfaces.endo, &gate.edge_surfaces.epi}) {
    if (!*surface) continue;
    const TriMesh mesh = to_grid(grid, (*surface)->mesh);
    for (const auto& polygon :
         mesh::cross_section(mesh, Vec3((column + 1e-3) * grid.spacing[0], 0, 0), Vec3(1, 0, 0))) {
      svg += "<polyline fill=\"none\" stroke-width=\"1.6\" stroke=\"" +
             std::string(surface == &gate.edge_surfaces.epi ? "#b34700" : "#004f7c") + "\" points=\"";
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
  std::printf(
      "\nWalls fitted through the blur\n"
      "                 inner                     outer                   inner, 90 %%, holds the truth\n"
      "state            mL     error %%   apart mm  mL    error %%   apart mm\n");
  for (const Case& c : cases()) print_fit(c);
  std::printf(
      "\nBorder voxels (F1 within 2 pixels), and peaks of the surfaces without and with smoothing\n"
      "state            inner     outer     peaks inside   outside\n");
  for (const Case& c : cases()) print_labels(c);
  if (count > 1) draw(arguments[1]);
}
