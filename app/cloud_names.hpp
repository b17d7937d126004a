#pragma once
#include <filesystem>
#include <initializer_list>
#include <string_view>

namespace dynasurf::app {

/// Whether the name of a file ends so, in upper or lower case.
bool ends_as_one_of(const std::filesystem::path& file, std::initializer_list<std::string_view> endings);

/// Whether a file's name ends as that of a point cloud or a surface.
bool is_cloud(const std::filesystem::path& file);

}  // namespace dynasurf::app
