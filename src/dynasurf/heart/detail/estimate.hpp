#pragma once

namespace dynasurf::heart {

/// A number and how sure it is: one standard deviation, 0 where none is known.
struct Estimate {
  double value = 0, sd = 0;
  bool has_interval() const { return sd > 0; }
  double low() const { return value - 1.645 * sd; }  // of the 90 % interval
  double high() const { return value + 1.645 * sd; }
};

}  // namespace dynasurf::heart
