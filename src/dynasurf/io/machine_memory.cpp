#include "dynasurf/io/detail/machine_memory.hpp"

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>

#include <sys/resource.h>
#include <unistd.h>

namespace dynasurf::io {
namespace {

constexpr std::uint64_t unlimited = std::numeric_limits<std::uint64_t>::max();

/// The number in a small file; unlimited where there is none ("max").
std::uint64_t number_in(const std::string& path) {
  std::ifstream file(path);
  std::uint64_t value = 0;
  return file >> value ? value : unlimited;
}

/// The least limit on the way from a control group up to the root.
std::uint64_t least_above(const std::string& root, std::string group, const std::string& file) {
  std::uint64_t least = unlimited;
  while (true) {
    least = std::min(least, number_in(root + group + "/" + file));
    const auto slash = group.rfind('/');
    if (slash == std::string::npos) return least;
    group.resize(slash);
  }
}

/// What the control group of this process allows, in version 1 and 2 of that interface.
std::uint64_t control_group_limit() {
  std::uint64_t least = unlimited;
  std::ifstream groups("/proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':'), second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    std::string group = line.substr(second + 1);
    if (group == "/") group.clear();
    if (controllers.empty()) least = std::min(least, least_above("/sys/fs/cgroup", group, "memory.max"));
    if (controllers.find("memory") != std::string::npos)
      least = std::min(least, least_above("/sys/fs/cgroup/memory", group, "memory.limit_in_bytes"));
  }
  return least;
}

std::uint64_t machine_memory() {
  const long pages = ::sysconf(_SC_PHYS_PAGES), size = ::sysconf(_SC_PAGESIZE);
  return pages > 0 && size > 0 ? pages * static_cast<std::uint64_t>(size) : unlimited;
}

std::uint64_t address_space() {
  rlimit limit{};
  return ::getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY ? limit.rlim_cur : unlimited;
}

}  // namespace

std::uint64_t default_memory_limit() {
  static const std::uint64_t limit = [] {
    const std::uint64_t least = std::min({machine_memory(), control_group_limit(), address_space()});
    if (least != unlimited) return least / 2;
    // In WebAssembly: all of the address space but what the program itself takes.
    return sizeof(void*) == 4 ? (std::uint64_t{4} << 30) - (std::uint64_t{64} << 20) : std::uint64_t{1} << 30;
  }();
  return limit;
}

}  // namespace dynasurf::io
