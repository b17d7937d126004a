#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::report {

/// A level of detail as a result or a file calls it.
struct NamedLevel {
  std::string name;
  TriMesh mesh;
};

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
  std::vector<cloud::StartDistance> distances;    // of each from the coarser level
  std::vector<TransitionStep> steps;              // of the meshes that were written
};

/// `from`: distances that the user sets, one for each level, in place of those by the size on the screen; may be empty.
LodPlan plan_of(const std::vector<TriMesh>& meshes, const cloud::LodRule& rule, const cloud::Camera& camera,
                const std::vector<double>& from = {});

/// The content of lod.json, but for the program.
nlohmann::ordered_json json_of(const std::vector<NamedLevel>& levels, const LodPlan& plan, const cloud::LodRule& rule,
                               const cloud::Camera& camera);

/// Writes the meshes between the levels, `steps` of them and both ends of each transition, and says in the plan what
/// they are. t runs over (0, 1) in equal steps; its ends are the levels themselves.
void write_transitions(LodPlan& plan, int steps, io::MeshFormat format, const std::filesystem::path& folder);

}  // namespace dynasurf::report
