#pragma once
#include <array>
#include <cstdint>

#include "dynasurf/io/detail/range_decoder.hpp"

namespace dynasurf::io::detail {

/// Three 16-bit colours, each half of each as the difference to the point before, green and blue as that to red.
class LazColours {
 public:
  using Colour = std::array<std::uint16_t, 3>;
  Colour decode(RangeDecoder& decoder, const Colour& last);

 private:
  SymbolModel changed_;
  std::array<SymbolModel, 6> differences_;  // per half: red, green, blue, the lower half of each first
};

}  // namespace dynasurf::io::detail
