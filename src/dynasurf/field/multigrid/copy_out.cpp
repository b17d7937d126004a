#include <algorithm>
#include <array>
#include <cstdint>

#include "dynasurf/field/multigrid/detail/view.hpp"

namespace dynasurf::field::multigrid {

namespace {

template <class V, bool past_caches>
DYNASURF_INLINE void copy_row(const float* even, const float* odd, int count, float* out) {
  const auto put = [](V a, V b, float* to) DYNASURF_INLINE_LAMBDA {
    V first, second;
    join(a, b, first, second);
    past_caches ? stream(to, first) : store(to, first);
    past_caches ? stream(to + lanes, second) : store(to + lanes, second);
  };
  int i = 0;
  for (; i + 2 * lanes <= count; i += 2 * lanes) put(load<V>(even + i / 2), load<V>(odd + i / 2), out + i);
  if (i == count) return;
  if (i > 0) {  // the last whole vectors overlap those before
    i = count - 2 * lanes;
    i % 2 == 0 ? put(load<V>(even + i / 2), load<V>(odd + i / 2), out + i)
               : put(load<V>(odd + i / 2), load<V>(even + i / 2 + 1), out + i);
    return;
  }
  float rest[2 * lanes];
  V first, second;
  join(load<V>(even), load<V>(odd), first, second);
  store(rest, first);
  store(rest + lanes, second);
  std::copy_n(rest, count, out);
}

template <class V, bool past_caches>
DYNASURF_INLINE void copy_rows(const View& v, int k, int j0, int j1, const std::array<float*, 3>& out) {
  for (int j = j0; j < j1; ++j)
    for (int c = 0; c < 3; ++c) {
      const float* even = v.u + v.row(j, k) + 2 * c * v.slot;
      copy_row<V, past_caches>(even, even + v.slot, v.nx, out[c] + v.row_number(j, k) * v.nx);
    }
}

}  // namespace

void copy_out(const Level& l, int k, int j0, int j1, std::array<float*, 3> out) {
  constexpr std::size_t too_large_for_caches = 1'000'000;
  const bool aligned = l.nx() % 4 == 0 && std::all_of(out.begin(), out.end(), [](const float* p) {
                         return reinterpret_cast<std::uintptr_t>(p) % 16 == 0;
                       });
  const bool past_caches = l.cells() >= too_large_for_caches && aligned;
  detail::with_native_vectors([&]<int native>() DYNASURF_INLINE_LAMBDA {
    past_caches ? copy_rows<Floats<native>, true>(View(l), k, j0, j1, out)
                : copy_rows<Floats<native>, false>(View(l), k, j0, j1, out);
  });
#if defined(__SSE2__)
  if (past_caches) _mm_sfence();  // other threads see it
#endif
}

}  // namespace dynasurf::field::multigrid
