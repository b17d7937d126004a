// Prints the table of README.md: what is reconstructed of a phantom part of whose wall is empty. With an argument it
// draws the labelled voxels of one slice and the cuts through the surfaces into that file (SVG).
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "dynasurf/mesh/measures.hpp"

#include "study.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments::missing_data;

namespace {

void print_rows(synthetic::Missing missing, std::string_view preset) {
  std::printf("\nempty: %s, preset %s\n  p %%   V_p mL  V_p/V_0 %%   m %%  |m-p|/p  published V_p/V_0 %%  verdict\n",
              std::string(synthetic::names_of(missing)[static_cast<std::size_t>(missing)]).c_str(),
              std::string(preset).c_str());
  std::optional<double> whole;
  for (std::size_t n = 0; n < std::size(fractions); ++n) {
    const double p = fractions[n];
    const ventricle::Result result = reconstruct_partial(p, missing, preset);
    const auto volume = outer_ml(result);
    if (n == 0) whole = volume;
    const std::string verdict(word_of(result.verdict));
    if (!volume || !whole) {
      std::printf("%5.0f        -          -      -        -  %20.1f  %s\n", 100 * p, published_percent[n],
                  verdict.c_str());
      continue;
    }
    const double m = 1 - *volume / *whole;
    std::printf("%5.0f  %7.1f  %9.1f  %5.1f", 100 * p, *volume, 100 * *volume / *whole, 100 * m);
    if (p > 0)
      std::printf("  %7.2f", std::abs(m - p) / p);
    else
      std::printf("        -");
    std::printf("  %20.1f  %s\n", published_percent[n], verdict.c_str());
  }
}

/// One slice as a panel: border voxels as squares, cuts through both surfaces as lines.
std::string panel(const ventricle::Result& result, const std::string& title, double left) {
  const ventricle::Gate& gate = result.gates.front();
  const Grid& grid = result.study.grid();
  const int slice = gate.labels.big_slice >= 0 ? gate.labels.big_slice : grid.dims[2] / 2;
  constexpr double scale = 1.6, side = 230;  // pixels per mm, width of a panel
  const Vec3 middle = 0.5 * Vec3(grid.dims[0] * grid.spacing[0], grid.dims[1] * grid.spacing[1], 0);
  const auto x = [&](double mm) { return std::to_string(left + side / 2 + scale * (mm - middle[0])); };
  const auto y = [&](double mm) { return std::to_string(20 + side / 2 + scale * (mm - middle[1])); };
  std::string svg = "<text x=\"" + std::to_string(left + 6) + "\" y=\"14\">" + title + "</text>\n";
  for (int j = 0; j < grid.dims[1]; ++j)
    for (int i = 0; i < grid.dims[0]; ++i) {
      const auto bits = gate.labels.borders(i, j, slice);
      if (bits == 0) continue;
      svg += "<rect x=\"" + x(i * grid.spacing[0] - 1.2) + "\" y=\"" + y(j * grid.spacing[1] - 1.2) +
             "\" width=\"3.8\" height=\"3.8\" fill=\"" + (bits & ventricle::Labels::epi_bit ? "#d55e00" : "#0072b2") +
             "\"/>\n";
    }
  for (const auto* surface : {&gate.edge_surfaces.endo, &gate.edge_surfaces.epi}) {
    if (!*surface) continue;
    const TriMesh mesh = to_grid(grid, (*surface)->mesh);
    for (const auto& polygon : mesh::cross_section(mesh, Vec3(0, 0, (slice + 1e-3) * grid.spacing[2]), Vec3(0, 0, 1))) {
      svg += "<polyline fill=\"none\" stroke-width=\"1.6\" stroke=\"" +
             std::string(surface == &gate.edge_surfaces.epi ? "#b34700" : "#004f7c") + "\" points=\"";
      for (const Vec3& p : polygon) svg += x(p[0]) + "," + y(p[1]) + " ";
      svg += "\"/>\n";
    }
  }
  return svg;
}

void draw(const char* path) {
  std::ofstream file(path);
  file << "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 920 255\" width=\"920\">\n"
          "<style>text{font:12px sans-serif}</style><rect width=\"920\" height=\"255\" fill=\"#fff\"/>\n";
  for (std::size_t n = 0; n < std::size(fractions); ++n)
    file << panel(reconstruct_partial(fractions[n], synthetic::Missing::sector, "edges"),
                  std::to_string(std::lround(100 * fractions[n])) + " % empty", 230.0 * static_cast<double>(n));
  file << "</svg>\n";
}

}  // namespace

int main(int count, char** arguments) {
  std::printf("Phantom Mayo, 265.5 mL: outer volume V_p with the part p of the wall empty; m = 1 - V_p / V_0\n");
  for (const std::string_view preset : {"psf_corrected", "edges", "thesis"})
    for (const synthetic::Missing missing : {synthetic::Missing::sector, synthetic::Missing::apex})
      print_rows(missing, preset);
  if (count > 1) draw(arguments[1]);
}
