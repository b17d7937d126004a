#pragma once
#include <bit>
#include <cstdint>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "dynasurf/core/detail/simd.hpp"

namespace dynasurf::simd {

// Every function that takes or returns lanes is inlined, so that no calling convention is touched.
#pragma GCC diagnostic ignored "-Wpsabi"

/// Floats that loops take at a time: as many on every machine, so that sums have one order.
constexpr int lanes = 16;

/// As many values as one vector of the machine holds.
template <class T, int count>
struct NativeVector;
template <int count>
struct NativeVector<float, count> {
  typedef float Type __attribute__((vector_size(count * sizeof(float))));
};
template <int count>
struct NativeVector<double, count> {
  typedef double Type __attribute__((vector_size(count * sizeof(double))));
};
template <int count>
struct NativeVector<std::int32_t, count> {
  typedef std::int32_t Type __attribute__((vector_size(count * sizeof(std::int32_t))));
};

/// `count` values in vectors of `native` ones, those that the machine computes with: the compiler itself splits wider
/// ones through memory, and moves and compares them one by one.
template <class T, int count_, int native>
struct Pack {
  static constexpr int count = count_, native_count = native;
  using Half = Pack<T, count / 2, native>;
  Half low, high;

  Pack() = default;
  DYNASURF_INLINE Pack(T all) : low(all), high(all) {}
  DYNASURF_INLINE Pack(Half l, Half h) : low(l), high(h) {}

  DYNASURF_INLINE friend Pack operator+(Pack a, Pack b) { return {a.low + b.low, a.high + b.high}; }
  DYNASURF_INLINE friend Pack operator-(Pack a, Pack b) { return {a.low - b.low, a.high - b.high}; }
  DYNASURF_INLINE friend Pack operator*(Pack a, Pack b) { return {a.low * b.low, a.high * b.high}; }
  DYNASURF_INLINE friend Pack operator/(Pack a, Pack b) { return {a.low / b.low, a.high / b.high}; }
  DYNASURF_INLINE friend Pack operator-(Pack a) { return {-a.low, -a.high}; }
  DYNASURF_INLINE friend Pack operator^(Pack a, Pack b) { return {a.low ^ b.low, a.high ^ b.high}; }
  DYNASURF_INLINE friend Pack operator|(Pack a, Pack b) { return {a.low | b.low, a.high | b.high}; }
  DYNASURF_INLINE friend Pack operator&(Pack a, Pack b) { return {a.low & b.low, a.high & b.high}; }
};

template <class T, int native>
struct Pack<T, native, native> {
  static constexpr int count = native, native_count = native;
  using Native = typename NativeVector<T, native>::Type;
  Native v;

  Pack() = default;
  DYNASURF_INLINE Pack(T all) : v(Native{} + all) {}
  DYNASURF_INLINE Pack(Native n) : v(n) {}

  DYNASURF_INLINE friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
  DYNASURF_INLINE friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
  DYNASURF_INLINE friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
  DYNASURF_INLINE friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
  DYNASURF_INLINE friend Pack operator-(Pack a) { return -a.v; }
  DYNASURF_INLINE friend Pack operator^(Pack a, Pack b) { return a.v ^ b.v; }
  DYNASURF_INLINE friend Pack operator|(Pack a, Pack b) { return a.v | b.v; }
  DYNASURF_INLINE friend Pack operator&(Pack a, Pack b) { return a.v & b.v; }
};

template <class T, int count, int native>
DYNASURF_INLINE void operator+=(Pack<T, count, native>& a, Pack<T, count, native> b) {
  a = a + b;
}
template <class T, int count, int native>
DYNASURF_INLINE void operator*=(Pack<T, count, native>& a, Pack<T, count, native> b) {
  a = a * b;
}

/// Sixteen floats.
template <int native>
using Floats = Pack<float, lanes, native>;

/// Eight floats, for levels whose half rows hold no more.
template <int native>
using FewFloats = Pack<float, lanes / 2, (native < lanes / 2 ? native : lanes / 2)>;

/// Vectors of T like those of V.
template <class T, class V>
struct Like;
template <class T, class U, int count, int native>
struct Like<T, Pack<U, count, native>> {
  using Type = Pack<T, count, native>;
};
/// As many integers as V has floats.
template <class V>
using Ints = typename Like<std::int32_t, V>::Type;

// ---- Memory, of any alignment.

/// As many values as `v` holds, from `p` on.
template <class T, int native>
DYNASURF_INLINE void load_to(Pack<T, native, native>& v, const T* p) {
  __builtin_memcpy(&v.v, p, sizeof v.v);
}
template <class T, int count, int native>
DYNASURF_INLINE void load_to(Pack<T, count, native>& v, const T* p) {
  load_to(v.low, p);
  load_to(v.high, p + count / 2);
}
/// The same, returned.
template <class V, class T>
DYNASURF_INLINE V load(const T* p) {
  V v;
  load_to(v, p);
  return v;
}

template <class T, int native>
DYNASURF_INLINE void store(T* p, Pack<T, native, native> v) {
  __builtin_memcpy(p, &v.v, sizeof v.v);
}
template <class T, int count, int native>
DYNASURF_INLINE void store(T* p, Pack<T, count, native> v) {
  store(p, v.low);
  store(p + count / 2, v.high);
}

/// Past the caches; `p` starts at a multiple of 16 bytes.
template <int native>
DYNASURF_INLINE void stream(float* p, Pack<float, native, native> v) {
#if defined(__SSE2__)
  if constexpr (native >= 4) _mm_stream_ps(p, __builtin_shufflevector(v.v, v.v, 0, 1, 2, 3));
  if constexpr (native >= 8) _mm_stream_ps(p + 4, __builtin_shufflevector(v.v, v.v, 4, 5, 6, 7));
  if constexpr (native >= 16) {
    _mm_stream_ps(p + 8, __builtin_shufflevector(v.v, v.v, 8, 9, 10, 11));
    _mm_stream_ps(p + 12, __builtin_shufflevector(v.v, v.v, 12, 13, 14, 15));
  }
#else
  store(p, v);
#endif
}
template <int count, int native>
DYNASURF_INLINE void stream(float* p, Pack<float, count, native> v) {
  stream(p, v.low);
  stream(p + count / 2, v.high);
}

// ---- Choices, lane by lane.

/// x where a > b, else y.
template <class T, class U, int native>
DYNASURF_INLINE Pack<U, native, native> where_greater(Pack<T, native, native> a, Pack<T, native, native> b,
                                                      Pack<U, native, native> x, Pack<U, native, native> y) {
  return a.v > b.v ? x.v : y.v;
}
template <class T, class U, int count, int native>
DYNASURF_INLINE Pack<U, count, native> where_greater(Pack<T, count, native> a, Pack<T, count, native> b,
                                                     Pack<U, count, native> x, Pack<U, count, native> y) {
  return {where_greater(a.low, b.low, x.low, y.low), where_greater(a.high, b.high, x.high, y.high)};
}

/// x where a == b, else y.
template <int native>
DYNASURF_INLINE Pack<float, native, native> where_equal(Pack<float, native, native> a, Pack<float, native, native> b,
                                                        Pack<float, native, native> x, Pack<float, native, native> y) {
  return a.v == b.v ? x.v : y.v;
}
template <int count, int native>
DYNASURF_INLINE Pack<float, count, native> where_equal(Pack<float, count, native> a, Pack<float, count, native> b,
                                                       Pack<float, count, native> x, Pack<float, count, native> y) {
  return {where_equal(a.low, b.low, x.low, y.low), where_equal(a.high, b.high, x.high, y.high)};
}

/// The larger one.
template <class V>
DYNASURF_INLINE V larger(V a, V b) {
  return where_greater(a, b, a, b);
}

// ---- Lanes that change places.

/// Lane m holds m.
template <class V>
DYNASURF_INLINE V lane_numbers() {
  constexpr float numbers[lanes] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
  return load<V>(numbers);
}

template <int native>
DYNASURF_INLINE float first_lane(Pack<float, native, native> v) {
  return v.v[0];
}
template <int count, int native>
DYNASURF_INLINE float first_lane(Pack<float, count, native> v) {
  return first_lane(v.low);
}

/// Lane m holds lane m-1 of `v`; the first one is the last of `before`.
template <int native>
DYNASURF_INLINE Pack<float, native, native> shifted_up(Pack<float, native, native> before,
                                                       Pack<float, native, native> v) {
  if constexpr (native == 16)
    return __builtin_shufflevector(before.v, v.v, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25, 26, 27, 28, 29, 30);
  else if constexpr (native == 8)
    return __builtin_shufflevector(before.v, v.v, 7, 8, 9, 10, 11, 12, 13, 14);
  else
    return __builtin_shufflevector(before.v, v.v, 3, 4, 5, 6);
}
template <int count, int native>
DYNASURF_INLINE Pack<float, count, native> shifted_up(Pack<float, count, native> before, Pack<float, count, native> v) {
  return {shifted_up(before.high, v.low), shifted_up(v.low, v.high)};
}

/// Lane m holds lane m+1 of `v`; the last one is the first of `after`.
template <int native>
DYNASURF_INLINE Pack<float, native, native> shifted_down(Pack<float, native, native> v,
                                                         Pack<float, native, native> after) {
  if constexpr (native == 16)
    return __builtin_shufflevector(v.v, after.v, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16);
  else if constexpr (native == 8)
    return __builtin_shufflevector(v.v, after.v, 1, 2, 3, 4, 5, 6, 7, 8);
  else
    return __builtin_shufflevector(v.v, after.v, 1, 2, 3, 4);
}
template <int count, int native>
DYNASURF_INLINE Pack<float, count, native> shifted_down(Pack<float, count, native> v,
                                                        Pack<float, count, native> after) {
  return {shifted_down(v.low, v.high), shifted_down(v.high, after.low)};
}

/// Even and odd lanes of two times as many floats.
template <int native>
DYNASURF_INLINE void split(Pack<float, native, native> a, Pack<float, native, native> b,
                           Pack<float, native, native>& even, Pack<float, native, native>& odd) {
  if constexpr (native == 16) {
    even.v = __builtin_shufflevector(a.v, b.v, 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30);
    odd.v = __builtin_shufflevector(a.v, b.v, 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
  } else if constexpr (native == 8) {
    even.v = __builtin_shufflevector(a.v, b.v, 0, 2, 4, 6, 8, 10, 12, 14);
    odd.v = __builtin_shufflevector(a.v, b.v, 1, 3, 5, 7, 9, 11, 13, 15);
  } else {
    even.v = __builtin_shufflevector(a.v, b.v, 0, 2, 4, 6);
    odd.v = __builtin_shufflevector(a.v, b.v, 1, 3, 5, 7);
  }
}
template <int count, int native>
DYNASURF_INLINE void split(Pack<float, count, native> a, Pack<float, count, native> b, Pack<float, count, native>& even,
                           Pack<float, count, native>& odd) {
  split(a.low, a.high, even.low, odd.low);
  split(b.low, b.high, even.high, odd.high);
}

/// Two times as many floats out of their even and odd lanes.
template <int native>
DYNASURF_INLINE void join(Pack<float, native, native> even, Pack<float, native, native> odd,
                          Pack<float, native, native>& first, Pack<float, native, native>& second) {
  const auto a = even.v, b = odd.v;
  if constexpr (native == 16) {
    first.v = __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    second.v = __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  } else if constexpr (native == 8) {
    first.v = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
    second.v = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
  } else {
    first.v = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    second.v = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  }
}
template <int count, int native>
DYNASURF_INLINE void join(Pack<float, count, native> even, Pack<float, count, native> odd,
                          Pack<float, count, native>& first, Pack<float, count, native>& second) {
  join(even.low, odd.low, first.low, first.high);
  join(even.high, odd.high, second.low, second.high);
}

// ---- Integers.

/// The bits of floats, as integers.
template <int native>
DYNASURF_INLINE Pack<std::int32_t, native, native> bits_of(Pack<float, native, native> v) {
  return std::bit_cast<typename Pack<std::int32_t, native, native>::Native>(v.v);
}
template <int count, int native>
DYNASURF_INLINE Pack<std::int32_t, count, native> bits_of(Pack<float, count, native> v) {
  return {bits_of(v.low), bits_of(v.high)};
}

/// Whether any bit of any lane is set.
template <int native>
DYNASURF_INLINE bool any(Pack<std::int32_t, native, native> p) {
  auto v = p.v;
  if constexpr (native == 16) {
    v |= __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15, 0, 1, 2, 3, 4, 5, 6, 7);
    v |= __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3, 12, 13, 14, 15, 8, 9, 10, 11);
  } else if constexpr (native == 8) {
    v |= __builtin_shufflevector(v, v, 4, 5, 6, 7, 0, 1, 2, 3);
  }
  return (v[0] | v[1] | v[2] | v[3]) != 0;
}
template <int count, int native>
DYNASURF_INLINE bool any(Pack<std::int32_t, count, native> v) {
  return any(v.low | v.high);
}

}  // namespace dynasurf::simd
