#include <algorithm>
#include <limits>

#include "dynasurf/psf_fit/blur_fit.hpp"
#include "dynasurf/report/measures.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"

#include "arrays.hpp"
#include "options.hpp"
#include "origin.hpp"
#include "running.hpp"

namespace dynasurf::python {
namespace {

using Meshes = std::vector<std::shared_ptr<TriMesh>>;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

py::array array_of(const ventricle::PolarValues& values, const ventricle::PolarGrid& grid) {
  if (values.empty()) return py::array_t<double>(0);
  py::array_t<double> array({grid.rings, grid.sectors});
  std::transform(values.begin(), values.end(), array.mutable_data(),
                 [](const std::optional<double>& v) { return v.value_or(nan); });
  return array;
}

/// Rows of the table of segments, in the order of `segment_columns` of the Python package.
py::list segment_rows(const ventricle::Measures& measures) {
  py::list rows;
  for (const ventricle::SegmentMeasures& s : measures.segments) {
    const auto number = [](const std::optional<double>& v) { return v.value_or(nan); };
    rows.append(py::make_tuple(
        s.segment.number, std::string(s.segment.name), std::string(s.segment.territory), s.wall_share_percent,
        number(s.perfusion_percent), number(s.thickness_ed_mm), number(s.thickness_es_mm), number(s.thickening_percent),
        number(s.count_thickening_percent), number(s.motion_mm), number(s.displacement_mm),
        number(s.area_strain_percent), number(s.phase_counts_deg), number(s.phase_motion_deg),
        number(s.phase_thickness_deg), number(s.sd.perfusion_percent), number(s.sd.thickness_ed_mm),
        number(s.sd.thickness_es_mm), number(s.sd.thickening_percent), number(s.sd.motion_mm),
        number(s.sd.displacement_mm), number(s.sd.area_strain_percent), number(s.sd.phase_motion_deg),
        number(s.sd.phase_thickness_deg)));
  }
  return rows;
}

py::dict polar_maps(const ventricle::Measures& measures) {
  py::dict maps;
  for (const report::PolarKind& kind : report::polar_kinds())
    if (const ventricle::PolarValues& values = measures.maps.*kind.values; !values.empty())
      maps[py::str(std::string(kind.name))] = array_of(values, measures.grid);
  return maps;
}

/// (phase, volume in mL, rate in EDV per beat) of the periodic fit; None where there is no curve.
py::object curve_of(const ventricle::Measures& measures, int instants) {
  if (!measures.function) return py::none();
  if (instants < 1) throw OptionError("instants is " + std::to_string(instants) + "; expected 1 or more");
  const ventricle::VolumeCurveFit& fit = *measures.function;
  py::array_t<double> table({3, instants});
  for (int n = 0; n < instants; ++n) {
    const double phase = static_cast<double>(n) / instants;
    table.mutable_at(0, n) = phase;
    table.mutable_at(1, n) = fit.curve.at(phase);
    table.mutable_at(2, n) = fit.edv_ml > 0 ? fit.curve.slope(phase) / fit.edv_ml : nan;
  }
  return table;
}

void bind_measures(py::module_& module) {
  using M = ventricle::Measures;
  py::class_<M, std::shared_ptr<M>>(module, "Measures", "Every number a reader expects, from the walls of each gate.")
      .def("_segment_rows", &segment_rows)
      .def_property_readonly("polar", &polar_maps, "Polar maps by name, (rings, sectors) float64, NaN: no value.")
      .def("curve", &curve_of, py::arg("instants") = 64)
      .def_readonly("muscle_ml", &M::muscle_ml, "Mean over the gates; None: not known.")
      .def_readonly("muscle_g", &M::muscle_g)
      .def_readonly("ed_gate", &M::ed_gate, "From 0; -1: none.")
      .def_readonly("es_gate", &M::es_gate, "From 0; -1: none.")
      .def_readonly("from_edges", &M::from_edges, "Thickness is apparent: the surfaces are edges of a blurred image.")
      .def_property_readonly(
          "volumes_ml",
          [](const M& m) {
            std::vector<std::pair<double, double>> volumes;
            for (const ventricle::GateMeasures& gate : m.gates) volumes.emplace_back(gate.endo_ml, gate.epi_ml);
            return volumes;
          },
          "(inner, outer) per gate, mL.");
}

void bind_fit(py::module_& module) {
  using F = psf_fit::FittedGate;
  py::class_<F, std::shared_ptr<F>>(module, "FittedGate", "One gate as fitted through the blur; world (LPS), mm.")
      .def_property_readonly("endo", [](const std::shared_ptr<F>& g) { return held(part_of(g, g->endo)); })
      .def_property_readonly("epi", [](const std::shared_ptr<F>& g) { return held(part_of(g, g->epi)); })
      .def_readonly("endo_ml", &F::endo_ml)
      .def_readonly("epi_ml", &F::epi_ml);
  using B = psf_fit::FittedBeat;
  py::class_<B, std::shared_ptr<B>>(module, "FittedBeat", "The walls of all gates, fitted together.")
      .def_property_readonly("gates",
                             [](const std::shared_ptr<B>& b) {
                               py::list gates;
                               for (const psf_fit::FittedGate& gate : b->gates) gates.append(held(part_of(b, gate)));
                               return gates;
                             })
      .def_readonly("edv", &B::edv_ml)
      .def_readonly("esv", &B::esv_ml)
      .def_readonly("sv", &B::sv_ml)
      .def_readonly("ef", &B::ef_percent)
      .def_readonly("wall", &B::wall_ml)
      .def_readonly("thickness_mm", &B::thickness_mm)
      .def_readonly("fwhm_mm", &B::fwhm_mm)
      .def_readonly("steps", &B::steps)
      .def_readonly("converged", &B::converged)
      .def_property_readonly(
          "uptake", [](const std::shared_ptr<B>& b) { return view_of_values(b->uptake, b); },
          "Per vertex of either wall, its median is 1; 0 on the lid.")
      .def_readonly("notes", &B::notes);
}

std::shared_ptr<psf_fit::FittedBeat> fit(const std::shared_ptr<OriginStudy>& study, const Meshes& endo,
                                         const Meshes& epi, const Numbers<double>& axis, const Numbers<double>& lateral,
                                         const std::string& options, py::object progress, int threads) {
  const std::size_t gates = study->gates.size();
  if (endo.size() != gates || epi.size() != gates)
    throw OptionError("fit: " + std::to_string(endo.size()) + " inner and " + std::to_string(epi.size()) +
                      " outer walls; expected one of each for the " + std::to_string(gates) + " gates");
  psf_fit::FitStart start;
  for (std::size_t g = 0; g < gates; ++g) {
    if (!endo[g] || !epi[g] || endo[g]->triangles.empty() || epi[g]->triangles.empty())
      throw OptionError("fit: gate " + std::to_string(g) + " has not both walls");
    start.endo.push_back(*endo[g]);
    start.epi.push_back(*epi[g]);
  }
  start.base.resize(gates);
  start.axis = vector_from(axis, "axis");
  start.lateral = vector_from(lateral, "lateral");
  if (!(start.axis.cross(start.lateral).norm() > 1e-6)) throw OptionError("axis and lateral lie along one line");
  const auto how = options_from<psf_fit::BlurFit>(options);
  return run_long_for({std::move(progress), threads}, [=](const Progress& told) {
    return std::make_shared<psf_fit::FittedBeat>(psf_fit::fit_through_blur(*study, start, how, told));
  });
}

std::shared_ptr<ventricle::Measures> measure(const std::shared_ptr<OriginStudy>& study, const Meshes& endo,
                                             const Meshes& epi, const Numbers<double>& axis, bool from_edges,
                                             const std::string& options) {
  if (endo.size() != study->gates.size() || epi.size() != study->gates.size())
    throw OptionError("measure: expected one inner and one outer wall, or None, for each of the " +
                      std::to_string(study->gates.size()) + " gates");
  ventricle::MeasureInput input;
  for (std::size_t g = 0; g < study->gates.size(); ++g)
    input.gates.push_back({{endo[g].get(), nullptr}, {epi[g].get(), nullptr}, &study->gates[g], {}});
  input.axis = vector_from(axis, "axis");
  if (!(input.axis.norm() > 0)) throw OptionError("axis has no length");
  input.axis.normalize();
  input.cycle_ms = study->cycle_ms;
  input.from_edges = from_edges;
  const auto how = options_from<ventricle::MeasureOptions>(options);
  const py::gil_scoped_release release;
  return std::make_shared<ventricle::Measures>(ventricle::measure_walls(input, how));
}

}  // namespace

void bind_walls(py::module_& module) {
  bind_measures(module);
  bind_fit(module);
  module.def("fit_through_blur", &fit, needed("study"), needed("endo"), needed("epi"), needed("axis"),
             needed("lateral"), needed("options"), py::arg("progress") = py::none(), py::arg("threads") = 0);
  module.def("measure_walls", &measure, needed("study"), needed("endo"), needed("epi"), needed("axis"),
             needed("from_edges"), needed("options"));
}

}  // namespace dynasurf::python
