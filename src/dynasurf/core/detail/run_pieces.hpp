#pragma once
#include <cstddef>
#include <functional>

namespace dynasurf::detail {

/// Calls `piece(p)` for each p in [0, pieces), in any order, from the threads that there are.
void run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece);

/// The same, noted in the trace that is there, if any.
void run_noted_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece);

}  // namespace dynasurf::detail
