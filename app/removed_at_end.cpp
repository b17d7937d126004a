#include "removed_at_end.hpp"

#include <chrono>
#include <mutex>
#include <set>
#include <system_error>
#include <thread>

namespace dynasurf::app {
namespace {

namespace fs = std::filesystem;

struct Registry {
  std::mutex mutex;
  std::set<fs::path> paths;
};

/// Never destroyed: the watcher may ask for it until the very end.
Registry& registry() {
  static auto* const all = new Registry;
  return *all;
}

/// What another program writes there while it dies is removed, too, but nothing is waited for long.
void remove_soon(const fs::path& path) {
  constexpr int attempts = 20;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    std::error_code error;
    fs::remove_all(path, error);
    if (!error) return;
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

}  // namespace

RemovedAtEnd::RemovedAtEnd(const fs::path& path) : path_(path) {
  const std::lock_guard lock(registry().mutex);
  registry().paths.insert(path_);
}

RemovedAtEnd::~RemovedAtEnd() {
  remove_soon(path_);
  const std::lock_guard lock(registry().mutex);
  registry().paths.erase(path_);
}

void remove_what_goes_at_end() noexcept {
  const std::lock_guard lock(registry().mutex);
  for (const fs::path& path : registry().paths) remove_soon(path);
}

}  // namespace dynasurf::app
