#include "dynasurf/io/cloud_io.hpp"

#include <algorithm>
#include <limits>
#include <map>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/mesh/detail/sample_surface.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::io {
namespace {

using namespace detail;

enum class Kind { ply, rows, normals, obj, off, stl, las, pcd, ptx, e57 };

struct Format {
  std::string_view ending, name;
  Kind kind;
};
constexpr Format known_formats[] = {
    {".ply", "PLY", Kind::ply},     {".xyz", "XYZ", Kind::rows}, {".txt", "XYZ", Kind::rows},
    {".asc", "XYZ", Kind::rows},    {".pts", "PTS", Kind::rows}, {".csv", "CSV", Kind::rows},
    {".pwn", "PWN", Kind::normals}, {".obj", "OBJ", Kind::obj},  {".off", "OFF", Kind::off},
    {".stl", "STL", Kind::stl},     {".las", "LAS", Kind::las},  {".laz", "LAZ", Kind::las},
    {".pcd", "PCD", Kind::pcd},     {".ptx", "PTX", Kind::ptx},  {".e57", "E57", Kind::e57}};

const Format& format_of(const std::filesystem::path& path) {
  const std::string ending = small_letters(path.extension().string());
  for (const Format& format : known_formats)
    if (format.ending == ending) return format;
  throw InputError(path.string() +
                   ": unknown kind of cloud; expected a name that ends in .ply, .xyz, .txt, .asc, .pts, .csv, .pwn, "
                   ".obj, .off, .stl, .las, .laz, .pcd, .ptx or .e57");
}

TriMesh decode(Kind kind, const MeshFile& file, VertexData& data) {
  switch (kind) {
    case Kind::ply:
      return decode_ply(file, data);
    case Kind::rows:
    case Kind::normals:
      return decode_rows(file, data, kind == Kind::normals);
    case Kind::obj:
      return decode_obj(file, data);
    case Kind::off:
      return decode_off(file, data);
    case Kind::las:
      return decode_las(file, data);
    case Kind::pcd:
      return decode_pcd(file, data);
    case Kind::ptx:
      return decode_ptx(file, data);
    case Kind::e57:
      return decode_e57(file, data);
    case Kind::stl:
      break;
  }
  return decode_stl(file, true);
}

void tell(Notes& notes, Severity severity, std::string code, std::string message) {
  notes.push_back({severity, std::move(code), std::move(message)});
}

/// Numbers the scans on from `first` in the order in which they are first seen; how many they are. Adds the places they
/// were taken from to `scanners`.
std::uint32_t renumber(PointCloud& cloud, std::uint32_t first, std::vector<Vec3>& scanners) {
  // A tree, whose time does not depend on which numbers a file has chosen.
  std::map<std::uint32_t, std::uint32_t> numbers;
  for (auto& scan : cloud.scans)
    scan = first + numbers.try_emplace(scan, static_cast<std::uint32_t>(numbers.size())).first->second;
  scanners.resize(first + numbers.size(), Vec3::Constant(std::numeric_limits<double>::quiet_NaN()));
  for (const auto& [old, number] : numbers)
    if (!cloud.scanners.empty()) scanners[first + number] = cloud.scanners[old];
  return numbers.size();
}

/// Triangles with a corner that is nowhere are no surface.
void drop_broken_triangles(TriMesh& mesh, Notes& notes) {
  const auto broken = [&](const auto& t) {
    return std::any_of(t.begin(), t.end(), [&](std::uint32_t v) { return !mesh.vertices[v].allFinite(); });
  };
  if (const auto count = std::erase_if(mesh.triangles, broken); count > 0)
    tell(notes, Severity::warning, "read.left_out",
         std::to_string(count) + " triangles have a corner that is not finite and were left out");
}

Vec3 normal_of(const TriMesh& mesh, std::size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  return (mesh.vertices[b] - mesh.vertices[a]).cross(mesh.vertices[c] - mesh.vertices[a]);
}

/// A surface as points: its vertices, then points spread evenly over it.
PointCloud sampled(const TriMesh& mesh, const VertexData& data) {
  PointCloud cloud;
  std::vector<Vec3> area(mesh.vertices.size(), Vec3::Zero());  // of the triangles around each vertex
  std::vector<bool> used(mesh.vertices.size(), false);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const auto v : mesh.triangles[t]) {
      area[v] += normal_of(mesh, t);
      used[v] = true;
    }
  const bool coloured = !data.colours.empty();
  // Triangles that do not agree on their outer side give no directions: normals would be half right.
  const bool oriented = mesh::topology(mesh).oriented();
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!used[v]) continue;
    cloud.points.push_back(mesh.vertices[v]);
    if (coloured) cloud.colours.push_back(data.colours[v]);
    if (oriented) cloud.normals.push_back(area[v]);
  }
  if (cloud.points.size() >= points_of_a_surface) return cloud;
  for (const mesh::SurfaceSample& p : mesh::sample_surface(mesh, points_of_a_surface - cloud.points.size())) {
    cloud.points.push_back(mesh::position_of(mesh, p));
    if (oriented) cloud.normals.push_back(normal_of(mesh, p.triangle));
    if (!coloured) continue;
    auto& colour = cloud.colours.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      double light = 0;
      for (std::size_t corner = 0; corner < 3; ++corner)
        light += p.weight[corner] * data.colours[mesh.triangles[p.triangle][corner]][c];
      colour[c] = colour_byte(light, 255);
    }
  }
  return cloud;
}

/// Whether every finite point has a direction. One point without a normal spoils all: a cloud has normals for all
/// points or for none.
bool normals_are_whole(const PointCloud& cloud) {
  for (std::size_t n = 0; n < cloud.normals.size(); ++n)
    // stableNorm: the square of a tiny but valid normal underflows to 0.
    if (cloud.points[n].allFinite() && !(cloud.normals[n].allFinite() && cloud.normals[n].stableNorm() > 0))
      return false;
  return true;
}

template <class T>
void append_all(std::vector<T>& to, std::vector<T>& from) {
  if (to.empty())
    to = std::move(from);
  else
    to.insert(to.end(), from.begin(), from.end());
}

/// What not all files have cannot be kept: a cloud has it for all points or for none.
template <class T>
void keep_if_whole(std::vector<T>& values, std::size_t points, const char* what, Notes& notes) {
  if (values.empty() || values.size() == points) return;
  values.clear();
  tell(notes, Severity::warning, std::string("read.") + what + "_dropped",
       std::string("not every file has ") + what + "; those that are there were left out");
}

PointCloud read_one(const std::filesystem::path& path, CloudSource& source, Notes& notes) {
  format_of(path);  // a name that tells no format is refused before the file is opened
  const std::string content = read_whole(path, "a cloud");
  return decode_cloud({path.string(), content}, source, notes);
}

}  // namespace

PointCloud detail::decode_cloud(const MeshFile& file, CloudSource& source, Notes& notes) {
  const std::filesystem::path path = file.name;
  const Format& format = format_of(path);
  VertexData data;
  TriMesh mesh = decode(format.kind, file, data);
  source.format = format.name;
  if (!data.remark.empty()) tell(notes, Severity::info, "read.left_out", data.remark);
  if (!data.has_end)
    tell(notes, Severity::info, "read.no_end",
         "the last line has no end; it was taken as whole, but may have been cut");
  if (!data.has_count)
    tell(notes, Severity::info, "read.no_count",
         "the file does not tell how much it holds; one that was cut at the end of a line would look alike");
  if (mesh.vertices.empty()) refuse(file, "", 0, "holds no point; expected a cloud or a surface");
  if (mesh.vertices.size() > most_cloud_points)
    refuse(file, "", 0, "holds " + std::to_string(mesh.vertices.size()) + " points; expected at most 100000000");
  PointCloud cloud;
  if (mesh.triangles.empty()) {
    cloud = {std::move(mesh.vertices), std::move(data.normals), std::move(data.colours), std::move(data.scans),
             std::move(data.scanners)};
  } else {
    drop_broken_triangles(mesh, notes);
    source.triangles = mesh.triangles.size();
    cloud = sampled(mesh, data);
    if (cloud.points.empty())
      refuse(file, "", 0, "holds no triangle with finite corners; expected a cloud or a surface");
    tell(notes, Severity::info, "read.sampled",
         "a surface of " + std::to_string(mesh.triangles.size()) + " triangles, sampled to " +
             std::to_string(cloud.points.size()) + " points");
  }
  if (!normals_are_whole(cloud)) {
    cloud.normals.clear();
    tell(notes, Severity::warning, "read.normals_dropped",
         "some normals are 0 or not finite; all are estimated from the points instead");
  }
  source.points = cloud.points.size();
  return cloud;
}

CloudInput read_cloud(std::span<const std::filesystem::path> files) {
  if (files.empty()) throw InputError("no file to read a cloud from; expected one or more");
  CloudInput input;
  std::uint32_t scans = 0;
  for (const std::filesystem::path& path : files) {
    Notes notes;
    PointCloud cloud = read_one(path, input.sources.emplace_back(), notes);
    for (Note& note : notes) {
      if (files.size() > 1) note.message = "file " + std::to_string(input.sources.size()) + ": " + note.message;
      input.notes.push_back(std::move(note));
    }
    if (input.cloud.points.size() + cloud.points.size() > most_cloud_points)
      throw InputError(path.string() + ": with it the cloud has more than 100000000 points");
    // Files are scans of their own, each with one or more; numbers are made unique across files.
    if (cloud.scans.empty()) cloud.scans.assign(cloud.points.size(), 0);
    scans += renumber(cloud, scans, input.cloud.scanners);
    append_all(input.cloud.scans, cloud.scans);
    append_all(input.cloud.normals, cloud.normals);
    append_all(input.cloud.colours, cloud.colours);
    append_all(input.cloud.points, cloud.points);
  }
  const std::size_t points = input.cloud.points.size();
  keep_if_whole(input.cloud.normals, points, "normals", input.notes);
  keep_if_whole(input.cloud.colours, points, "colours", input.notes);
  const auto is_known = [](const Vec3& place) { return place.allFinite(); };
  if (std::none_of(input.cloud.scanners.begin(), input.cloud.scanners.end(), is_known)) input.cloud.scanners.clear();
  if (scans == 1)
    input.cloud.scans.clear();
  else
    tell(input.notes, Severity::info, "read.scans", std::to_string(scans) + " scans");
  return input;
}

void write_cloud(const PointCloud& cloud, const std::filesystem::path& path) {
  const std::size_t count = cloud.points.size();
  if (count == 0) throw InputError("cannot write " + path.string() + ": the cloud has no point");
  for (const std::size_t size : {cloud.normals.size(), cloud.colours.size(), cloud.scans.size()})
    if (size != 0 && size != count)
      throw InputError("cannot write " + path.string() + ": " + std::to_string(size) + " values for " +
                       std::to_string(count) + " points");
  std::string out =
      "ply\nformat binary_little_endian 1.0\ncomment dynasurf\nelement vertex " + std::to_string(count) + "\n";
  for (const char* name : {"x", "y", "z"}) out += std::string("property double ") + name + "\n";
  if (!cloud.normals.empty())
    for (const char* name : {"nx", "ny", "nz"}) out += std::string("property float ") + name + "\n";
  if (!cloud.colours.empty())
    for (const char* name : {"red", "green", "blue"}) out += std::string("property uchar ") + name + "\n";
  if (!cloud.scans.empty()) out += "property uint scan\n";
  out += "end_header\n";
  for (std::size_t n = 0; n < count; ++n) {
    for (const double c : cloud.points[n]) append(out, c);
    if (!cloud.normals.empty())
      for (const double c : cloud.normals[n]) append(out, static_cast<float>(c));
    if (!cloud.colours.empty())
      for (const std::uint8_t c : cloud.colours[n]) append(out, c);
    if (!cloud.scans.empty()) append(out, cloud.scans[n]);
  }
  write_file(path, out);
}

}  // namespace dynasurf::io
