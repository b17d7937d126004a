#pragma once
#include <memory>

#include "dynasurf/core/volume.hpp"
#include "dynasurf/image/edges.hpp"

namespace dynasurf::python {

/// Edges that Python found. Throws OptionError when the gradient, which may be null, lies on another grid.
std::shared_ptr<image::EdgeMap> edges_from(const std::shared_ptr<Mask>& edges, const std::shared_ptr<Image>& gradient);

}  // namespace dynasurf::python
