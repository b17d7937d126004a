#include <filesystem>

#include <pybind11/stl/filesystem.h>
#include <sys/resource.h>

#include "dynasurf/cloud/reconstruct_cloud.hpp"
#include "dynasurf/core/detail/stage_clock.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/report/detail/run_record.hpp"
#include "dynasurf/report/result_folders.hpp"

#include "arrays.hpp"
#include "clouds.hpp"
#include "command_line.hpp"
#include "heart.hpp"
#include "options.hpp"
#include "pickles.hpp"
#include "running.hpp"
#include "stage_cache.hpp"
#include "version.hpp"

namespace dynasurf::python {
namespace {

using Colours = std::vector<std::array<std::uint8_t, 3>>;

using LodsPtr = std::shared_ptr<Lods>;
using CloudPtr = std::shared_ptr<OriginCloud>;

CloudPtr cloud_from(const Numbers<double>& points, const py::object& normals, const py::object& colours,
                    const py::object& scans, const py::object& scanners) {
  auto cloud = std::make_shared<OriginCloud>();
  cloud->cloud.points = points_from(points, "points");
  const std::size_t count = cloud->cloud.points.size();
  const auto require_one_each = [&](std::size_t rows, const char* what) {
    if (rows != count)
      throw OptionError(std::string(what) + " have " + std::to_string(rows) + " rows; expected one for each of the " +
                        std::to_string(count) + " points");
  };
  if (!normals.is_none()) {
    cloud->cloud.normals = points_from(py::cast<Numbers<double>>(normals), "normals");
    require_one_each(cloud->cloud.normals.size(), "normals");
  }
  if (!colours.is_none()) {
    const auto rows = py::cast<Numbers<std::uint8_t>>(colours);
    if (rows.ndim() != 2 || rows.shape(1) != 3)
      throw OptionError("colours have the shape " + shape_text(rows) + "; expected (n, 3) of 0 to 255");
    require_one_each(static_cast<std::size_t>(rows.shape(0)), "colours");
    const auto* first = reinterpret_cast<const std::array<std::uint8_t, 3>*>(rows.data());
    cloud->cloud.colours.assign(first, first + count);
  }
  if (!scans.is_none()) {
    const auto numbers = py::cast<Numbers<std::int64_t>>(scans);
    if (numbers.ndim() != 1) throw OptionError("scans have the shape " + shape_text(numbers) + "; expected (n,)");
    require_one_each(static_cast<std::size_t>(numbers.size()), "scans");
    for (std::size_t i = 0; i < count; ++i) {
      const std::int64_t number = numbers.data()[i];
      if (number < 0 || number > 0x7fffffff)
        throw OptionError("point " + std::to_string(i) + " has the scan " + std::to_string(number) +
                          "; expected 0 to 2147483647");
      cloud->cloud.scans.push_back(static_cast<std::uint32_t>(number));
    }
  }
  if (!scanners.is_none()) cloud->cloud.scanners = points_from(py::cast<Numbers<double>>(scanners), "scanners");
  cloud->sources = {{"array", count, 0}};
  return cloud;
}

std::string command_of(const OriginCloud& cloud, const cloud::Options& options, const std::string& preset) {
  std::string command = "dynasurf cloud";
  for (std::size_t n = 0; n < std::max<std::size_t>(cloud.sources.size(), 1); ++n) command += " CLOUD";
  command += " --out RESULT --preset " + preset;
  for (const std::string& setting : settings_between(cloud::preset(preset), options)) command += " --set " + setting;
  return command;
}

LodsPtr reconstruct_lods(const OriginCloud& cloud, const cloud::Options& options, const std::string& preset,
                         StageCache* cache, const Progress& progress) {
  cloud::check(options);  // refused before any work is done
  auto lods = std::make_shared<Lods>();
  lods->provenance.program_version = app::version();
  lods->provenance.commit = app::commit();
  lods->provenance.command = command_of(cloud, options, preset);
  lods->provenance.inputs = cloud.inputs;
  lods->provenance.options_json = io::options_to_text(options);
  lods->run.sources = cloud.sources;
  StageClock clock(lods->run.seconds);
  std::unique_lock<std::mutex> alone;
  if (cache != nullptr) alone = std::unique_lock(cache->in_use);
  lods->run.result = cloud::reconstruct(cloud.cloud, options,
                                        {[&](std::string_view stage, int done, int total) {
                                           clock.enter(stage);
                                           progress(stage, done, total);
                                         },
                                         progress.stop},
                                        cache == nullptr ? nullptr : &cache->cloud);
  clock.stop();
  Notes& notes = lods->run.result.notes;
  notes.insert(notes.begin(), cloud.notes.begin(), cloud.notes.end());
  return lods;
}

void save(const Lods& lods, const std::filesystem::path& out, const std::vector<std::string>& mesh_formats,
          bool textures, bool packed, bool timings, bool replace) {
  const report::CloudRecord record{formats_from(mesh_formats), textures, packed,
                                   timings ? report::Timings::keep : report::Timings::omit};
  io::OutputFolder folder(out, replace ? io::Existing::move_aside : io::Existing::replace);
  report::CloudRun run = lods.run;
  StageClock clock(run.seconds);
  clock.enter("write");
  report::write_cloud_files(run, lods.provenance, {record.mesh_formats, textures, packed}, folder.path());
  clock.stop();
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) == 0) run.peak_bytes = static_cast<std::size_t>(usage.ru_maxrss) * 1024;
  io::write_file(folder.path() / "results.json", report::cloud_results_text(run, lods.provenance, record));
  folder.publish();
}

void bind_certificate(py::module_& module) {
  using C = cloud::Certificate;
  py::class_<C>(module, "Certificate", "What a mesh is, without tolerances, and how far it lies from its cloud.")
      .def_property_readonly("watertight", &C::watertight, "May it be published as watertight?")
      .def_readonly("vertices", &C::vertices)
      .def_readonly("triangles", &C::triangles)
      .def_readonly("closed", &C::closed)
      .def_readonly("manifold", &C::manifold)
      .def_readonly("oriented", &C::oriented)
      .def_readonly("outward", &C::outward)
      .def_readonly("self_intersections", &C::self_intersections)
      .def_readonly("flat_triangles", &C::flat_triangles)
      .def_readonly("components", &C::components)
      .def_readonly("genus", &C::genus,
                    "Handles, each boundary loop closed by a disc; None unless manifold and oriented.")
      .def_readonly("boundary_loops", &C::boundary_loops)
      .def_property_readonly("sound_open", &C::sound_open, "May it be published as an open surface?")
      .def_readonly("smallest_angle_deg", &C::smallest_angle_deg)
      .def_readonly("angle_mean_deg", &C::angle_mean_deg)
      .def_readonly("cloud_diagonal", &C::cloud_diagonal, "Of the cloud's bounding box.")
      .def_readonly("cloud_to_mesh_mean", &C::cloud_to_mesh_mean)
      .def_readonly("cloud_to_mesh_largest", &C::cloud_to_mesh_largest)
      .def_readonly("mesh_to_cloud_mean", &C::mesh_to_cloud_mean)
      .def_readonly("mesh_to_cloud_largest", &C::mesh_to_cloud_largest)
      .def_readonly("volume", &C::volume)
      .def_readonly("area", &C::area)
      .def("__repr__", [](const C& c) {
        return "<dynasurf.Certificate: " + std::to_string(c.triangles) + " triangles, " +
               (c.watertight()   ? "watertight>"
                : c.sound_open() ? "open, boundary loops: " + std::to_string(c.boundary_loops) + ">"
                                 : "not watertight>");
      });
  module.def(
      "certify",
      [](const std::shared_ptr<TriMesh>& mesh, const CloudPtr& cloud) { return cloud::certify(*mesh, cloud->cloud); },
      needed("mesh"), needed("cloud"), py::call_guard<py::gil_scoped_release>());
}

void bind_levels(py::module_& module) {
  using L = cloud::Level;
  py::class_<L, std::shared_ptr<L>>(module, "CloudLevel", "One mesh, fitted to the cloud, in the cloud's unit.")
      .def_readonly("certificate", &L::certificate)
      .def_readonly("triangles_asked", &L::triangles_asked)
      .def_property_readonly("mesh", [](const std::shared_ptr<L>& l) { return held(part_of(l, l->mesh)); })
      .def_property_readonly(
          "vertices", [](const std::shared_ptr<L>& l) { return view_of(l->mesh.vertices, l); },
          "(n, 3) float64: a read-only view.")
      .def_property_readonly(
          "triangles", [](const std::shared_ptr<L>& l) { return view_of(l->mesh.triangles, l); },
          "(m, 3) int32: a read-only view.")
      .def_property_readonly(
          "errors", [](const std::shared_ptr<L>& l) { return view_of_values(l->errors, l); },
          "Mean distance of the points nearest to each vertex, float32; -1: none.")
      .def_property_readonly(
          "colours",
          [](const std::shared_ptr<L>& l) {
            return view_of(reinterpret_cast<const std::uint8_t*>(l->colours.data()),
                           {static_cast<py::ssize_t>(l->colours.size()), 3}, l);
          },
          "sRGB at the vertices, (n, 3) uint8; empty when the cloud has none.");
}

void bind_cloud_result(py::module_& module) {
  py::class_<cloud::Facts>(module, "CloudFacts", "What was found in the cloud; lengths in its unit.")
      .def_readonly("points", &cloud::Facts::points)
      .def_readonly("not_finite", &cloud::Facts::not_finite)
      .def_readonly("duplicates", &cloud::Facts::duplicates)
      .def_readonly("outliers", &cloud::Facts::outliers)
      .def_readonly("points_used", &cloud::Facts::points_used)
      .def_readonly("diagonal", &cloud::Facts::diagonal)
      .def_readonly("spacing", &cloud::Facts::spacing)
      .def_readonly("noise", &cloud::Facts::noise)
      .def_readonly("cells", &cloud::Facts::cells)
      .def_readonly("parts", &cloud::Facts::parts)
      .def_readonly("genus", &cloud::Facts::genus)
      .def_property_readonly(
          "boundary", [](const cloud::Facts& f) { return std::string(word_of(f.boundary)); },
          "What was done where the points end: close, keep or trim.")
      .def_readonly("boundary_loops", &cloud::Facts::boundary_loops);
  py::class_<Lods, LodsPtr>(module, "CloudResult", "Meshes of a cloud, closed or open, finest first.",
                            py::dynamic_attr())
      .def(by_pickle<Lods>())
      .def("__len__", [](const Lods& l) { return l.run.result.levels.size(); })
      .def("__getitem__",
           [](const LodsPtr& l, py::ssize_t n) {
             const auto count = static_cast<py::ssize_t>(l->run.result.levels.size());
             if (n < 0) n += count;
             if (n < 0 || n >= count) throw py::index_error("level out of range");
             return held(part_of(l, l->run.result.levels[static_cast<std::size_t>(n)]));
           })
      .def_property_readonly("facts", [](const Lods& l) { return l.run.result.facts; })
      .def_property_readonly("notes", [](const Lods& l) { return l.run.result.notes; })
      .def_property_readonly("watertight", [](const Lods& l) { return cloud::is_watertight(l.run.result); })
      .def_property_readonly("trustworthy", [](const Lods& l) { return report::is_trustworthy(l.run.result); })
      .def_property_readonly("command", [](const Lods& l) { return l.provenance.command; })
      .def(
          "results_text",
          [](const Lods& l, bool timings) {
            return report::cloud_results_text(
                l.run, l.provenance,
                {{io::MeshFormat::ply}, false, false, timings ? report::Timings::keep : report::Timings::omit});
          },
          py::arg("timings") = true, py::call_guard<py::gil_scoped_release>())
      .def(
          "report_html",
          [](const Lods& l) { return report::cloud_report_html(l.run, l.provenance, report::Timings::omit); },
          py::call_guard<py::gil_scoped_release>())
      .def("_options_text", [](const Lods& l) { return l.provenance.options_json; })
      .def("_save", &save, needed("folder"), needed("mesh_formats"), needed("textures"), needed("packed"),
           needed("timings"), needed("replace"), py::call_guard<py::gil_scoped_release>());
}

}  // namespace

void bind_cloud(py::module_& module) {
  py::class_<OriginCloud, CloudPtr>(module, "PointCloud", "Points of a scanned surface, in any unit.")
      .def(by_pickle<OriginCloud>())
      .def(py::init(&cloud_from), needed("points"), py::arg("normals") = py::none(), py::arg("colours") = py::none(),
           py::arg("scans") = py::none(), py::arg("scanners") = py::none())
      .def("__len__", [](const OriginCloud& c) { return c.cloud.points.size(); })
      .def_property_readonly(
          "points", [](const CloudPtr& c) { return view_of(c->cloud.points, c); }, "(n, 3) float64: a read-only view.")
      .def_property_readonly(
          "normals", [](const CloudPtr& c) { return view_of(c->cloud.normals, c); },
          "(n, 3) float64, outwards; empty: none.")
      .def_property_readonly(
          "scans", [](const CloudPtr& c) { return view_of_values(c->cloud.scans, c); },
          "(n,) uint32: which scan a point comes from; empty: all from one.")
      .def_property_readonly(
          "scanners", [](const CloudPtr& c) { return view_of(c->cloud.scanners, c); },
          "(scans, 3) float64: where each was taken from, NaN where that is not known; empty: nowhere known.")
      .def_readonly("notes", &OriginCloud::notes);
  bind_certificate(module);
  bind_levels(module);
  bind_cloud_result(module);
  module.def(
      "reconstruct_cloud",
      [](const CloudPtr& cloud, const std::string& options, const std::string& preset,
         const std::shared_ptr<StageCache>& cache, py::object progress, int threads) {
        const auto how = options_from<cloud::Options>(options);
        return run_long_for({std::move(progress), threads}, [=](const Progress& told) {
          return reconstruct_lods(*cloud, how, preset, cache.get(), told);
        });
      },
      needed("cloud"), needed("options"), needed("preset"), py::arg("cache"), py::arg("progress"), needed("threads"));
}

}  // namespace dynasurf::python
