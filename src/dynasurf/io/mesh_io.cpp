#include "dynasurf/io/mesh_io.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/detail/memory_limit.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/mesh/detail/vertex_normals.hpp"

namespace dynasurf::io {
namespace {

using namespace detail;

/// Larger files are refused before memory is taken for them: 40 million triangles fit.
constexpr std::uint64_t max_mesh_bytes = std::uint64_t{2} << 30;

constexpr std::string_view mesh_format_names[] = {"ply", "stl", "obj", "off", "vtp", "glb", "3mf"};

bool is_plain_word(const std::string& name) {
  return !name.empty() &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
}

}  // namespace

std::span<const std::string_view> names_of(MeshFormat) { return mesh_format_names; }

void write_mesh(const TriMesh& mesh, const std::filesystem::path& path, MeshFormat format,
                std::span<const VertexScalar> scalars, const VertexColours& colours) {
  check_writable(mesh, scalars, path.string());
  check_colours(mesh, colours, path.string());
  switch (format) {
    case MeshFormat::ply:
      return write_file(path, encode_ply(mesh, scalars, colours));
    case MeshFormat::stl:
      return write_file(path, encode_stl(mesh));
    case MeshFormat::obj:
      return write_file(path, encode_obj(mesh, colours));
    case MeshFormat::off:
      return write_file(path, encode_off(mesh, colours));
    case MeshFormat::vtp:
      return write_file(path, encode_vtp(mesh, scalars));
    case MeshFormat::glb:
      return write_file(path, encode_glb(mesh, scalars, colours, path.string()));
    case MeshFormat::threemf:
      return write_file(path, encode_3mf(mesh));
  }
}

TriMesh read_mesh(const std::filesystem::path& path) {
  const std::string ending = small_letters(path.extension().string());
  TriMesh (*decode)(const MeshFile&) = nullptr;
  if (ending == ".ply") decode = decode_ply;
  if (ending == ".stl") decode = decode_stl;
  if (ending == ".obj") decode = decode_obj;
  if (ending == ".off") decode = decode_off;
  if (decode == nullptr)
    throw InputError(path.string() + ": unknown kind of mesh; expected a name that ends in .ply, .stl, .obj or .off");
  const std::string content = read_whole(path, "a mesh");
  const MeshFile file{path.string(), content};
  TriMesh mesh = decode(file);
  if (mesh.triangles.empty()) refuse(file, "", 0, "holds no triangle; expected a surface");
  return mesh;
}

namespace detail {

void refuse(const MeshFile& file, std::string_view unit, std::size_t place, const std::string& reason) {
  std::string text = file.name + ": ";
  if (!unit.empty()) text += std::string(unit) + " " + std::to_string(place) + ": ";
  throw InputError(text + reason);
}

std::string read_whole(const std::filesystem::path& path, const char* what) {
  const std::uint64_t size = size_of_file(path);
  if (size > max_mesh_bytes)
    throw InputError(path.string() + ": " + std::to_string(size) + " bytes; expected " + what + " of at most 2 GiB");
  require_memory(size, path.string(), what);
  std::string content(size, '\0');
  ByteSource source(path, ByteSource::Packing::plain);
  source.read(std::as_writable_bytes(std::span(content)), "content");
  return content;
}

void require_memory_of(const MeshFile& file, std::size_t vertices, std::size_t triangles, bool as_cloud) {
  // Measured with `cloud` on ellipsoids: 68 MB for 400,000 points, 157 MB for 2 million, the text of 12 and 62 MB
  // included.
  constexpr std::uint64_t program = std::uint64_t{64} << 20;
  const std::uint64_t mesh = 100 * std::uint64_t{vertices} + 150 * std::uint64_t{triangles};
  const std::uint64_t points = triangles > 0 ? std::max(vertices, points_of_a_surface) : vertices;
  std::string what = std::to_string(vertices) + (as_cloud ? " points" : " vertices");
  if (triangles > 0) what += " and " + std::to_string(triangles) + " triangles";
  require_memory(program + file.bytes.size() + mesh + (as_cloud ? 100 * points : 0), file.name, what);
}

void MeshRoom::grow(const TriMesh& mesh, std::size_t triangles) {
  // Room for a quarter more is looked for at each time, so that a growing mesh asks a logarithmic number of times.
  const auto beyond = [](std::size_t count) { return count + count / 4 + 10'000; };
  vertices_ = beyond(mesh.vertices.size() + 1);
  triangles_ = beyond(mesh.triangles.size() + triangles);
  require_memory_of(file_, vertices_, mesh.triangles.empty() && triangles <= 1 ? 0 : triangles_, as_cloud_);
}

std::size_t count_lines(std::string_view text) { return std::count(text.begin(), text.end(), '\n'); }

/// Words of a file come into messages: cut short, and without control characters that a terminal would obey.
std::string quoted(std::string_view word) {
  std::string out = "'";
  for (const unsigned char c : word.substr(0, 40)) out += std::isprint(c) != 0 ? static_cast<char>(c) : '?';
  return out += '\'';
}

void check_writable(const TriMesh& mesh, std::span<const VertexScalar> scalars, const std::string& what) {
  const auto refuse_mesh = [&](const std::string& reason) { throw InputError("cannot write " + what + ": " + reason); };
  if (mesh.triangles.empty()) refuse_mesh("the mesh has no triangle");
  if (mesh.vertices.size() > 0x7fffffff || mesh.triangles.size() > 0x7fffffff)
    refuse_mesh("more than 2147483647 vertices or triangles");
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    if (!mesh.vertices[v].allFinite()) refuse_mesh("vertex " + std::to_string(v) + " is not finite");
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const auto v : mesh.triangles[t])
      if (v >= mesh.vertices.size())
        refuse_mesh("triangle " + std::to_string(t) + " uses vertex " + std::to_string(v) + " of " +
                    std::to_string(mesh.vertices.size()));

  std::set<std::string> taken{"x", "y", "z", "nx", "ny", "nz", "red", "green", "blue", "Normals", "Points"};
  for (const VertexScalar& s : scalars) {
    if (!is_plain_word(s.name) || !taken.insert(s.name).second)
      throw OptionError("cannot write " + what + ": scalar name '" + s.name +
                        "'; expected a new word of letters, digits and _");
    if (s.values.size() != mesh.vertices.size())
      throw OptionError("cannot write " + what + ": scalar " + s.name + " has " + std::to_string(s.values.size()) +
                        " values; expected one for each of " + std::to_string(mesh.vertices.size()) + " vertices");
  }
}

void check_colours(const TriMesh& mesh, const VertexColours& colours, const std::string& what) {
  if (!colours.empty() && colours.size() != mesh.vertices.size())
    throw OptionError("cannot write " + what + ": " + std::to_string(colours.size()) +
                      " colours; expected one for each of " + std::to_string(mesh.vertices.size()) + " vertices");
}

std::vector<Eigen::Vector3f> normals_to_write(const TriMesh& mesh) {
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(mesh.vertices.size());
  // Normals of glTF are unit vectors; a vertex whose triangles cancel out has none of its own.
  for (const Vec3& n : mesh::vertex_normals(mesh)) normals.push_back((n.isZero() ? Vec3::UnitZ() : n).cast<float>());
  return normals;
}

void add_fan(TriMesh& mesh, std::span<const std::uint32_t> corners) {
  for (std::size_t i = 2; i < corners.size(); ++i) mesh.triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

}  // namespace detail
}  // namespace dynasurf::io
