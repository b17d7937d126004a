#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/cloud/detail/body.hpp"
#include "dynasurf/cloud/detail/indicator_field.hpp"
#include "dynasurf/cloud/detail/orient.hpp"
#include "dynasurf/cloud/detail/prepare.hpp"
#include "dynasurf/cloud/result.hpp"
#include "dynasurf/cloud/stage_cache.hpp"
#include "dynasurf/core/detail/memo.hpp"

// What `reconstruct` finds before it makes levels, and what it keeps of it for the next call.
namespace dynasurf::cloud {

/// The body, the points that close its holes, and the side of the finest lattice's cells.
struct FoundBody {
  Body body;
  OrientedPoints fill;
  double side;
  std::vector<IndicatorField> fields;  // that a closed body was chosen from
};

/// The body, with what the result tells of it so far.
struct BodyStage {
  FoundBody found;
  Facts facts;
  CloudSupport support;
  Notes notes;
};

/// The stages whose values are kept, in their order; `levels` is all that comes after them.
enum class Stage { points, body, levels };

/// All options that the stages up to this one depend on, with their values.
std::string options_up_to(Stage stage, const Options& options);

struct KeptStages {
  std::optional<PointCloud> cloud;
  Memo<std::shared_ptr<PreparedCloud>> points;  // not copied: its tree refers to its points
  Memo<BodyStage> body;

  /// Forgets everything unless it was found of the same.
  void begin(const PointCloud& of);
};

}  // namespace dynasurf::cloud
