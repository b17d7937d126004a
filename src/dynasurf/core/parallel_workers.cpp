// For WebAssembly: takes the place of parallel_tbb.cpp there. The page starts the threads and gives them their stacks
// (web/src/program/worker.ts); without them loops are serial.
#include <cstdlib>

#include "dynasurf/core/detail/run_pieces.hpp"
#include "dynasurf/core/detail/worker_team.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf {
namespace {
// Helpers may be there before anything else is.
constinit detail::WorkerTeam team;
}  // namespace

/// Memory for the stack of a thread of the page; null where there is none.
extern "C" [[gnu::used, clang::export_name("new_stack")]] void* dynasurf_new_stack(std::size_t bytes) {
  return std::malloc(bytes);
}

/// What such a thread does.
extern "C" [[gnu::used, clang::export_name("help")]] void dynasurf_help() { team.help(); }

void detail::run_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) { team.run(pieces, piece); }

// The thread of the program alone has its files.
void parallel_for_files(std::size_t count, const std::function<void(std::size_t)>& body) {
  for (std::size_t n = 0; n < count; ++n) body(n);
}

struct ThreadLimit::State {
  int before;
};

ThreadLimit::ThreadLimit(int threads) : state_(new State{team.limit(threads)}) {}
ThreadLimit::~ThreadLimit() { team.limit(state_->before); }

}  // namespace dynasurf
