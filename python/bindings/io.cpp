#include <filesystem>

#include <pybind11/stl/filesystem.h>

#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/mesh_io.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/report/detail/run_record.hpp"

#include "arrays.hpp"
#include "clouds.hpp"
#include "origin.hpp"

namespace dynasurf::python {

namespace fs = std::filesystem;

namespace {

report::InputFile input_of(const fs::path& file, std::size_t position) {
  return {report::neutral_name(file, position), io::sha256_of_file(file), fs::file_size(file)};
}

std::shared_ptr<OriginStudy> read(const fs::path& path, const std::string& series) {
  const py::gil_scoped_release release;
  auto study = std::make_shared<OriginStudy>(io::read_study(path, series));
  for (const fs::path& file : io::files_of_study(path, series))
    study->inputs.push_back(input_of(file, study->inputs.size()));
  return study;
}

std::shared_ptr<OriginCloud> read_points(const std::vector<fs::path>& files) {
  const py::gil_scoped_release release;
  auto cloud = std::make_shared<OriginCloud>();
  static_cast<io::CloudInput&>(*cloud) = io::read_cloud(files);
  for (const fs::path& file : files) cloud->inputs.push_back(input_of(file, cloud->inputs.size()));
  return cloud;
}

io::MeshFormat format_of(const fs::path& path) {
  std::string ending = path.extension().string();
  if (!ending.empty()) ending.erase(0, 1);
  const auto names = io::names_of(io::MeshFormat{});
  const auto found = std::find(names.begin(), names.end(), ending);
  if (found == names.end())
    throw OptionError(path.string() + " ends in '." + ending + "'; expected .ply, .stl, .obj, .off, .vtp or .glb");
  return static_cast<io::MeshFormat>(found - names.begin());
}

}  // namespace

void bind_io(py::module_& module) {
  using release_lock = py::call_guard<py::gil_scoped_release>;
  module.def("read_study", &read, needed("path"), py::arg("series") = "");
  module.def("sha256_of_file", &io::sha256_of_file, needed("path"), release_lock());
  module.def("read_cloud", &read_points, needed("files"));
  module.def(
      "read_mesh", [](const fs::path& path) { return std::make_shared<TriMesh>(io::read_mesh(path)); }, needed("path"),
      release_lock());
  module.def(
      "write_mesh",
      [](const std::shared_ptr<TriMesh>& mesh, const fs::path& path) { io::write_mesh(*mesh, path, format_of(path)); },
      needed("mesh"), needed("path"), release_lock());
  module.def(
      "write_nifti",
      [](const std::shared_ptr<OriginStudy>& study, const fs::path& path) { io::write_nifti(*study, path); },
      needed("study"), needed("path"), release_lock());
  module.def(
      "write_nrrd",
      [](const std::shared_ptr<OriginStudy>& study, const fs::path& path) { io::write_nrrd(*study, path); },
      needed("study"), needed("path"), release_lock());
  module.def(
      "write_dicom",
      [](const std::shared_ptr<OriginStudy>& study, const fs::path& path, double counts_scale) {
        io::DicomWriteOptions options;
        options.counts_scale = counts_scale;
        io::write_dicom(*study, path, options);
      },
      needed("study"), needed("path"), py::arg("counts_scale") = 1.0, release_lock());
}

}  // namespace dynasurf::python
