#pragma once
// The study of missing data: its phantoms and what is measured of them. Tests ask it too.
#include <optional>
#include <string_view>

#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

namespace dynasurf::experiments::missing_data {

constexpr double fractions[] = {0, 0.10, 0.32, 0.53};
constexpr double published_percent[] = {100, 94.5, 70.9, 60.2};  // table 6.14

inline ventricle::Result reconstruct_partial(double fraction, synthetic::Missing missing, std::string_view preset) {
  synthetic::Partial partial;
  partial.fraction = fraction;
  partial.missing = missing;
  const synthetic::Phantom phantom = synthetic::make_phantom(partial);
  return ventricle::reconstruct(phantom.study, ventricle::preset(preset));
}

inline std::optional<double> outer_ml(const ventricle::Result& result) {
  if (result.readings.psf_corrected) return result.readings.psf_corrected->gates.front().epi_ml.value;
  const auto& epi = result.gates.front().edge_surfaces.epi;
  return epi ? std::optional(epi->volume_ml) : std::nullopt;
}

}  // namespace dynasurf::experiments::missing_data
