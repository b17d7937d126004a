// The models of the thesis as options.
#include "dynasurf/dynamics/options.hpp"

namespace dynasurf::dynamics {
namespace {

/// Internal forces keep the mesh in order while it moves; smoothing would fight them.
Evolution coupled(ModelOptions model) {
  Evolution o;
  o.model = model;
  o.smooth_every = 0;
  return o;
}

}  // namespace

Evolution free_model() { return {}; }
Evolution spring_model() { return coupled(SpringModel{}); }
Evolution restricted_spring_model() { return coupled(RestrictedSpringModel{}); }
Evolution plain_model() { return coupled(PlainModel{}); }
Evolution curvature_model() { return coupled(CurvatureModel{}); }

}  // namespace dynasurf::dynamics
