// Marching squares on a slice with a saddle, in both readings: two bright corners of a square are joined by a bridge,
// or kept apart. Both are right by their four values; the asymptotic decider asks the saddle between them. Draws
// marching_squares.svg (thesis figs 5.6-5.7).
#include <cstdio>
#include <fstream>
#include <string>

#include "dynasurf/core/options.hpp"
#include "dynasurf/mesh/marching.hpp"

using namespace dynasurf;

namespace {

std::string path_of(const mesh::IsoLine& line, double left, const char* colour) {
  std::string d;
  for (const auto& p : line)
    d += (d.empty() ? "M" : "L") + std::to_string(left + 40 * p[0]) + " " + std::to_string(200 - 40 * p[1]) + " ";
  return "<path d='" + d + "' fill='none' stroke-width='2' stroke='" + colour + "'/>\n";
}

}  // namespace

int main() {
  Grid grid;
  grid.dims = {4, 4, 1};
  Image image(grid);
  image(1, 1, 0) = 1, image(2, 2, 0) = 0.8F;
  image(2, 1, 0) = image(1, 2, 0) = 0.1F;

  std::ofstream drawing("marching_squares.svg");
  drawing << "<svg xmlns='http://www.w3.org/2000/svg' width='600' height='220'>\n";
  std::size_t lines[3] = {};
  for (const mesh::Saddle saddle : {mesh::Saddle::joined, mesh::Saddle::separated, mesh::Saddle::asymptotic}) {
    const auto n = static_cast<std::size_t>(saddle);
    const auto found = mesh::marching_squares(image, 0, 0.4, saddle);
    lines[n] = found.size();
    std::printf("%-10s %zu closed lines\n", word_of(saddle).data(), found.size());
    for (const mesh::IsoLine& line : found) drawing << path_of(line, 20 + 190 * static_cast<double>(n), "#a03028");
  }
  drawing << "</svg>\n";
  // 0.6 * 0.4 > 0.3 * 0.3: the saddle lies above the level, so the decider joins.
  return lines[0] == 1 && lines[1] == 2 && lines[2] == 1 && drawing ? 0 : 1;
}
