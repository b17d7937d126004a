#pragma once
#include <optional>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/volume.hpp"

namespace dynasurf {

/// Divides by the largest value of the volume (VOL-NORM, thesis 6.1): the maximum becomes exactly 1. Negative values
/// stay. A volume without a positive value is returned as it is, with a note "normalise.empty".
Image normalise(Image image, Notes& notes);

/// Sets values below `fraction` of the maximum to 0 (VOL-NOISE20, thesis 6.1.2.5); 0 keeps all. Throws OptionError
/// unless 0 <= fraction <= 1.
Image suppress_noise(Image image, double fraction);

}  // namespace dynasurf
