#include "dynasurf/psf_fit/detail/edge_volumes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/heart/lv_volumes.hpp"

namespace dynasurf::psf_fit {
namespace {

// Learned from experiments/camera: seeds 1 to 40, and 1 to 16 with attenuation alone corrected; below 14 mm from images
// without a camera, seeds 101 to 205. From 15.1 to 16.1 mm the width tells reconstructions that recovered the
// resolution from those that did not.
constexpr std::array<std::pair<double, double>, 7> log_ratio_by_fwhm_mm{
    {{9.5, -0.16}, {12, -0.225}, {14, -0.315}, {15.1, -0.33}, {16.1, -0.415}, {17.5, -0.43}, {20, -0.5}}};
constexpr double log_ratio_filtered = -0.53;

double usual_log_ratio(double fwhm_mm) {
  const auto& table = log_ratio_by_fwhm_mm;
  if (fwhm_mm <= table.front().first) return table.front().second;
  for (std::size_t n = 1; n < table.size(); ++n) {
    const auto [from, narrower] = table[n - 1];
    const auto [to, wider] = table[n];
    if (fwhm_mm <= to) return narrower + (wider - narrower) * (fwhm_mm - from) / (to - from);
  }
  return table.back().second;
}

}  // namespace

EdgeBelief edge_belief(double fwhm_mm, Attenuation attenuation, bool is_filtered) {
  if (is_filtered) return {log_ratio_filtered, 1.3, 0.22, 0.24};
  return {usual_log_ratio(fwhm_mm), attenuation == Attenuation::corrected ? -3.6 : -1.5, 0.5, 0.24};
}

std::vector<double> towards_edges(std::span<const double> fitted_ml, std::span<const double> edge_ml,
                                  const EdgeBelief& belief) {
  std::vector<double> moved(fitted_ml.begin(), fitted_ml.end());
  const auto fitted = heart::lv_volumes(fitted_ml), edge = heart::lv_volumes(edge_ml);
  if (!fitted || !edge || !(fitted->ef_percent && edge->ef_percent)) return moved;
  // Farther off edges were led astray by something else.
  constexpr double farthest = 0.3, most_of_ef = 0.3;
  const double log_ratio = own::log(edge->edv_ml / fitted->edv_ml) - belief.log_ratio;
  const double edv_ml = fitted->edv_ml * own::exp(belief.of_volume * std::clamp(log_ratio, -farthest, farthest));
  const double ef = std::max(*fitted->ef_percent, 1e-6);
  const double deeper = belief.of_ef * (*edge->ef_percent - ef - belief.ef_points) / ef;
  const double depth = 1 + std::clamp(deeper, -most_of_ef, most_of_ef);
  for (double& ml : moved) ml = edv_ml * (1 - depth * (1 - ml / fitted->edv_ml));
  return moved;
}

}  // namespace dynasurf::psf_fit
