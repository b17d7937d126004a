#pragma once
#include <optional>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::report_detail {

/// The surfaces of one gate that lead: those of the fit through the blur where there is one, else those of the edges.
struct GateWalls {
  const TriMesh *endo = nullptr, *epi = nullptr;
  std::optional<double> endo_ml, epi_ml;
};

inline GateWalls leading_walls(const VentricleResult& result, std::size_t gate) {
  if (result.fit && gate < result.fit->gates.size()) {
    const FittedGate& fitted = result.fit->gates[gate];
    return {&fitted.endo, &fitted.epi, fitted.endo_ml.value, fitted.epi_ml.value};
  }
  const Gate& edges = result.gates[gate];
  GateWalls walls;
  if (edges.endo) walls.endo = &edges.endo->mesh, walls.endo_ml = edges.endo->volume_ml;
  if (edges.epi) walls.epi = &edges.epi->mesh, walls.epi_ml = edges.epi->volume_ml;
  return walls;
}

}  // namespace dynasurf::report_detail
