// What takes the place of interrupt.cpp, child_process.cpp, print_page.cpp and view.cpp where the program is alone: no
// system sends it signals, and there are no other programs. Whoever started it ends it.
#include "dynasurf/core/error.hpp"

#include "child_process.hpp"
#include "command.hpp"
#include "interrupt.hpp"
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

}  // namespace dynasurf::app
