#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf {

/// What is known of a synthetic gate: the surfaces that were filled, closed at the base, in the world frame.
struct TrueGate {
  TriMesh endo, epi;               // fine closed meshes; may be empty where a phantom has none
  double endo_ml = 0, epi_ml = 0;  // analytic volumes where there is a formula, else of the meshes
};

/// A study together with its truth.
struct Phantom {
  Study study;
  std::string kind;
  std::vector<TrueGate> truth;  // one per gate
  std::optional<double> edv_ml, esv_ml, ef_percent;
  Notes notes;
};

}  // namespace dynasurf
