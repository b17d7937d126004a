#include "dynasurf/report/detail/lod_plan.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "dynasurf/core/error.hpp"

namespace dynasurf::report {
namespace {

using Json = nlohmann::ordered_json;

/// The distances of --from, which take the place of those that the levels' edges ask for: what serves from a distance
/// on serves up to the size that the body has there.
void set_intervals(LodPlan& plan, const std::vector<double>& from, const cloud::Camera& camera) {
  if (from.size() != plan.from.size() || from.front() != 0 || !std::is_sorted(from.begin(), from.end()))
    throw OptionError("--from: expected " + std::to_string(plan.from.size()) +
                      " distances, one for each level, that begin with 0 and rise");
  plan.from = from;
  for (std::size_t n = 1; n < from.size(); ++n)
    plan.chain.largest_px[n] = plan.chain.diagonal * cloud::focal_px(camera) / from[n];
}

}  // namespace

LodPlan plan_of(const std::vector<TriMesh>& meshes, const cloud::LodRule& rule, const cloud::Camera& camera,
                const std::vector<double>& from) {
  LodPlan plan;
  plan.chain = cloud::lod_chain(meshes, rule);
  // GEN-MIP has both rules: sizes on the screen, and distances that the user sets.
  plan.from = cloud::switch_distances(plan.chain, camera);
  if (!from.empty()) set_intervals(plan, from, camera);
  for (std::size_t n = 0; n + 1 < meshes.size(); ++n) {
    plan.transitions.push_back(cloud::lod_transition(meshes[n + 1], meshes[n]));
    plan.distances.push_back(cloud::start_distance(plan.transitions[n], meshes[n + 1]));
  }
  return plan;
}

nlohmann::ordered_json json_of(const std::vector<NamedLevel>& levels, const LodPlan& plan, const cloud::LodRule& rule,
                               const cloud::Camera& camera) {
  Json json = Json::object();
  json["schema"] = "dynasurf.lod/1";
  json["screen_px"] = {camera.width_px, camera.height_px};
  json["fov_deg"] = camera.fov_deg;
  json["edge_px"] = rule.edge_px;
  json["hysteresis_percent"] = rule.hysteresis_percent;
  json["diagonal"] = plan.chain.diagonal;
  json["levels"] = Json::array();
  for (std::size_t n = 0; n < levels.size(); ++n) {
    const bool last = n + 1 == levels.size();
    const double px = plan.chain.largest_px[n];
    json["levels"].push_back({{"level", n + 1},
                              {"name", levels[n].name},
                              {"triangles", levels[n].mesh.triangles.size()},
                              {"from_distance", plan.from[n]},
                              {"to_distance", last ? Json() : Json(plan.from[n + 1])},
                              {"largest_screen_px", std::isfinite(px) ? Json(px) : Json()}});
  }
  json["transitions"] = Json::array();
  for (std::size_t n = 0; n < plan.transitions.size(); ++n) {
    Json transition = {{"from_level", n + 2},
                       {"to_level", n + 1},
                       {"exact", plan.transitions[n].exact},
                       {"start_distance", plan.distances[n].mean},
                       {"largest_start_distance", plan.distances[n].largest}};
    for (const TransitionStep& s : plan.steps)
      if (s.transition == n)
        transition["meshes"].push_back({{"step", s.step},
                                        {"t", s.t},
                                        {"closed", s.check.closed},
                                        {"manifold", s.check.manifold},
                                        {"oriented", s.check.oriented},
                                        {"self_intersections", s.check.self_intersections},
                                        {"flat_triangles", s.check.flat_triangles},
                                        {"vertices_ahead", s.ahead}});
    json["transitions"].push_back(std::move(transition));
  }
  return json;
}

void write_transitions(LodPlan& plan, int steps, io::MeshFormat format, const std::filesystem::path& folder) {
  for (std::size_t n = 0; n < plan.transitions.size(); ++n)
    for (int step = 0; step <= steps + 1; ++step) {
      const double t = 1.0 * step / (steps + 1);
      const std::string name = "level" + std::to_string(n + 2) + "_to_level" + std::to_string(n + 1) + "_" +
                               std::to_string(step) + "." + std::string(word_of(format));
      const cloud::FreeShape shape = cloud::free_at_transition(plan.transitions[n], t);
      plan.steps.push_back({n, step, t, shape.check, shape.ahead});
      io::write_mesh(shape.mesh, folder / name, format);
    }
}

}  // namespace dynasurf::report
