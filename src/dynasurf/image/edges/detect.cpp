#include "dynasurf/image/edges.hpp"

namespace dynasurf::image {

EdgeMap detect_edges(const Image& image, const EdgeOptions& options) {
  return std::visit([&](const auto& method) { return detect_edges(image, method); }, options);
}

}  // namespace dynasurf::image
