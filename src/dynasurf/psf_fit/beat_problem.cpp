#include "dynasurf/psf_fit/detail/beat_problem.hpp"

#include "dynasurf/core/detail/elementary.hpp"

namespace dynasurf::psf_fit {

Vec3 point_spread(const BeatProblem& problem, const Eigen::VectorXd& gate) {
  const Vec3 logs = log_widths * gate.segment<3>(problem.layout.gate.width);
  return problem.sigma_mm * Vec3(own::exp(logs[0]), own::exp(logs[1]), own::exp(logs[2]));
}

}  // namespace dynasurf::psf_fit
