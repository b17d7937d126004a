#pragma once
#include <filesystem>
#include <string_view>

namespace dynasurf::io {

/// Whether a name that a file tells can be the name of a file in the folder that it means: 1 to 200 bytes, no slash, no
/// control character, not "." or "..".
bool is_plain_file_name(std::string_view name);

/// The path of a file in a folder that may come from anybody, such as the result of another person; `file` is seen from
/// the folder. Nothing outside is named, neither by ".." nor by a link: throws InputError then. The file need not be
/// there.
std::filesystem::path file_inside(const std::filesystem::path& folder, const std::filesystem::path& file);

}  // namespace dynasurf::io
