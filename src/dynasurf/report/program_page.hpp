#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace dynasurf::report {

/// A file of the disk, and its path in a page.
struct PageFile {
  std::string name;  // "study.dcm", "result/report.html"
  std::filesystem::path file;
};

/// The page that is the program (dynasurf.html) with files inside: opened in a browser it reads them as if they had
/// been dropped on it: a study, a scan, a result with its study, options.json. The files stand in it as they are, with
/// all that they tell of a person. Throws InputError where the page has no place for files or these hold more than
/// 1 GiB, which no page takes, and IoError.
std::string page_with_files(std::string_view page, const std::vector<PageFile>& files);

}  // namespace dynasurf::report
