#pragma once
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <memory>
#include <new>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace dynasurf::field::detail {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define DYNASURF_SANITIZED 1
#else
#define DYNASURF_SANITIZED 0
#endif
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define DYNASURF_SANITIZED_BY_CLANG
#endif
#endif
#if defined(__x86_64__) && defined(__GNUC__) && !DYNASURF_SANITIZED && !defined(DYNASURF_SANITIZED_BY_CLANG)
#define DYNASURF_SEVERAL_INSTRUCTION_SETS 1
#else
#define DYNASURF_SEVERAL_INSTRUCTION_SETS 0
#endif

// A function marked so is compiled for several instruction sets and the best one is chosen when the program starts.
// Contraction is off and no loop reorders a sum, so every copy returns the same bytes. Sanitizers cannot run the
// chooser (it is called before they are ready), so they get the plain copy; so does clang, which inlines no function
// with vectors into such copies.
#if DYNASURF_SEVERAL_INSTRUCTION_SETS && !defined(__clang__)
#define DYNASURF_CLONES __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define DYNASURF_CLONES
#endif
#define DYNASURF_INLINE inline __attribute__((always_inline))
#define DYNASURF_INLINE_LAMBDA __attribute__((always_inline))

#if DYNASURF_SEVERAL_INSTRUCTION_SETS
template <class Body>
__attribute__((target("avx512f"))) void with_avx512(const Body& body) {
  body.template operator()<16>();
}
template <class Body>
__attribute__((target("avx2"))) void with_avx2(const Body& body) {
  body.template operator()<8>();
}
#endif

/// The widest vectors to compute with, in floats. All give the same bytes: tests narrow them.
inline std::atomic<int> widest_vectors = 16;

/// Calls `body.operator()<n>()`, compiled for the best instruction set of the machine, whose vectors hold n floats. The
/// body is an inlined lambda, and inlines what it calls.
template <class Body>
void with_native_vectors(const Body& body) {
#if DYNASURF_SEVERAL_INSTRUCTION_SETS
  const int widest = widest_vectors.load(std::memory_order_relaxed);
  if (widest >= 16 && __builtin_cpu_supports("avx512f")) return with_avx512(body);
  if (widest >= 8 && __builtin_cpu_supports("avx2")) return with_avx2(body);
#endif
  constexpr int plain = DYNASURF_SANITIZED ? 16 : 4;  // wide ones are less code to instrument: minutes to compile
  body.template operator()<plain>();
}

/// Floats that start on a cache line. Fresh memory is not cleared.
class FloatBuffer {
 public:
  FloatBuffer() = default;
  explicit FloatBuffer(std::size_t count) : size_(count) {
    const std::size_t bytes = (count * sizeof(float) + 63) / 64 * 64;
    data_.reset(static_cast<float*>(std::aligned_alloc(64, bytes > 0 ? bytes : 64)));
    if (!data_) throw std::bad_alloc();
  }
  float* data() const { return data_.get(); }
  std::size_t size() const { return size_; }

 private:
  struct Free {
    void operator()(float* p) const { std::free(p); }
  };
  std::unique_ptr<float[], Free> data_;
  std::size_t size_ = 0;
};

/// While it lives, this thread treats numbers below the normal range as zero. The rim of a spreading field is full of
/// them, and the processor is many times slower on each.
class FlushDenormals {
 public:
#if defined(__SSE2__)
  FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(saved_); }

 private:
  unsigned saved_;
#elif defined(__aarch64__)
  FlushDenormals() {
    __asm__ volatile("mrs %0, fpcr" : "=r"(saved_));
    __asm__ volatile("msr fpcr, %0" : : "r"(saved_ | (1UL << 24U)));
  }
  ~FlushDenormals() { __asm__ volatile("msr fpcr, %0" : : "r"(saved_)); }

 private:
  unsigned long saved_;
#else
  FlushDenormals() {}  // they stay, and with them other bytes than elsewhere
#endif
 public:
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;
};

}  // namespace dynasurf::field::detail
