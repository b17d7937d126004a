#include "dynasurf/core/detail/memory_limit.hpp"

#include <atomic>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

std::atomic<std::uint64_t> chosen{std::numeric_limits<std::uint64_t>::max()};

}  // namespace

std::uint64_t memory_from_text(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  std::string_view unit = text.substr(end - text.data());
  if (unit.size() == 2 && (unit[1] == 'B' || unit[1] == 'b')) unit.remove_suffix(1);
  constexpr std::string_view units = "KMGT";
  double factor = unit.empty() ? 1 : 0;
  for (std::size_t n = 0; n < units.size(); ++n)
    if (unit.size() == 1 && (unit[0] == units[n] || unit[0] == units[n] + 'a' - 'A'))
      factor = std::ldexp(1, 10 * (n + 1));
  const double bytes = value * factor;
  if (error != std::errc{} || !(bytes >= 1 << 20) || !(bytes < std::ldexp(1, 62)))
    throw OptionError("--memory-limit: \"" + std::string(text.substr(0, 40)) +
                      "\"; expected an amount of memory such as 8G or 500M, at least 1M");
  return bytes;
}

std::string memory_text(std::uint64_t bytes) {
  const double mib = 1.0 * bytes / (1 << 20);
  char text[40];
  if (mib < 1000)
    std::snprintf(text, sizeof text, "%.0f MiB", std::ceil(mib));
  else
    std::snprintf(text, sizeof text, "%.1f GiB", mib / 1024);
  return text;
}

MemoryLimit::MemoryLimit(std::uint64_t bytes) : former_(chosen.exchange(bytes)) {}
MemoryLimit::~MemoryLimit() { chosen = former_; }

void require_memory(std::uint64_t bytes, const std::string& where, const std::string& what) {
  const std::uint64_t limit = chosen;
  if (bytes > limit)
    throw InputError(where + ": needs " + memory_text(bytes) + " of memory for " + what + "; the limit is " +
                     memory_text(limit) + " (--memory-limit)");
}

void require_room(std::size_t bytes) {
  const auto room = std::make_unique_for_overwrite<std::byte[]>(bytes);
  *static_cast<volatile std::byte*>(room.get()) = std::byte{};  // no compiler leaves out what is written
}

}  // namespace dynasurf
