#pragma once
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/report/provenance.hpp"

namespace dynasurf::python {

/// A study that knows the files it was read from, for the provenance of what is made of it.
struct OriginStudy : Study {
  std::vector<report::InputFile> inputs;  // empty for arrays

  OriginStudy() = default;
  explicit OriginStudy(Study study) : Study(std::move(study)) {}
};

}  // namespace dynasurf::python
