#include "dynasurf/report/detail/lod_page.hpp"

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/report/detail/page_parts.hpp"
#include "dynasurf/report/detail/page_template.hpp"

namespace dynasurf::report {

using namespace detail;

void write_lod_page(std::span<const TriMesh> levels, std::span<const cloud::LodTransition> transitions,
                    const LodPage& options, const std::filesystem::path& path) {
  if (levels.empty() || transitions.size() + 1 != levels.size())
    throw InputError("a page of levels of detail needs levels and a transition between each two of them");
  cloud::LodChain chain = cloud::lod_chain(levels, options.rule);
  if (!options.largest_px.empty()) chain.largest_px = options.largest_px;
  Box box;
  for (const TriMesh& level : levels)
    for (const Vec3& p : level.vertices) {
      box.low = box.low.cwiseMin(p);
      box.high = box.high.cwiseMax(p);
    }
  Json data = Json::object();
  data["low"] = {box.low[0], box.low[1], box.low[2]};
  data["high"] = {box.high[0], box.high[1], box.high[2]};
  data["fov_deg"] = options.camera.fov_deg;
  data["edge_px"] = options.rule.edge_px;
  data["hysteresis_percent"] = options.rule.hysteresis_percent;
  data["instances"] = options.instances;
  // The limits of the chain, told by mean edges: the page sets them anew for the edge on the screen its user asks for.
  data["levels"] = data["transitions"] = Json::array();
  for (std::size_t n = 0; n < levels.size(); ++n)
    data["levels"].push_back({{"positions", packed(steps_of(levels[n].vertices, box))},
                              {"triangles", triangles_of(levels[n])},
                              {"mean_edge", options.rule.edge_px * chain.diagonal / chain.largest_px[n]}});
  for (const cloud::LodTransition& transition : transitions)
    data["transitions"].push_back(transition_json(transition, box));
  io::write_file(path, filled_page(lod_page_template(), data));
}

}  // namespace dynasurf::report
