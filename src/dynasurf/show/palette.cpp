#include "dynasurf/show/detail/palette.hpp"

#include <algorithm>
#include <array>

#include "dynasurf/core/detail/rounding.hpp"

namespace dynasurf::show {

io::Colour viridis(double value) {
  static constexpr std::array<io::Colour, 9> stops{{{68, 1, 84},
                                                    {71, 44, 122},
                                                    {59, 81, 139},
                                                    {44, 113, 142},
                                                    {33, 144, 141},
                                                    {39, 173, 129},
                                                    {92, 200, 99},
                                                    {170, 220, 50},
                                                    {253, 231, 37}}};
  const double at = (value > 0 ? std::min(value, 1.0) : 0) * (stops.size() - 1);
  const std::size_t low = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const double share = at - low;
  io::Colour mixed;
  for (std::size_t c = 0; c < 3; ++c) mixed[c] = byte_of((1 - share) * stops[low][c] + share * stops[low + 1][c]);
  return mixed;
}

io::Colour grey(double value) {
  const std::uint8_t v = byte_of(255 * value);
  return {v, v, v};
}

io::Colour lit(const io::Colour& colour, double brightness) {
  return {byte_of(colour[0] * brightness), byte_of(colour[1] * brightness), byte_of(colour[2] * brightness)};
}

}  // namespace dynasurf::show
