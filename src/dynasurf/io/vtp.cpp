#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/vtk_xml.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::io {
namespace detail {

std::string encode_vtp(const TriMesh& mesh, std::span<const VertexScalar> scalars) {
  std::vector<double> points;
  for (const Vec3& p : mesh.vertices) points.insert(points.end(), p.begin(), p.end());
  std::vector<float> normals;
  for (const auto& n : normals_to_write(mesh)) normals.insert(normals.end(), n.begin(), n.end());
  std::vector<std::int64_t> corners, ends;
  for (const auto& t : mesh.triangles) {
    corners.insert(corners.end(), t.begin(), t.end());
    ends.push_back(corners.size());
  }

  VtkXml xml;
  std::string body = "<!-- dynasurf, patient coordinates (LPS, mm) or those of the scan -->\n<PolyData>\n" +
                     std::string(lps_field) + "<Piece NumberOfPoints=\"" + std::to_string(mesh.vertices.size()) +
                     "\" NumberOfVerts=\"0\" NumberOfLines=\"0\" " + "NumberOfStrips=\"0\" NumberOfPolys=\"" +
                     std::to_string(mesh.triangles.size()) + "\">\n";
  body += "<PointData Normals=\"Normals\">\n" + xml.array<float>("Normals", 3, normals);
  for (const VertexScalar& s : scalars) body += xml.array<float>(s.name, 1, s.values);
  body += "</PointData>\n<Points>\n" + xml.array<double>("Points", 3, points) + "</Points>\n";
  // Each array is appended when it is named: a compiler may choose which of two in one expression comes first.
  const std::string offsets = xml.array<std::int64_t>("offsets", 1, ends);
  body += "<Polys>\n" + xml.array<std::int64_t>("connectivity", 1, corners) + offsets + "</Polys>\n";
  body += "</Piece>\n</PolyData>\n";
  return xml.file("PolyData", body);
}

}  // namespace detail

void write_pvd(std::span<const PvdEntry> entries, const std::filesystem::path& path) {
  std::string out =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
      "<Collection>\n";
  for (const PvdEntry& e : entries) {
    out += "<DataSet timestep=\"";
    detail::append_text(out, e.time);
    out += "\" part=\"" + std::to_string(e.part) + "\" file=\"" + detail::xml_text(e.file) + "\"/>\n";
  }
  write_file(path, out + "</Collection>\n</VTKFile>\n");
}

}  // namespace dynasurf::io
