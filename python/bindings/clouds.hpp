#pragma once
#include <vector>

#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/report/provenance.hpp"
#include "dynasurf/report/report.hpp"

namespace dynasurf::python {

/// A cloud that knows the files it was read from.
struct OriginCloud : io::CloudInput {
  std::vector<report::InputFile> inputs;  // empty for arrays
};

/// A finished run of the cloud application: the result, and where it comes from.
struct Lods {
  report::CloudRun run;
  report::Provenance provenance;
};

}  // namespace dynasurf::python
