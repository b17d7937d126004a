#include "support/e57_writer.hpp"
#include "targets/meshes.hpp"

namespace dynasurf::fuzz {
namespace {

bool decodes(std::string_view bytes, const char* name,
             TriMesh (*cloud)(const io::detail::MeshFile&, io::detail::VertexData&)) {
  const io::detail::MeshFile file{name, bytes};
  return reads(file.name, [&] {
    io::detail::VertexData data;
    const TriMesh mesh = cloud(file, data);
    check_mesh(mesh, false);
    for (const std::size_t size : {data.normals.size(), data.colours.size(), data.scans.size()})
      require(size == 0 || size == mesh.vertices.size(), "each list is empty or has one entry per point");
  });
}

}  // namespace

bool run_pcd(std::string_view bytes) { return decodes(bytes, "a.pcd", io::detail::decode_pcd); }
bool run_ptx(std::string_view bytes) { return decodes(bytes, "a.ptx", io::detail::decode_ptx); }

/// The input is the content of the pages: no change of it would get past their checksums.
bool run_e57(std::string_view bytes) {
  decodes(bytes, "a.e57", io::detail::decode_e57);
  return decodes(test::e57_pages(std::string(bytes)), "a.e57", io::detail::decode_e57);
}

}  // namespace dynasurf::fuzz
