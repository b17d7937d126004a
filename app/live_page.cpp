#include "live_page.hpp"

#include <algorithm>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* live_name = "live.html";

}  // namespace

fs::path find_page() {
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const char* place : {"../share/dynasurf/dynasurf.html", "../../web/dynasurf.html"})
    if (fs::is_regular_file(folder / place, error)) return (folder / place).lexically_normal();
  return {};
}

fs::path installed_page() {
  fs::path page = find_page();
  if (page.empty()) throw IoError("dynasurf.html is not installed beside this program (./dev web makes it)");
  return page;
}

std::vector<report::PageFile> files_of_result(const fs::path& result, const std::string& name) {
  std::vector<report::PageFile> files;
  for (const auto& entry : fs::recursive_directory_iterator(result))
    if (!entry.is_symlink() && entry.is_regular_file() && entry.path().filename() != live_name)
      files.push_back({(name / entry.path().lexically_relative(result)).generic_string(), entry.path()});
  std::sort(files.begin(), files.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return files;
}

void write_live_page(const fs::path& page, const std::vector<fs::path>& study, const fs::path& folder) {
  std::vector<report::PageFile> files = files_of_result(folder, "result");
  for (const fs::path& file : study) files.push_back({file.filename().string(), file});
  io::write_file(folder / live_name, report::page_with_files(io::text_of_file(page), files));
}

}  // namespace dynasurf::app
