// What takes the place of interrupt.cpp, child_process.cpp, print_page.cpp, kept_stages.cpp and view.cpp where the
// program is alone: no system sends it signals, and there are no other programs. Whoever started it calls it again for
// every run, and ends it.
#include "dynasurf/core/error.hpp"

#include "child_process.hpp"
#include "command.hpp"
#include "interrupt.hpp"
#include "kept_stages.hpp"
#include "print_page.hpp"

namespace dynasurf::app {

Interrupt::Interrupt() = default;
Interrupt::~Interrupt() = default;

void add_view(CLI::App&, Command&) {}

bool is_taken_back() { return false; }
std::string words_of_stop() { return "stopped on request; nothing was written"; }

std::filesystem::path find_browser() {
  throw IoError("this build of the program starts no other: print the report from the browser that shows it");
}

void print_page(const std::filesystem::path&, const std::filesystem::path&, const std::stop_token&, PageKind) {
  find_browser();
}

ventricle::StageCache* kept_stages(const Study& study) {
  constexpr std::size_t most_voxels = 1 << 22;
  static ventricle::StageCache cache;
  if (study.gates.size() * study.grid().size() <= most_voxels) return &cache;
  cache = {};
  return nullptr;
}

cloud::StageCache* kept_stages(const PointCloud& cloud) {
  constexpr std::size_t most_points = 1 << 20;
  static cloud::StageCache cache;
  if (cloud.points.size() <= most_points) return &cache;
  cache = {};
  return nullptr;
}

}  // namespace dynasurf::app
