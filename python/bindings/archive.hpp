#pragma once
#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf::python {

// Results as bytes, for pickle: every member in its order. Both ways go through the one `archive` of a type.

/// How many members a plain struct has. A number that is no longer right does not compile.
template <class T>
inline constexpr int arity = 0;

class Writer {
 public:
  static constexpr bool writes = true;
  void raw(const void* data, std::size_t bytes) { text_.append(static_cast<const char*>(data), bytes); }
  std::size_t count(std::size_t n) {
    raw(&n, sizeof n);
    return n;
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

class Reader {
 public:
  static constexpr bool writes = false;
  explicit Reader(std::string_view text) : text_(text) {}
  void raw(void* data, std::size_t bytes) {
    if (bytes > text_.size()) throw InputError("the pickled object is cut short");
    if (bytes > 0) std::memcpy(data, text_.data(), bytes);
    text_.remove_prefix(bytes);
  }
  std::size_t count(std::size_t) {
    std::size_t n = 0;
    raw(&n, sizeof n);
    if (n > text_.size()) throw InputError("the pickled object is cut short");  // nothing takes less than a byte
    return n;
  }
  bool is_at_end() const { return text_.empty(); }

 private:
  std::string_view text_;
};

/// References to the members of a plain struct.
template <class T>
auto members_of(T& s) {
#define DYNASURF_MEMBERS(n, ...)  \
  if constexpr (arity<T> == n) {  \
    auto& [__VA_ARGS__] = s;      \
    return std::tie(__VA_ARGS__); \
  } else
  DYNASURF_MEMBERS(2, a, b)
  DYNASURF_MEMBERS(3, a, b, c)
  DYNASURF_MEMBERS(4, a, b, c, d)
  DYNASURF_MEMBERS(5, a, b, c, d, e)
  DYNASURF_MEMBERS(6, a, b, c, d, e, f)
  DYNASURF_MEMBERS(7, a, b, c, d, e, f, g)
  DYNASURF_MEMBERS(8, a, b, c, d, e, f, g, h)
  DYNASURF_MEMBERS(9, a, b, c, d, e, f, g, h, i)
  DYNASURF_MEMBERS(10, a, b, c, d, e, f, g, h, i, j)
  DYNASURF_MEMBERS(11, a, b, c, d, e, f, g, h, i, j, k)
  DYNASURF_MEMBERS(12, a, b, c, d, e, f, g, h, i, j, k, l)
  DYNASURF_MEMBERS(13, a, b, c, d, e, f, g, h, i, j, k, l, m)
  DYNASURF_MEMBERS(14, a, b, c, d, e, f, g, h, i, j, k, l, m, o)
  DYNASURF_MEMBERS(16, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
  DYNASURF_MEMBERS(18, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r)
  DYNASURF_MEMBERS(19, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t)
  DYNASURF_MEMBERS(22, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w)
  DYNASURF_MEMBERS(25, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, t, u, v, w, x, y, z)
#undef DYNASURF_MEMBERS
  static_assert(arity<T> > 0, "archive.cpp does not give the number of members of this struct");
}

template <class A, class T>
void archive(A& a, T& value);

template <class T>
inline constexpr bool is_plain_bytes = std::is_arithmetic_v<T> || std::is_enum_v<T>;

template <class A, class T>
void archive(A& a, std::vector<T>& values) {
  const std::size_t n = a.count(values.size());
  if constexpr (!A::writes) values.resize(n);
  if constexpr (is_plain_bytes<T>) {
    a.raw(values.data(), n * sizeof(T));
  } else {
    for (T& value : values) archive(a, value);
  }
}
template <class A>
void archive(A& a, std::string& text) {
  const std::size_t n = a.count(text.size());
  if constexpr (!A::writes) text.resize(n);
  a.raw(text.data(), n);
}
template <class A, class T>
void archive(A& a, std::optional<T>& value) {
  bool is_there = value.has_value();
  a.raw(&is_there, 1);
  if constexpr (!A::writes)
    if (is_there) value.emplace();
  if (is_there) archive(a, *value);
}
template <class A, class T, std::size_t n>
void archive(A& a, std::array<T, n>& values) {
  for (T& value : values) archive(a, value);
}
template <class A, class X, class Y>
void archive(A& a, std::pair<X, Y>& both) {
  archive(a, both.first);
  archive(a, both.second);
}
template <class A, int rows, int columns>
void archive(A& a, Eigen::Matrix<double, rows, columns>& matrix) {
  a.raw(matrix.data(), sizeof(double) * rows * columns);
}
template <class A, class T>
void archive(A& a, Volume<T>& volume) {
  archive(a, volume.grid);
  archive(a, volume.values);
}

template <class A, class T>
void archive(A& a, T& value) {
  if constexpr (is_plain_bytes<T>) {
    a.raw(&value, sizeof value);
  } else {
    std::apply([&](auto&... members) { (archive(a, members), ...); }, members_of(value));
  }
}

}  // namespace dynasurf::python
