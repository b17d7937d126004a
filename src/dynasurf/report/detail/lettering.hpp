#pragma once
#include <string_view>

#include "dynasurf/io/png.hpp"

namespace dynasurf::report {

inline constexpr int letter_width = 8, letter_height = 10;  // of a letter with the gap after it, pixels

/// Writes into a picture in capitals, its upper left corner at (x, y). Letters that would leave the picture are left
/// out; a character without a shape of its own becomes a gap.
void draw_text(io::Picture& picture, std::string_view text, int x, int y, io::Colour colour);

}  // namespace dynasurf::report
