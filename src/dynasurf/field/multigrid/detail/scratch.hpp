#pragma once
#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf::field::multigrid {

/// Memory for a few rows, kept by the thread.
inline float* scratch(std::size_t count) {
  thread_local detail::FloatBuffer buffer;
  if (buffer.size() < count) buffer = detail::FloatBuffer(count);
  return buffer.data();
}

}  // namespace dynasurf::field::multigrid
