#include "dynasurf/image/intensity.hpp"

#include <algorithm>
#include <sstream>

#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

float largest(const Image& image) {
  return image.values.empty() ? 0.0F : *std::max_element(image.values.begin(), image.values.end());
}

}  // namespace

Image normalise(Image image, Notes& notes) {
  const float max = largest(image);
  if (!(max > 0)) {
    notes.push_back({Severity::warning, "normalise.empty",
                     "The volume has no value above zero (largest value " + std::to_string(max) +
                         "), so its values were left as they are."});
    return image;
  }
  for (float& v : image.values) v /= max;
  return image;
}

Image suppress_noise(Image image, double fraction) {
  if (!(fraction >= 0 && fraction <= 1)) {
    std::ostringstream text;
    text << "option noise_fraction is " << fraction << "; expected a number >= 0 and <= 1";
    throw OptionError(text.str());
  }
  if (fraction == 0) return image;
  const double threshold = fraction * largest(image);
  for (float& v : image.values)
    if (v < threshold) v = 0;
  return image;
}

}  // namespace dynasurf
