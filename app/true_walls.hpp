#pragma once
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"

namespace dynasurf {

/// The true walls of a virtual patient, measured as a reconstruction's are: the same segments, the same definitions.
/// What is read from counts is that of its image. The phantom must outlive the call only.
inline ventricle::Measures measure_true_walls(const synthetic::Phantom& phantom,
                                              const ventricle::MeasureOptions& options = {}) {
  ventricle::MeasureInput input;
  input.axis = phantom.axis.value_or(phantom.study.grid().direction.col(2));
  input.cycle_ms = phantom.study.cycle_ms;
  input.from_edges = false;
  for (std::size_t g = 0; g < phantom.truth.size(); ++g) {
    const synthetic::TrueGate& gate = phantom.truth[g];
    const bool knows = !gate.endo_uptake.empty();
    input.gates.push_back({{&gate.endo, knows ? &gate.endo_uptake : nullptr},
                           {&gate.epi, knows ? &gate.epi_uptake : nullptr},
                           &phantom.study.gates[g],
                           std::nullopt});
  }
  return ventricle::measure_walls(input, options);
}

}  // namespace dynasurf
