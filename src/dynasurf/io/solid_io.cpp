#include <array>
#include <charconv>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/vtk_xml.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::io {
namespace {

constexpr std::array<std::string_view, 3> format_names{"vtu", "msh", "inp"};

std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

std::string vtu(const mesh::TetMesh& solid, std::span<const VertexScalar> scalars) {
  constexpr std::uint8_t tetrahedron = 10;  // VTK's number of the cell type
  std::vector<double> points;
  for (const Vec3& p : solid.vertices) points.insert(points.end(), p.begin(), p.end());
  std::vector<std::int64_t> corners, ends;
  for (const auto& t : solid.tetrahedra) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(corners.size());
  }
  const std::vector<std::uint8_t> types(solid.tetrahedra.size(), tetrahedron);
  detail::VtkXml xml;
  std::string body = "<!-- dynasurf, world coordinates, LPS, mm -->\n<UnstructuredGrid>\n" +
                     std::string(detail::lps_field) + "<Piece NumberOfPoints=\"" +
                     std::to_string(solid.vertices.size()) + "\" NumberOfCells=\"" +
                     std::to_string(solid.tetrahedra.size()) + "\">\n<PointData>\n";
  for (const VertexScalar& s : scalars) body += xml.array<float>(s.name, 1, s.values);
  // One by one: a compiler may choose which of two in one expression is appended first.
  body += "</PointData>\n<Points>\n" + xml.array<double>("Points", 3, points) + "</Points>\n<Cells>\n";
  body += xml.array<std::int64_t>("connectivity", 1, corners);
  body += xml.array<std::int64_t>("offsets", 1, ends);
  body += xml.array<std::uint8_t>("types", 1, types) + "</Cells>\n</Piece>\n</UnstructuredGrid>\n";
  return xml.file("UnstructuredGrid", body);
}

/// gmsh 2.2 as text; nodes and elements are counted from 1.
std::string msh(const mesh::TetMesh& solid) {
  std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n3 1 \"wall\"\n$EndPhysicalNames\n$Nodes\n" +
      std::to_string(solid.vertices.size()) + "\n";
  for (std::size_t v = 0; v < solid.vertices.size(); ++v) {
    text += std::to_string(v + 1);
    for (const double x : solid.vertices[v]) text += " " + text_of(x);
    text += '\n';
  }
  text += "$EndNodes\n$Elements\n" + std::to_string(solid.tetrahedra.size()) + "\n";
  for (std::size_t t = 0; t < solid.tetrahedra.size(); ++t) {
    text += std::to_string(t + 1) + " 4 2 1 1";  // a tetrahedron with two tags: physical and elementary entity
    for (const std::uint32_t v : solid.tetrahedra[t]) text += " " + std::to_string(v + 1);
    text += '\n';
  }
  return text + "$EndElements\n";
}

/// Input of Abaqus: C3D4 is the linear tetrahedron, counted from 1.
std::string inp(const mesh::TetMesh& solid) {
  std::string text = "*HEADING\ndynasurf, world coordinates LPS, mm\n*NODE\n";
  for (std::size_t v = 0; v < solid.vertices.size(); ++v) {
    text += std::to_string(v + 1);
    for (const double x : solid.vertices[v]) text += ", " + text_of(x);
    text += '\n';
  }
  text += "*ELEMENT, TYPE=C3D4, ELSET=WALL\n";
  for (std::size_t t = 0; t < solid.tetrahedra.size(); ++t) {
    text += std::to_string(t + 1);
    for (const std::uint32_t v : solid.tetrahedra[t]) text += ", " + std::to_string(v + 1);
    text += '\n';
  }
  return text;
}

void check(const mesh::TetMesh& solid, std::span<const VertexScalar> scalars) {
  if (solid.tetrahedra.empty()) throw InputError("write_solid: there is no tetrahedron");
  for (const auto& t : solid.tetrahedra)
    for (const std::uint32_t v : t)
      if (v >= solid.vertices.size()) throw InputError("write_solid: there is no vertex " + std::to_string(v));
  for (const VertexScalar& s : scalars)
    if (s.values.size() != solid.vertices.size())
      throw OptionError("write_solid: " + s.name + " has " + std::to_string(s.values.size()) + " values; expected " +
                        std::to_string(solid.vertices.size()));
}

}  // namespace

std::span<const std::string_view> names_of(SolidFormat) { return format_names; }

void write_solid(const mesh::TetMesh& solid, const std::filesystem::path& path, SolidFormat format,
                 std::span<const VertexScalar> scalars) {
  check(solid, scalars);
  switch (format) {
    case SolidFormat::vtu:
      return write_file(path, vtu(solid, scalars));
    case SolidFormat::msh:
      return write_file(path, msh(solid));
    case SolidFormat::inp:
      return write_file(path, inp(solid));
  }
}

}  // namespace dynasurf::io
