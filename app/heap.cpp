#include "heap.hpp"

#if defined(__GLIBC__)
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <thread>

#include <malloc.h>
#include <sys/mman.h>
#endif

namespace dynasurf::app {

void prepare_heap() {
#if defined(__GLIBC__)
  constexpr int kept_bytes = 256 << 20, largest_kept_bytes = 32 << 20;
  ::mallopt(M_TRIM_THRESHOLD, kept_bytes);
  ::mallopt(M_MMAP_THRESHOLD, largest_kept_bytes);
  // Each heap keeps what its own threads do not use.
  constexpr unsigned threads_a_heap = 4;
  ::mallopt(M_ARENA_MAX, std::max(1u, std::thread::hardware_concurrency() / threads_a_heap));
  // Most studies fit into this room. Pages of 4 KiB cost them half of the time that they spend in the system.
  constexpr std::size_t room = std::size_t{31} << 20, large_page = std::size_t{2} << 20;
  void* const first = std::malloc(room);
  void* const second = std::malloc(room);
  for (void* const part : {first, second}) {
    void* begin = part;
    std::size_t left = room;
    if (part && std::align(large_page, room - large_page, begin, left))
      ::madvise(begin, room - large_page, MADV_HUGEPAGE);
  }
  std::free(second);
  std::free(first);
#endif
}

}  // namespace dynasurf::app
