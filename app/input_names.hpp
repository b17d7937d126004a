#pragma once
#include <filesystem>
#include <string>

namespace dynasurf::app {

/// "input-1.ply": file names often carry a person's name, so they are replaced by numbers; the hash identifies the
/// file. `position` counts from 0. The ending stays where it is one of a format that the program reads.
std::string neutral_name(const std::filesystem::path& file, std::size_t position);

}  // namespace dynasurf::app
