#include "cloud_names.hpp"

#include <algorithm>
#include <string>

#include "dynasurf/core/detail/letters.hpp"

namespace dynasurf::app {

bool ends_as_one_of(const std::filesystem::path& file, std::initializer_list<std::string_view> endings) {
  const std::string ending = small_letters(file.extension().string());
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

bool is_cloud(const std::filesystem::path& file) {
  return ends_as_one_of(
      file, {".ply", ".xyz", ".asc", ".pts", ".pwn", ".obj", ".off", ".las", ".laz", ".pcd", ".ptx", ".e57", ".stl"});
}

}  // namespace dynasurf::app
