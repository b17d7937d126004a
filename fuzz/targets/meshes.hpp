#pragma once
#include "dynasurf/io/detail/mesh_formats.hpp"

#include "target.hpp"

namespace dynasurf::fuzz {

/// What every decoder of a mesh promises.
inline void check_mesh(const TriMesh& mesh, bool finite) {
  for (const auto& triangle : mesh.triangles)
    for (const auto v : triangle) require(v < mesh.vertices.size(), "indices are in range");
  if (!finite) return;
  for (const Vec3& p : mesh.vertices) require(p.allFinite(), "coordinates are finite");
}

/// A decoder of surfaces, then the one of clouds of the same format.
inline bool decodes_both(std::string_view bytes, const char* name, TriMesh (*surface)(const io::detail::MeshFile&),
                         TriMesh (*cloud)(const io::detail::MeshFile&, io::detail::VertexData&)) {
  const io::detail::MeshFile file{name, bytes};
  const bool is_surface = reads(name, [&] { check_mesh(surface(file), true); });
  const bool is_cloud = reads(name, [&] {
    io::detail::VertexData data;
    const TriMesh mesh = cloud(file, data);
    check_mesh(mesh, false);
    for (const std::size_t size : {data.normals.size(), data.colours.size(), data.scans.size()})
      require(size == 0 || size == mesh.vertices.size(), "each list is empty or has one entry per vertex");
  });
  return is_surface || is_cloud;
}

}  // namespace dynasurf::fuzz
