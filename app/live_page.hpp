#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "dynasurf/report/program_page.hpp"

// The page that is the program (dynasurf.html), with studies and results inside.
namespace dynasurf::app {

/// Where dynasurf.html is installed beside this program, or where ./dev web makes it; empty: nowhere.
std::filesystem::path find_page();
/// The same. Throws IoError where it is nowhere.
std::filesystem::path installed_page();

/// The files of a result folder as the folder `name` of a page.
std::vector<report::PageFile> files_of_result(const std::filesystem::path& result, const std::string& name);

/// Writes `folder`/live.html: the page with the study and the result in `folder`, which it shows and can run again.
/// Throws IoError, InputError where they hold more than a page takes.
void write_live_page(const std::filesystem::path& page, const std::vector<std::filesystem::path>& study,
                     const std::filesystem::path& folder);

}  // namespace dynasurf::app
