#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/io/detail/mesh_parts.hpp"

// The doors between mesh_io.cpp and the mesh formats, one source each. A format turns a mesh into bytes and bytes into
// a mesh; files, names and the checks that all formats share stay in mesh_io.cpp.
namespace dynasurf::io::detail {

/// The whole content of a file and the name to blame.
struct MeshFile {
  std::string name;
  std::string_view bytes;
};

/// All of a file; `what` it is ("a mesh") stands in the refusal of one above 2 GiB or the limit of memory. Throws
/// InputError, IoError.
std::string read_whole(const std::filesystem::path& path, const char* what);

/// Throws InputError "NAME: line 12: REASON", or byte 12, or without a place when `unit` is empty.
[[noreturn]] void refuse(const MeshFile& file, std::string_view unit, std::size_t place, const std::string& reason);

/// Throws InputError when a mesh of so many vertices and triangles (or with `as_cloud` a cloud of so many points, or of
/// the points sampled from such a mesh) would take more memory than the limit, through the heaviest job on it. Called
/// with what a header declares or the file can hold at most, before any row is read.
void require_memory_of(const MeshFile& file, std::size_t vertices, std::size_t triangles, bool as_cloud);

/// Keeps a mesh that grows row by row within the limit of memory: to be asked before rows are added.
class MeshRoom {
 public:
  MeshRoom(const MeshFile& file, bool as_cloud) : file_(file), as_cloud_(as_cloud) {}
  /// Throws InputError like `require_memory_of`. At most so many triangles are added before it is asked again.
  void before_more(const TriMesh& mesh, std::size_t triangles = 1) {
    if (mesh.vertices.size() + 1 > vertices_ || mesh.triangles.size() + triangles > triangles_) grow(mesh, triangles);
  }

 private:
  void grow(const TriMesh& mesh, std::size_t triangles);
  const MeshFile& file_;
  bool as_cloud_;
  std::size_t vertices_ = 0, triangles_ = 0;  // that there is memory for
};

/// Rows of a text: its line breaks.
std::size_t count_lines(std::string_view text);

/// A word of a file as it may stand in a message: 'word', at most 40 characters, unprintable ones as ?.
std::string quoted(std::string_view word);

// Encoders. Precondition: the mesh has passed `check_writable`.
std::string encode_ply(const TriMesh& mesh, std::span<const VertexScalar> scalars, const VertexColours& colours = {});
std::string encode_vtp(const TriMesh& mesh, std::span<const VertexScalar> scalars);
std::string encode_stl(const TriMesh& mesh);
std::string encode_obj(const TriMesh& mesh, const VertexColours& colours = {});
std::string encode_off(const TriMesh& mesh, const VertexColours& colours = {});
/// `what` names the output, should glTF refuse it.
std::string encode_glb(const TriMesh& mesh, std::span<const VertexScalar> scalars, const VertexColours& colours,
                       const std::string& what);

/// A ZIP archive. A closed mesh is an object to print, an open one a surface; the unit is the millimetre.
std::string encode_3mf(const TriMesh& mesh);

// Decoders. They throw InputError; indices of the mesh they return are in range and coordinates finite.
TriMesh decode_ply(const MeshFile& file);
TriMesh decode_stl(const MeshFile& file);
TriMesh decode_obj(const MeshFile& file);
TriMesh decode_off(const MeshFile& file);

/// The levels of a binary glTF, see `read_lod_glb`.
std::vector<LodSurface> decode_lod_glb(const MeshFile& file);

/// Of a cloud.
inline constexpr std::size_t most_cloud_points = 100'000'000;

/// What a file tells of its vertices beside their places. Each list is empty or has one entry per vertex.
struct VertexData {
  std::vector<Vec3> normals;  // as in the file, of any length, also not finite
  std::vector<std::array<std::uint8_t, 3>> colours;
  std::vector<std::uint32_t> scans;  // the file's own numbers
  std::vector<Vec3> scanners;        // as in PointCloud, by these numbers, for all of them; or none
  std::string remark;                // what was left out on purpose; empty: nothing
  bool has_end = true;               // false: the last line has no end, it may be cut
  bool has_count = true;             // false: nothing in the file tells how much it should hold
};

// Decoders of clouds. They may return vertices without triangles and coordinates that are not finite, as scanners write
// them where they saw nothing; indices are in range. Throw InputError.
TriMesh decode_ply(const MeshFile& file, VertexData& data);
TriMesh decode_obj(const MeshFile& file, VertexData& data);
TriMesh decode_off(const MeshFile& file, VertexData& data);
TriMesh decode_las(const MeshFile& file, VertexData& data);
TriMesh decode_pcd(const MeshFile& file, VertexData& data);
TriMesh decode_ptx(const MeshFile& file, VertexData& data);
TriMesh decode_e57(const MeshFile& file, VertexData& data);
TriMesh decode_stl(const MeshFile& file, bool as_cloud);
/// Rows of numbers: XYZ, PTS, PWN, CSV. See `read_cloud` for the columns. With `normals_first` the columns after the
/// coordinates are normals of any length.
TriMesh decode_rows(const MeshFile& file, VertexData& data, bool normals_first);

/// One file of `read_cloud`, told by the ending of its name. Scans have the file's own numbers.
PointCloud decode_cloud(const MeshFile& file, CloudSource& source, Notes& notes);

/// A colour of a file, 0 to `full`, as a byte. Precondition: it is in this range.
inline std::uint8_t colour_byte(double value, double full) {
  return static_cast<std::uint8_t>(std::lround(value / full * 255));
}

/// Throws InputError unless the mesh has triangles, indices in range and finite vertices, or OptionError when a scalar
/// does not fit the mesh or its name is not a plain word. `what` names the output.
void check_writable(const TriMesh& mesh, std::span<const VertexScalar> scalars, const std::string& what);

/// Throws OptionError unless there is a colour for each vertex, or none.
void check_colours(const TriMesh& mesh, const VertexColours& colours, const std::string& what);

/// Unit normals of the vertices, pointing outwards: the area-weighted mean of the triangles around each. Where there is
/// none (no triangle, or all flat) +z stands in, because glTF allows no normal of another length than 1.
std::vector<Eigen::Vector3f> normals_to_write(const TriMesh& mesh);

/// Cuts a face of three or more corners into a fan of triangles around its first corner.
void add_fan(TriMesh& mesh, std::span<const std::uint32_t> corners);

}  // namespace dynasurf::io::detail
