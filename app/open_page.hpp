#pragma once
#include <filesystem>
#include <string>

#include "command.hpp"

namespace dynasurf::app {

/// Writes a page into a new temporary folder that only its owner can read. Throws IoError.
std::filesystem::path temporary_page(const std::string& text);

/// Opens a page in the browser, or tells which one to open.
ExitCode show_page(const std::filesystem::path& page);

}  // namespace dynasurf::app
