#include "kept_stages.hpp"

namespace dynasurf::app {

ventricle::StageCache* kept_stages(const Study&) { return nullptr; }
cloud::StageCache* kept_stages(const PointCloud&) { return nullptr; }

}  // namespace dynasurf::app
