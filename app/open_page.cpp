#include "open_page.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <spawn.h>
#include <unistd.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

#include "console.hpp"

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

/// Hands a page to the browser, which outlives this program. Whether there was a program to hand it to.
bool open_page(const fs::path& page) {
  std::string opener = "xdg-open", file = fs::absolute(page).string();
  const std::array<char*, 3> words{opener.data(), file.data(), nullptr};
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawnattr_init(&attributes);
  for (const int stream : {0, 1, 2}) ::posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_RDWR, 0);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSID);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, opener.c_str(), &actions, &attributes, words.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  ::posix_spawnattr_destroy(&attributes);
  return error == 0;
}

}  // namespace

fs::path temporary_page(const std::string& text) {
  std::string folder = (fs::temp_directory_path() / "dynasurf-view-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) throw IoError(folder + ": " + std::strerror(errno));
  fs::path page = fs::path(folder) / "study.html";
  try {
    io::write_file(page, text);
  } catch (...) {
    ::rmdir(folder.c_str());
    throw;
  }
  return page;
}

ExitCode show_page(const fs::path& page) {
  print((open_page(page) ? "opened in the browser: " : "open this page in a browser: ") + page.string() + "\n");
  return done;
}

}  // namespace dynasurf::app
