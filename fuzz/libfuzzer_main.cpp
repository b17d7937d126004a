// The way in for libFuzzer: one program per target, which DYNASURF_FUZZ_TARGET names.

#include <cstddef>
#include <cstdint>

#include "target.hpp"

extern "C" {

// NOLINTNEXTLINE(bugprone-reserved-identifier): the sanitizer asks for this name.
const char* __asan_default_options() {
  // Freed memory is kept apart for a while so that its use is seen. Files here are small, and so may that be; a large
  // one would only push everything out of the processor's caches. Who allocated is written down for each allocation; a
  // finding is run again with ASAN_OPTIONS=malloc_context_size=20 to learn that.
  // The linked-in C++ library has some of the operators new and delete, the sanitizer the others: their kinds do not
  // match, whoever calls them. The preset `asan` looks for those that do not match.
  return "quarantine_size_mb=2:alloc_dealloc_mismatch=0:malloc_context_size=0:detect_stack_use_after_return=0:"
         "allocator_may_return_null=0";
}

// NOLINTNEXTLINE(bugprone-reserved-identifier): as above.
const char* __ubsan_default_options() { return "print_stacktrace=1"; }

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // -1: an input that was refused may still be worth keeping, so both are kept.
  dynasurf::fuzz::DYNASURF_FUZZ_TARGET({reinterpret_cast<const char*>(data), size});
  return 0;
}
}
