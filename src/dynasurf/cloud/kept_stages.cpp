#include "dynasurf/cloud/detail/kept_stages.hpp"

namespace dynasurf::cloud {
namespace {

constexpr FirstTouched<Stage> first_touched[]{
    {"genus", Stage::body},
    {"boundary", Stage::body},
    {"lid", Stage::body},
    {"cells", Stage::body},
    {"use_normals", Stage::body},
    {"smallest_part_percent", Stage::body},
    // How many cells the triangles ask for is told apart.
    {"triangles", Stage::levels},
    {"method", Stage::levels},
    {"max_error_percent", Stage::levels},
    {"start", Stage::levels},
    {"keep_sharp", Stage::levels},
};

}  // namespace

std::string options_up_to(Stage stage, const Options& options) {
  return dynasurf::options_up_to<Stage>(stage, first_touched, options);
}

void KeptStages::begin(const PointCloud& of) {
  if (cloud == of) return;
  *this = {};
  cloud = of;
}

}  // namespace dynasurf::cloud
