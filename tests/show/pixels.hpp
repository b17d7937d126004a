#pragma once
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include "dynasurf/show/detail/canvas.hpp"

namespace dynasurf::show {

/// The pixels of a drawing (one to a point) whose colour is near another.
struct Spot {
  int count = 0;
  int left = 1 << 30, right = -1, top = 1 << 30, bottom = -1;
  double x = 0, y = 0;  // centre
  double width() const { return right - left + 1; }
  double height() const { return bottom - top + 1; }
};

inline bool is_near(const io::Colour& a, const io::Colour& b, int within) {
  for (std::size_t c = 0; c < 3; ++c)
    if (std::abs(int{a[c]} - int{b[c]}) > within) return false;
  return true;
}

/// Inside `where`, or everywhere.
inline Spot spot_of(const io::Picture& picture, const io::Colour& colour, std::optional<Panel> where = {},
                    int within = 12) {
  Spot s;
  const Panel box = where.value_or(Panel{0, 0, double(picture.width), double(picture.height)});
  for (int y = std::max(0, int(box.y)); y < std::min<double>(picture.height, box.bottom()); ++y)
    for (int x = std::max(0, int(box.x)); x < std::min<double>(picture.width, box.right()); ++x) {
      if (!is_near(picture(x, y), colour, within)) continue;
      ++s.count;
      s.left = std::min(s.left, x), s.right = std::max(s.right, x);
      s.top = std::min(s.top, y), s.bottom = std::max(s.bottom, y);
      s.x += x, s.y += y;
    }
  if (s.count > 0) s.x /= s.count, s.y /= s.count;
  return s;
}

}  // namespace dynasurf::show
