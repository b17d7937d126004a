#include <array>

#include "targets/meshes.hpp"

/// The first byte chooses the ending of the file's name, the rest is the file.
bool dynasurf::fuzz::run_rows(std::string_view bytes) {
  constexpr std::array<const char*, 4> names{"a.xyz", "a.csv", "a.pts", "a.pwn"};
  if (bytes.empty()) return false;
  const io::detail::MeshFile file{names[static_cast<unsigned char>(bytes[0]) % names.size()], bytes.substr(1)};
  return reads(file.name, [&] {
    io::CloudSource source;
    Notes notes;
    const PointCloud cloud = io::detail::decode_cloud(file, source, notes);
    for (const std::size_t size : {cloud.normals.size(), cloud.colours.size(), cloud.scans.size()})
      require(size == 0 || size == cloud.points.size(), "each list is empty or has one entry per point");
  });
}
