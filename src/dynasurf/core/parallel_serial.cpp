// For machines with one thread: takes the place of parallel_tbb.cpp with DYNASURF_WITH_THREADS=OFF.
#include "dynasurf/core/detail/run_pieces.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf {

void detail::run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  for (std::size_t p = 0; p < pieces; ++p) piece(p);
}

void parallel_for_files(std::size_t count, const std::function<void(std::size_t)>& body) {
  detail::run_noted_pieces(count, body);
}

struct ThreadLimit::State {};

ThreadLimit::ThreadLimit(int) {}
ThreadLimit::~ThreadLimit() = default;

}  // namespace dynasurf
