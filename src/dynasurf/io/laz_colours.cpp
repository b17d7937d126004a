#include "dynasurf/io/detail/laz_colours.hpp"

namespace dynasurf::io::detail {

LazColours::Colour LazColours::decode(RangeDecoder& decoder, const Colour& last) {
  const std::uint32_t changed = symbol_of(decoder, changed_, 128);
  const auto half_of = [](std::uint16_t colour, int half) { return half == 0 ? colour & 255 : colour >> 8; };
  std::array<std::array<int, 2>, 3> now;
  const auto read = [&](std::size_t colour, int half, int expected) {
    const std::size_t place = 2 * colour + static_cast<std::size_t>(half);
    int& value = now[colour][static_cast<std::size_t>(half)];
    value = half_of(last[colour], half);
    if ((changed >> place & 1) == 0) return;
    const int known = std::clamp(value + expected, 0, 255);
    value = (known + static_cast<int>(symbol_of(decoder, differences_[place], 256))) & 255;
  };
  const auto step = [&](std::size_t colour, int half) {
    return now[colour][static_cast<std::size_t>(half)] - half_of(last[colour], half);
  };
  for (const int half : {0, 1}) read(0, half, 0);
  now[1] = now[2] = now[0];
  if ((changed & 64) != 0)
    for (const int half : {0, 1}) {
      read(1, half, step(0, half));
      read(2, half, (step(0, half) + step(1, half)) / 2);
    }
  Colour colour;
  for (std::size_t c = 0; c < 3; ++c) colour[c] = static_cast<std::uint16_t>(now[c][0] | now[c][1] << 8);
  return colour;
}

}  // namespace dynasurf::io::detail
