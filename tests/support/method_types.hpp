#pragma once
#include <string>
#include <variant>

#include <gtest/gtest.h>

namespace dynasurf::test {

/// A typed test suite of each method in a variant of option structs, named as users name the method:
/// `TYPED_TEST_SUITE(EdgeLaws, MethodTypes<EdgeOptions>::type, MethodName)`.
template <class Variant>
struct MethodTypes;
template <class... Options>
struct MethodTypes<std::variant<Options...>> {
  using type = testing::Types<Options...>;
};
struct MethodName {
  template <class Options>
  static std::string GetName(int) {
    return std::string(Options::name);
  }
};

}  // namespace dynasurf::test
