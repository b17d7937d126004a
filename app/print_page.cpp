#include "print_page.hpp"

#include <cctype>
#include <chrono>
#include <cstdlib>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/atomic_file.hpp"
#include "dynasurf/io/byte_source.hpp"

extern char** environ;

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

constexpr auto patience = std::chrono::seconds(120);

/// A folder of its own for the browser's settings, which it would else look for at home.
class Profile {
 public:
  Profile() {
    std::string name = (fs::temp_directory_path() / "dynasurf-print-XXXXXX").string();
    if (!mkdtemp(name.data())) throw IoError("cannot make a folder in " + fs::temp_directory_path().string());
    path_ = name;
  }
  ~Profile() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Profile(const Profile&) = delete;
  Profile& operator=(const Profile&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

/// Runs a program silently, in a group of its own. Returns its exit code; -1 when it had to be stopped.
int run_quietly(const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  for (const int stream : {0, 1, 2}) posix_spawn_file_actions_addopen(&files, stream, "/dev/null", O_RDWR, 0);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t child = 0;
  const int failed = posix_spawn(&child, words[0].c_str(), &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (failed != 0) throw IoError("cannot start " + words[0]);

  const auto end = std::chrono::steady_clock::now() + patience;
  int status = 0;
  while (waitpid(child, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > end) {
      kill(-child, SIGKILL);
      waitpid(child, &status, 0);
      return -1;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

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

/// A path as it stands in an address.
std::string address_of(const fs::path& path) {
  constexpr char digits[] = "0123456789ABCDEF";
  std::string address = "file://";
  for (const char c : fs::absolute(path).string()) {
    const auto byte = static_cast<unsigned char>(c);
    if (std::isalnum(byte) || std::string("/-_.~").find(c) != std::string::npos)
      address += c;
    else
      (address += '%') += digits[byte >> 4], address += digits[byte & 15u];
  }
  return address;
}

}  // namespace

fs::path find_browser() {
  const char* path = std::getenv("PATH");
  for (const char* name : {"chromium", "chromium-browser", "google-chrome"}) {
    std::istringstream folders(path ? path : "");
    for (std::string folder; std::getline(folders, folder, ':');)
      if (const fs::path file = fs::path(folder) / name; access(file.c_str(), X_OK) == 0) return file;
  }
  throw IoError("printing needs Chromium, and PATH holds none (on Debian: apt-get install chromium)");
}

void print_page(const fs::path& html, const fs::path& pdf, PageKind kind) {
  const Profile profile;
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
  words.push_back(address_of(html) + "#print");
  for (int attempt = 0; attempt < 3; ++attempt) {
    const int code = run_quietly(words);
    if (code != 0 || !fs::exists(printed) || fs::file_size(printed) == 0)
      throw IoError(pdf.string() + ": " + words[0] + (code < 0 ? " did not finish" : " could not print the report"));
    std::string bytes = text_of_file(printed);
    if (kind == PageKind::drawn && !is_complete(bytes)) continue;
    take_dates_out(bytes);
    return write_file(pdf, bytes);
  }
  throw IoError(pdf.string() + ": " + words[0] + " printed the report before it was drawn, three times");
}

}  // namespace dynasurf::app
