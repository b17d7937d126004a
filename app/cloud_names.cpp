#include "cloud_names.hpp"

#include <algorithm>
#include <cctype>
#include <string>

namespace dynasurf::app {

bool ends_as_one_of(const std::filesystem::path& file, std::initializer_list<std::string_view> endings) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

bool is_cloud(const std::filesystem::path& file) {
  return ends_as_one_of(file, {".ply", ".xyz", ".asc", ".pts", ".pwn", ".obj", ".off", ".las", ".pcd", ".ptx", ".stl"});
}

}  // namespace dynasurf::app
