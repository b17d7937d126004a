#include <algorithm>
#include <array>

#include "dynasurf/image/edges.hpp"

#include "arrays.hpp"
#include "options.hpp"
#include "running.hpp"
#include "stages.hpp"

namespace dynasurf::python {
namespace {

std::shared_ptr<image::EdgeMap> detect(const std::shared_ptr<Image>& image, const std::string& options,
                                       const RunArguments& run) {
  const auto method = family_from<image::EdgeOptions>(options);
  return run_long_for(run, [image, method](const Progress&) {
    return std::make_shared<image::EdgeMap>(image::detect_edges(*image, method));
  });
}

}  // namespace

std::shared_ptr<image::EdgeMap> edges_from(const std::shared_ptr<Mask>& edges, const std::shared_ptr<Image>& gradient) {
  auto map = std::make_shared<image::EdgeMap>();
  map->edges = *edges;
  map->gradient = gradient ? *gradient : Image(edges->grid);
  if (map->gradient.grid.dims != edges->grid.dims)
    throw OptionError("gradient lies on another grid than edges; expected the same");
  return map;
}

void bind_image(py::module_& module) {
  using E = image::EdgeMap;
  py::class_<E, std::shared_ptr<E>>(module, "EdgeMap", "Edges of every slice.")
      .def(py::init(&edges_from), needed("edges"), py::arg("gradient") = std::shared_ptr<Image>())
      .def_property_readonly(
          "edges", [](const std::shared_ptr<E>& e) { return held(part_of(e, e->edges)); },
          "Mask: 0 none, 1 minor, 2 major.")
      .def_property_readonly(
          "gradient", [](const std::shared_ptr<E>& e) { return held(part_of(e, e->gradient)); },
          "Image: the strength that the thresholds were applied to.")
      .def_readonly("notes", &E::notes, "What was remarked.");
  module.def(
      "detect_edges",
      [](const std::shared_ptr<Image>& image, const std::string& options, py::object progress, int threads) {
        return detect(image, options, {std::move(progress), threads});
      },
      needed("image"), needed("options"), py::arg("progress") = py::none(), py::arg("threads") = 0);
}

}  // namespace dynasurf::python
