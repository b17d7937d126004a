#include <array>
#include <charconv>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/gzip.hpp"
#include "dynasurf/io/study_io.hpp"

namespace dynasurf::io {
namespace {

/// Shortest text that reads back as the same number.
std::string text_of(double value) {
  std::array<char, 40> buffer;
  if (value == 0) value = 0;  // no "-0"
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

std::string text_of(const Vec3& v) { return "(" + text_of(v[0]) + "," + text_of(v[1]) + "," + text_of(v[2]) + ")"; }

std::string header_of(const Study& study) {
  const Grid& grid = study.grid();
  const bool sequence = study.gates.size() > 1;
  std::string h =
      "NRRD0005\n# Complete NRRD file format specification at:\n# http://teem.sourceforge.net/nrrd/format.html\n";
  h += "type: float\ndimension: " + std::string(sequence ? "4" : "3") + "\nspace: left-posterior-superior\nsizes:";
  for (const int extent : grid.dims) h += " " + std::to_string(extent);
  if (sequence) h += " " + std::to_string(study.gates.size());
  h += "\nspace directions:";
  for (int axis = 0; axis < 3; ++axis) h += " " + text_of(Vec3(grid.direction.col(axis) * grid.spacing[axis]));
  h += sequence ? " none\nkinds: domain domain domain list\n" : "\nkinds: domain domain domain\n";
  const bool timed = study.time_ms.size() == study.gates.size();
  if (sequence) {
    h += std::string("labels: \"\" \"\" \"\" \"") + (timed ? "time" : "gate") + "\"\n";
    h += std::string("units: \"\" \"\" \"\" \"") + (timed ? "ms" : "") + "\"\n";
  }
  h +=
      "endian: little\nencoding: gzip\nspace origin: " + text_of(grid.origin) + "\nspace units: \"mm\" \"mm\" \"mm\"\n";
  if (sequence) {
    h += "DataNodeClassName:=vtkMRMLScalarVolumeNode\naxis 3 index type:=numeric\naxis 3 index values:=";
    for (std::size_t g = 0; g < study.gates.size(); ++g)
      h += (g ? " " : "") + (timed ? text_of(study.time_ms[g]) : std::to_string(g));
    h += "\n";
  }
  if (study.cycle_ms > 0) h += "dynasurf cycle ms:=" + text_of(study.cycle_ms) + "\n";
  if (study.view != View::unknown) h += "dynasurf view:=" + std::string(name_of(study.view)) + "\n";
  if (study.slice_order != SliceOrder::unknown)
    h += "dynasurf slice order:=" + std::string(name_of(study.slice_order)) + "\n";
  if (study.attenuation != Attenuation::unknown)
    h += "dynasurf attenuation:=" + std::string(name_of(study.attenuation)) + "\n";
  return h + "\n";
}

}  // namespace

void write_nrrd(const Study& study, const std::filesystem::path& path) {
  if (study.gates.empty()) throw InputError(path.string() + ": cannot write a study without a volume");
  std::string voxels;
  for (const Image& image : study.gates)
    voxels.append(reinterpret_cast<const char*>(image.values.data()), image.values.size() * sizeof(float));
  write_file(path, header_of(study) + gzip(voxels));
}

}  // namespace dynasurf::io
