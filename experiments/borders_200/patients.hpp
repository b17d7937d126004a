#pragma once
#include <cstdint>

#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf {

/// A virtual patient of the experiment and what was planted in it.
struct Patient {
  int number = 0;
  synthetic::VirtualPatient options;
  bool oblique = false;  // the slices do not cut square to the long axis; the file says so
  bool has_defect = false, has_gut = false;
};

/// The same number gives the same patient.
Patient draw_patient(int number);

/// The study as a file would bring it (views and slice order as a header has them), and its truth.
synthetic::Phantom scan(const Patient& patient);

}  // namespace dynasurf
