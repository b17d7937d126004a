#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dynasurf::report {

/// The page that is the program (dynasurf.html) with files inside: opened in a browser it reads them as if they had
/// been dropped on it, with `options_json` as those of a former run where it is not empty. The files stand in it as
/// they are, with all that they tell of a person. Throws InputError where the page has no place for files or these hold
/// more than 1 GiB, which no page takes, and IoError.
std::string page_with_files(std::string_view page, const std::vector<std::filesystem::path>& files,
                            const std::string& options_json = {});

}  // namespace dynasurf::report
