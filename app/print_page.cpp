#include "print_page.hpp"

#include <chrono>
#include <cstdlib>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

#include "browser_profile.hpp"
#include "child_process.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

constexpr auto patience = std::chrono::seconds(120);

/// A busy machine may print the page before it has drawn itself; only then does its title, which the PDF takes over in
/// UTF-16 as hexadecimal digits, end with the word "printed".
bool is_complete(const std::string& pdf) { return pdf.find("007000720069006E007400650064>") != std::string::npos; }

/// Sets the dates that the browser writes to one and the same: equal pages shall be equal bytes.
void take_dates_out(std::string& pdf) {
  constexpr std::string_view same = "20000101000000";
  for (const std::string_view key : {"/CreationDate (D:", "/ModDate (D:"})
    if (const std::size_t at = pdf.find(key); at != std::string::npos && at + key.size() + same.size() < pdf.size())
      pdf.replace(at + key.size(), same.size(), same);
}

}  // namespace

fs::path find_browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    TextInput folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
      if (fs::path file = fs::path(folder) / name; access(file.c_str(), X_OK) == 0) return file;
  }
  throw IoError("printing needs Chromium, and PATH holds none (on Debian: apt-get install chromium)");
}

void print_page(const fs::path& html, const fs::path& pdf, const std::stop_token& stop, PageKind kind) {
  const BrowserProfile profile;
  const fs::path printed = profile.path() / "page.pdf";
  std::vector<std::string> words{find_browser().string(),
                                 "--headless",
                                 "--user-data-dir=" + profile.path().string(),
                                 "--no-first-run",
                                 "--disable-extensions",
                                 "--disable-background-networking",
                                 "--use-angle=swiftshader",
                                 "--enable-unsafe-swiftshader",
                                 "--no-pdf-header-footer",
                                 "--run-all-compositor-stages-before-draw",
                                 "--virtual-time-budget=20000",
                                 "--print-to-pdf=" + printed.string()};
  if (geteuid() == 0) words.push_back("--no-sandbox");  // it refuses to run as root otherwise
  words.push_back("file://" + address_of(fs::absolute(html).string()) + "#print");
  for (int attempt = 0; attempt < 3; ++attempt) {
    const std::optional<int> code = run_quietly(words, profile.path(), patience, stop);
    if (code != 0 || !fs::exists(printed) || fs::file_size(printed) == 0)
      throw IoError(pdf.string() + ": " + words[0] + (code ? " could not print the report" : " did not finish"));
    std::string bytes = io::text_of_file(printed);
    if (kind == PageKind::drawn && !is_complete(bytes)) continue;
    take_dates_out(bytes);
    return io::write_file(pdf, bytes);
  }
  throw IoError(pdf.string() + ": " + words[0] + " printed the report before it was drawn, three times");
}

}  // namespace dynasurf::app
