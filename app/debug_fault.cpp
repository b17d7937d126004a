#include "debug_fault.hpp"

#include <csignal>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <unistd.h>

namespace dynasurf::app {
namespace {

[[noreturn]] void take_all_memory() {
  constexpr std::size_t piece = std::size_t{16} << 20;
  for (std::vector<std::vector<char>> taken;;) taken.emplace_back(piece, 'x');
}

}  // namespace

void cause_debug_fault() {
  const char* value = std::getenv("DYNASURF_DEBUG_FAULT");
  if (!value) return;
  const std::string_view fault = value;
  if (fault == "hang") {
    std::signal(SIGTERM, SIG_IGN);  // what hangs does not answer
    while (true) ::pause();
  }
  if (fault == "memory") take_all_memory();
  if (fault == "crash") std::raise(SIGSEGV);
  if (fault == "kill") std::raise(SIGKILL);
}

std::string debug_fault_of(const std::string& id) {
  const char* value = std::getenv("DYNASURF_DEBUG_FAULTS");
  std::string_view list = value ? value : "";
  while (!list.empty()) {
    const std::string_view entry = list.substr(0, list.find(','));
    if (const std::size_t sign = entry.find('='); sign != std::string_view::npos && entry.substr(0, sign) == id)
      return "DYNASURF_DEBUG_FAULT=" + std::string(entry.substr(sign + 1));
    list.remove_prefix(std::min(list.size(), entry.size() + 1));
  }
  return {};
}

}  // namespace dynasurf::app
