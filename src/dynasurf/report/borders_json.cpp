#include "dynasurf/report/detail/page_motion.hpp"
#include "dynasurf/report/detail/page_pictures.hpp"
#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::report {

std::string borders_json(const ventricle::BorderResult& result, int gate, std::size_t most_voxels) {
  using namespace detail;
  const ventricle::GateBorders& found = result.gates.at(static_cast<std::size_t>(gate));
  const Grid& grid = result.study.grid();
  const auto around = [&](const std::optional<ventricle::BorderField>& wall) {
    return wall ? surroundings_json(wall->border, wall->field, nullptr, grid) : Json(nullptr);
  };
  const int bin = bin_of(result.study, most_voxels);
  return Json({{"gate", gate + 1},
               {"grid", grid_json(grid)},
               {"bin", bin},
               {"marks", packed(mark_bytes(grid, found.labels.borders, found.edges.edges, bin))},
               {"endo", around(found.endo)},
               {"epi", around(found.epi)}})
             .dump() +
         "\n";
}

}  // namespace dynasurf::report
