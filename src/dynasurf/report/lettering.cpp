#include "dynasurf/report/detail/lettering.hpp"

#include <cctype>
#include <string>

namespace dynasurf::report {
namespace {

struct Glyph {
  char letter;
  int rows;  // five octal digits from the top, three bits each
};
constexpr Glyph glyphs[] = {{'0', 075557}, {'1', 026227}, {'2', 071747}, {'3', 071717}, {'4', 055711}, {'5', 074717},
                            {'6', 074757}, {'7', 071111}, {'8', 075757}, {'9', 075717}, {'A', 025755}, {'B', 065656},
                            {'C', 034443}, {'D', 065556}, {'E', 074647}, {'F', 074644}, {'G', 034553}, {'H', 055755},
                            {'I', 072227}, {'J', 011152}, {'K', 055655}, {'L', 044447}, {'M', 057755}, {'N', 065555},
                            {'O', 025552}, {'P', 065644}, {'Q', 025573}, {'R', 065655}, {'S', 034216}, {'T', 072222},
                            {'U', 055557}, {'V', 055552}, {'W', 055775}, {'X', 055255}, {'Y', 055222}, {'Z', 071247},
                            {'.', 000002}, {',', 000024}, {':', 002020}, {'-', 000700}, {'+', 002720}, {'=', 007070},
                            {'/', 011244}, {'%', 051245}, {'(', 012221}, {')', 042224}, {'_', 000007}};

int rows_of(char c) {
  const char capital = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const Glyph& g : glyphs)
    if (g.letter == capital) return g.rows;
  return 0;
}

}  // namespace

void draw_text(io::Picture& picture, std::string_view text, int x, int y, io::Colour colour) {
  if (y < 0 || y + letter_height > picture.height) return;
  for (const char c : text) {
    if (x < 0 || x + letter_width > picture.width) return;
    const int bits = rows_of(c);
    for (int n = 0; n < 15; ++n)
      if (bits >> (14 - n) & 1)
        for (int a = 0; a < 4; ++a) picture(x + n % 3 * 2 + a % 2, y + n / 3 * 2 + a / 2) = colour;
    x += letter_width;
  }
}

}  // namespace dynasurf::report
