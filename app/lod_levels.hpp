#pragma once
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/cloud/lod.hpp"

// What `dynasurf lod` works on.
namespace dynasurf::app {

struct NamedLevel {
  std::string name;
  TriMesh mesh;
};

/// The meshes of a result folder of `cloud`, or of files, finest first. `with_names`: files keep their names, else they
/// are level1, level2, ... Throws InputError, IoError.
std::vector<NamedLevel> levels_of(const std::vector<std::string>& paths, bool with_names);

/// What a written mesh between two levels is.
struct TransitionStep {
  std::size_t transition = 0;
  int step = 0;
  double t = 0;
  mesh::SurfaceCheck check;
  std::size_t ahead = 0;  // see cloud::FreeShape
};

struct LodPlan {
  cloud::LodChain chain;
  std::vector<double> from;                       // distance from which each level serves
  std::vector<cloud::LodTransition> transitions;  // level n out of level n + 1
  std::vector<TransitionStep> steps;              // of the meshes that were written
};

/// `from`: distances that the user sets, one for each level, in place of those by the size on the screen; may be empty.
LodPlan plan_of(const std::vector<TriMesh>& meshes, const cloud::LodRule& rule, const cloud::Camera& camera,
                const std::vector<double>& from = {});

/// The content of lod.json.
nlohmann::ordered_json json_of(const std::vector<NamedLevel>& levels, const LodPlan& plan, const cloud::LodRule& rule,
                               const cloud::Camera& camera);

}  // namespace dynasurf::app
