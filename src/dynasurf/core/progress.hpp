#pragma once
#include <functional>
#include <stop_token>
#include <string_view>

#include "dynasurf/core/error.hpp"

namespace dynasurf {

/// How a long function tells its caller where it stands, and how the caller asks it to stop. Both are optional.
struct Progress {
  /// `stage` is a stable lower_case word ("edges", "field", "surfaces"); `done` of `total` units are finished.
  /// May be called from any thread, one call at a time.
  std::function<void(std::string_view stage, int done, int total)> report;
  std::stop_token stop;

  void operator()(std::string_view stage, int done, int total) const {
    if (report) report(stage, done, total);
  }
  /// Throws Cancelled when the caller asked to stop. Call it between pieces of work.
  void check() const {
    if (stop.stop_requested()) throw Cancelled("stopped on request");
  }
};

}  // namespace dynasurf
