#pragma once
#include <algorithm>
#include <cstdint>

namespace dynasurf {

/// One number for two vertices in their order, and for an edge, whose ends are the same both ways round.
constexpr std::uint64_t pair_key(std::uint32_t a, std::uint32_t b) { return std::uint64_t{a} << 32 | b; }
constexpr std::uint64_t edge_key(std::uint32_t a, std::uint32_t b) { return pair_key(std::min(a, b), std::max(a, b)); }

}  // namespace dynasurf
