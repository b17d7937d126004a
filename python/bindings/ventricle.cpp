#include <filesystem>

#include <pybind11/stl/filesystem.h>

#include "dynasurf/report/report.hpp"
#include "dynasurf/ventricle/detail/border_planes.hpp"
#include "dynasurf/ventricle/detail/closure.hpp"
#include "dynasurf/ventricle/label_borders.hpp"

#include "arrays.hpp"
#include "heart.hpp"
#include "options.hpp"
#include "pickles.hpp"
#include "running.hpp"
#include "stages.hpp"

namespace dynasurf::python {
namespace {

using HeartPtr = std::shared_ptr<Heart>;

void bind_estimates(py::module_& module) {
  py::class_<heart::Estimate>(module, "Estimate", "A number and how sure it is.")
      .def(py::init([](double value, double sd) {
             return heart::Estimate{value, sd};
           }),
           needed("value"), py::arg("sd") = 0.0)
      .def_readonly("value", &heart::Estimate::value)
      .def_readonly("sd", &heart::Estimate::sd, "One standard deviation; 0: not known.")
      .def_property_readonly("low", &heart::Estimate::low, "Lower end of the 90 % interval.")
      .def_property_readonly("high", &heart::Estimate::high, "Upper end of the 90 % interval.")
      .def("__float__", [](const heart::Estimate& e) { return e.value; })
      .def(
          "__eq__",
          [](const heart::Estimate& a, const heart::Estimate& b) { return a.value == b.value && a.sd == b.sd; },
          py::is_operator())
      .def("__repr__",
           [](const heart::Estimate& e) {
             std::array<char, 96> text{};
             if (e.has_interval())
               std::snprintf(text.data(), text.size(), "%.1f (%.1f to %.1f)", e.value, e.low(), e.high());
             else
               std::snprintf(text.data(), text.size(), "%.1f", e.value);
             return std::string(text.data());
           })
      .def(py::pickle([](const heart::Estimate& e) { return py::make_tuple(e.value, e.sd); },
                      [](const py::tuple& state) {
                        return heart::Estimate{py::cast<double>(state[0]), py::cast<double>(state[1])};
                      }));
  py::class_<ventricle::QualityFlag>(module, "QualityFlag", "One reason to distrust a result.")
      .def_readonly("code", &ventricle::QualityFlag::code)
      .def_property_readonly("severity",
                             [](const ventricle::QualityFlag& f) { return std::string(name_of(f.severity)); })
      .def_readonly("message", &ventricle::QualityFlag::message)
      .def_readonly("value", &ventricle::QualityFlag::value)
      .def("__repr__", [](const ventricle::QualityFlag& f) {
        return "<" + std::string(name_of(f.severity)) + " " + f.code + ": " + f.message + ">";
      });
}

/// What every kind of surface shows of its mesh.
template <class S>
auto surface_class(py::module_& module, const char* name, const char* doc) {
  return py::class_<S, std::shared_ptr<S>>(module, name, doc)
      .def_property_readonly(
          "mesh", [](const std::shared_ptr<S>& s) { return held(part_of(s, s->mesh)); }, "TriMesh, world (LPS), mm.")
      .def_property_readonly(
          "vertices", [](const std::shared_ptr<S>& s) { return view_of(s->mesh.vertices, s); },
          "(n, 3) float64, world (LPS), mm: a read-only view.")
      .def_property_readonly(
          "triangles", [](const std::shared_ptr<S>& s) { return view_of(s->mesh.triangles, s); },
          "(m, 3) int32: a read-only view.")
      .def_readonly("volume_ml", &S::volume_ml, "Enclosed volume, mL.");
}

void bind_surfaces(py::module_& module) {
  surface_class<ventricle::LeadingSurface>(module, "LeadingSurface", "A wall in the reading that leads.");
  surface_class<ventricle::Surface>(module, "Surface", "A wall as it was deformed onto the edges.")
      .def_readonly("steps", &ventricle::Surface::steps)
      .def_readonly("step_s", &ventricle::Surface::step_s, "Time step of its motion, s.")
      .def_property_readonly("stop_reason",
                             [](const ventricle::Surface& s) { return std::string(dynamics::name_of(s.stop_reason)); })
      .def_readonly("stopped_fraction", &ventricle::Surface::stopped_fraction)
      .def_readonly("border_reached", &ventricle::Surface::border_reached)
      .def_readonly("mean_distance_mm", &ventricle::Surface::mean_distance_mm)
      .def_readonly("notes", &ventricle::Surface::notes);
}

ventricle::Border border_from(const std::string& wall) {
  if (wall == "endo") return ventricle::Border::endo;
  if (wall == "epi") return ventricle::Border::epi;
  throw OptionError("wall is '" + wall + "'; expected endo or epi");
}

std::shared_ptr<ventricle::Labels> labels_from(const std::shared_ptr<Mask>& borders, double x_px, double y_px,
                                               double radius_px, int big_slice, int division_slice) {
  auto labels = std::make_shared<ventricle::Labels>();
  labels->borders = *borders;
  labels->circle = {x_px, y_px, radius_px};
  labels->axis = {x_px, y_px, 0, 0};
  labels->big_slice = big_slice;
  labels->division_slice = division_slice;
  labels->local.resize(static_cast<std::size_t>(borders->grid.dims[2]));
  return labels;
}

void bind_labels(py::module_& module) {
  using L = ventricle::Labels;
  py::class_<L, std::shared_ptr<L>>(module, "Labels", "Where the two borders lie in one gate, slices apex first.")
      .def(py::init(&labels_from), needed("borders"), needed("x_px"), needed("y_px"), needed("radius_px"),
           py::arg("big_slice") = -1, py::arg("division_slice") = -1)
      .def_property_readonly(
          "borders", [](const std::shared_ptr<L>& l) { return held(part_of(l, l->borders)); },
          "Mask: bit 1 the inner, bit 2 the outer border.")
      .def_property_readonly(
          "circle", [](const L& l) { return py::make_tuple(l.circle.x_px, l.circle.y_px, l.circle.radius_px); },
          "x, y, radius of the automatic circle, px.")
      .def_property_readonly(
          "axis", [](const L& l) { return py::make_tuple(l.axis.x_px, l.axis.y_px, l.axis.dx_px, l.axis.dy_px); },
          "x, y at slice 0 and change per slice, px.")
      .def_readonly("big_slice", &L::big_slice)
      .def_readonly("division_slice", &L::division_slice, "Highest slice under the end of the cavity; -1: none.")
      .def_readonly("notes", &L::notes);
}

void bind_gate(py::module_& module) {
  using G = ventricle::Gate;
  py::class_<G, std::shared_ptr<G>>(module, "Gate", "One instant of the beat.")
      .def_readonly("gate", &G::gate, "From 0.")
      .def_readonly("time_ms", &G::time_ms, "After the R wave; None: not known.")
      .def_property_readonly(
          "endo", [](const std::shared_ptr<G>& g) { return held(part_of_optional(g, g->surfaces.endo)); },
          "The inner wall in the reading that leads; None: not found.")
      .def_property_readonly(
          "epi", [](const std::shared_ptr<G>& g) { return held(part_of_optional(g, g->surfaces.epi)); },
          "The outer wall.")
      .def_property_readonly(
          "edge_endo", [](const std::shared_ptr<G>& g) { return held(part_of_optional(g, g->edge_surfaces.endo)); },
          "The inner wall as it was deformed onto the edges.")
      .def_property_readonly(
          "edge_epi", [](const std::shared_ptr<G>& g) { return held(part_of_optional(g, g->edge_surfaces.epi)); },
          "The outer wall as it was deformed onto the edges.")
      .def_property_readonly(
          "labels", [](const std::shared_ptr<G>& g) { return held(part_of(g, g->labels)); }, "The labelled borders.")
      .def_property_readonly(
          "edges", [](const std::shared_ptr<G>& g) { return held(part_of(g, g->edges)); }, "Mask of all edges.")
      .def_readonly("base_slice", &G::base_slice, "Highest slice of the ventricle; -1: not known.");
}

std::string results_text(const Heart& heart, bool timings) {
  report::VentricleRecord record;
  record.mask_sha256 = heart.mask_sha256;
  record.start_mesh_sha256 = heart.start_sha256;
  record.timings = timings ? report::Timings::keep : report::Timings::omit;
  return report::ventricle_results_text(heart.result, heart.provenance, record);
}

void bind_result_numbers(py::class_<Heart, HeartPtr>& heart) {
  const auto leading = [&](const char* name, std::optional<heart::Estimate> ventricle::Reading::*number,
                           const char* doc) {
    heart.def_property_readonly(
        name, [number](const Heart& h) { return h.result.leading.*number; }, doc);
  };
  leading("edv", &ventricle::Reading::edv_ml, "End-diastolic volume, mL; None: not gated or a surface is missing.");
  leading("esv", &ventricle::Reading::esv_ml, "End-systolic volume, mL.");
  leading("sv", &ventricle::Reading::sv_ml, "Stroke volume, mL.");
  leading("ef", &ventricle::Reading::ef_percent, "Ejection fraction, %.");
  leading("wall", &ventricle::Reading::wall_ml, "Volume of the muscle, mean of the gates, mL.");
  heart
      .def_property_readonly(
          "reading", [](const Heart& h) { return std::string(word_of(h.result.leading.kind)); },
          "Which reading leads: psf_corrected or edge.")
      .def_property_readonly(
          "ed_gate", [](const Heart& h) { return h.result.leading.ed_gate; }, "From 0.")
      .def_property_readonly(
          "es_gate", [](const Heart& h) { return h.result.leading.es_gate; }, "From 0.")
      .def_property_readonly(
          "verdict", [](const Heart& h) { return std::string(word_of(h.result.verdict)); }, "ok, check or fail.")
      .def_property_readonly(
          "flags", [](const Heart& h) { return h.result.flags; }, "Every reason to distrust the result.")
      .def_property_readonly(
          "notes", [](const Heart& h) { return h.result.notes; }, "What was remarked.")
      .def_property_readonly(
          "seconds",
          [](const Heart& h) {
            py::dict seconds;
            for (const auto& [stage, s] : h.result.seconds) seconds[py::str(stage)] = s;
            return seconds;
          },
          "Per stage, summed over gates.");
}

void bind_heart_result(py::module_& module) {
  py::class_<Heart, HeartPtr> heart(module, "VentricleResult", "Both walls of the ventricle in every gate.",
                                    py::dynamic_attr());
  bind_result_numbers(heart);
  heart.def(by_pickle<Heart>())
      .def_property_readonly(
          "gates",
          [](const HeartPtr& h) {
            py::list gates;
            for (const ventricle::Gate& gate : h->result.gates) gates.append(held(part_of(h, gate)));
            return gates;
          },
          "One Gate per gate.")
      .def_property_readonly(
          "study",
          [](const HeartPtr& h) {
            const py::gil_scoped_release release;
            return std::make_shared<OriginStudy>(h->result.study);
          },
          "The canonical study: slices apex first, values normalised; a copy.")
      .def_property_readonly(
          "command", [](const Heart& h) { return h.provenance.command; },
          "The command line that gives the same result.")
      .def("_options_text", [](const Heart& h) { return h.provenance.options_json; })
      .def_property_readonly(
          "measures", [](const HeartPtr& h) { return held(part_of_optional(h, h->result.measures)); },
          "What was measured on the walls; None: no surface.")
      .def("results_text", &results_text, py::arg("timings") = true, py::call_guard<py::gil_scoped_release>())
      .def(
          "report_html",
          [](const Heart& h, std::size_t most_voxels) {
            return report::report_html(h.result, h.provenance, report::Timings::omit, most_voxels);
          },
          py::arg("most_voxels") = 48'000'000, py::call_guard<py::gil_scoped_release>())
      .def(
          "_save",
          [](const Heart& h, const std::filesystem::path& folder, const std::vector<std::string>& mesh_formats,
             bool timings, bool replace, const std::string& labels, bool partial_volumes) {
            save_heart(h, folder, {mesh_formats, timings, replace, {labels, partial_volumes}});
          },
          needed("folder"), needed("mesh_formats"), needed("timings"), needed("replace"), needed("labels"),
          needed("partial_volumes"), py::call_guard<py::gil_scoped_release>());
}

/// What a function of Python gave, which must be of this class.
template <class T>
T given(const py::object& object, const std::string& function, const char* expected) {
  if (!py::isinstance<T>(object))
    throw OptionError(function + " gave " + py::cast<std::string>(py::repr(object)) + "; expected " + expected);
  return *py::cast<std::shared_ptr<T>>(object);
}

/// Functions of Python in the place of stages.
ventricle::OwnStages own_stages(const py::object& edges, const std::string& edges_name, const py::object& labels,
                                const std::string& labels_name) {
  ventricle::OwnStages own;
  if (!edges.is_none()) {
    own.edges_name = edges_name;
    own.edges = [called = shared_function(edges), name = edges_name](const Image& image) {
      const py::gil_scoped_acquire acquire;
      return given<image::EdgeMap>((*called)(std::make_shared<Image>(image)), name, "an EdgeMap or a Mask");
    };
  }
  if (!labels.is_none()) {
    own.labels_name = labels_name;
    own.labels = [called = shared_function(labels), name = labels_name](const Image& image,
                                                                        const image::EdgeMap& found) {
      const py::gil_scoped_acquire acquire;
      return given<ventricle::Labels>(
          (*called)(std::make_shared<Image>(image), std::make_shared<image::EdgeMap>(found)), name, "Labels");
    };
  }
  return own;
}

HeartPtr reconstruct_from_python(const std::shared_ptr<OriginStudy>& study, const std::string& options,
                                 const std::string& preset, const std::shared_ptr<Image>& mask,
                                 const std::optional<std::string>& mask_sha256, const std::shared_ptr<TriMesh>& start,
                                 const std::optional<std::string>& start_sha256, const py::object& edges,
                                 const std::string& edges_name, const py::object& labels,
                                 const std::string& labels_name, const std::shared_ptr<StageCache>& cache,
                                 py::object progress, int threads) {
  HeartRun run{study,       preset,       options_from<ventricle::Options>(options),          mask, start,
               mask_sha256, start_sha256, own_stages(edges, edges_name, labels, labels_name), cache};
  return run_long_for({std::move(progress), threads},
                      [run = std::move(run)](const Progress& told) { return reconstruct_heart(run, told); });
}

void bind_stages(py::module_& module) {
  using release_lock = py::call_guard<py::gil_scoped_release>;
  module.def(
      "label_borders",
      [](const std::shared_ptr<Image>& image, const std::shared_ptr<image::EdgeMap>& edges,
         const std::string& options) {
        const auto how = options_from<ventricle::Labelling>(options);
        const py::gil_scoped_release release;
        return std::make_shared<ventricle::Labels>(ventricle::label_borders(*image, *edges, how));
      },
      needed("image"), needed("edges"), needed("options"));
  module.def(
      "border_volume",
      [](const std::shared_ptr<ventricle::Labels>& labels, const std::string& wall) {
        return std::make_shared<Image>(ventricle::border_volume(*labels, border_from(wall)));
      },
      needed("labels"), needed("wall"), release_lock());
  module.def(
      "close_border",
      [](const std::shared_ptr<Image>& border, int base_slice) {
        return std::make_shared<Image>(ventricle::close_border(*border, base_slice));
      },
      needed("border"), needed("base_slice"), release_lock());
  module.def(
      "with_room",
      [](const std::shared_ptr<Image>& border, int voxels) {
        return std::make_shared<Image>(ventricle::with_room(*border, voxels));
      },
      needed("border"), py::arg("voxels") = 3, release_lock());
  module.def(
      "border_planes",
      [](const std::shared_ptr<Image>& border, const std::string& wall,
         const std::shared_ptr<ventricle::Labels>& labels, const std::shared_ptr<image::EdgeMap>& edges,
         int base_slice) {
        return std::make_shared<dynamics::BorderPlanes>(
            ventricle::border_planes(*border, border_from(wall), *labels, *edges, base_slice));
      },
      needed("border"), needed("wall"), needed("labels"), needed("edges"), needed("base_slice"), release_lock());
  module.def(
      "find_base_slice",
      [](const std::shared_ptr<Image>& image, const std::shared_ptr<ventricle::Labels>& labels, double base_level) {
        Notes notes;
        return ventricle::find_base_slice(*image, *labels, base_level, notes);
      },
      needed("image"), needed("labels"), py::arg("base_level") = 0.5, release_lock());
  module.def(
      "settle_on_slope",
      [](const std::shared_ptr<TriMesh>& mesh, const std::shared_ptr<Image>& image, const Numbers<double>& base,
         const std::string& options) {
        const auto how = options_from<ventricle::Settle>(options);
        const Vec3 direction = vector_from(base, "base");
        const py::gil_scoped_release release;
        return std::make_shared<TriMesh>(ventricle::settle_on_slope(*mesh, *image, direction, how));
      },
      needed("mesh"), needed("image"), needed("base"), needed("options"));
}

}  // namespace

void bind_ventricle(py::module_& module) {
  py::class_<StageCache, std::shared_ptr<StageCache>>(module, "StageCache",
                                                      "What the stages of the last run found, for the next run.")
      .def(py::init<>());
  bind_estimates(module);
  bind_surfaces(module);
  bind_walls(module);
  bind_labels(module);
  bind_gate(module);
  bind_heart_result(module);
  bind_stages(module);
  module.def("reconstruct_ventricle", &reconstruct_from_python, needed("study"), needed("options"), needed("preset"),
             py::arg("mask"), py::arg("mask_sha256"), py::arg("start"), py::arg("start_sha256"), py::arg("edges"),
             needed("edges_name"), py::arg("labels"), needed("labels_name"), py::arg("cache"), py::arg("progress"),
             needed("threads"));
}

}  // namespace dynasurf::python
