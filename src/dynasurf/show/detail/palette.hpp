#pragma once
#include "dynasurf/io/detail/png.hpp"

namespace dynasurf::show {

// Colours that people who do not tell red from green tell apart (Okabe and Ito).
namespace ink_of {
inline constexpr io::Colour endo{0, 114, 178};  // the inner wall
inline constexpr io::Colour epi{213, 94, 0};    // the outer wall
inline constexpr io::Colour good{0, 158, 115};
inline constexpr io::Colour light{86, 180, 233};
inline constexpr io::Colour warm{230, 159, 0};
inline constexpr io::Colour pink{204, 121, 167};
inline constexpr io::Colour text{34, 34, 34};
inline constexpr io::Colour quiet{140, 140, 140};
inline constexpr io::Colour faint{224, 224, 224};
}  // namespace ink_of

/// The map viridis: dark violet at 0, yellow at 1, evenly brighter between, also in grey. Values outside are clamped.
io::Colour viridis(double value);
io::Colour grey(double value);
/// `colour` in the light of `brightness`, 0 (black) to 1.
io::Colour lit(const io::Colour& colour, double brightness);

}  // namespace dynasurf::show
