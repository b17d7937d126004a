#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/core/detail/memo.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/ventricle/detail/gate_run.hpp"
#include "dynasurf/ventricle/detail/readings.hpp"
#include "dynasurf/ventricle/label_borders.hpp"
#include "dynasurf/ventricle/stage_cache.hpp"

// What `reconstruct` finds of a whole study, and what it keeps of it for the next call.
namespace dynasurf::ventricle {

/// What is found of a whole study before its gates are looked at, beside the options, which stay as they were asked
/// for.
struct StudyContext {
  std::optional<heart::Location> heart;
  LabelContext labels;
};

/// A study on its way to its surfaces: the gates with their borders.
struct StudyRun {
  std::optional<Study> changed;   // the study as a person wants it looked at, where it is another
  std::optional<Mask> looked_at;  // on the grid of the study as stored; absent: all of it
  Study study;
  StudyContext context;
  std::vector<GateRun> gates;
};

/// The stages whose values are kept, in their order; `measures` is all that comes after them.
enum class Stage { location, borders, surfaces, readings, measures };

/// All options that the stages up to this one depend on, with their values.
std::string options_up_to(Stage stage, const Options& options);

struct KeptStages {
  std::optional<Study> study;
  std::optional<Image> mask;
  std::optional<TriMesh> start;
  Memo<std::optional<heart::Location>> location;
  Memo<StudyRun> borders, surfaces;
  Memo<OtherReadings> readings;

  /// Forgets everything unless it was found of the same.
  void begin(const Study& of, const Image* mask_of, const TriMesh* start_of);
};

/// Does the stages of a run, those that are kept only where something they depend on has changed.
class StageKeeper {
 public:
  /// With a null `kept` nothing is kept. The options must outlive it.
  explicit StageKeeper(const Options& options, KeptStages* kept = nullptr) : options_(options), kept_(kept) {}

  std::optional<heart::Location> location(auto&& make) const {
    return value(Stage::location, &KeptStages::location, make);
  }
  StudyRun borders(auto&& make) const { return value(Stage::borders, &KeptStages::borders, make); }
  StudyRun surfaces(auto&& make) const { return value(Stage::surfaces, &KeptStages::surfaces, make); }
  OtherReadings readings(auto&& make) const { return value(Stage::readings, &KeptStages::readings, make); }

 private:
  template <class Value>
  Value value(Stage stage, Memo<Value> KeptStages::*memo, auto&& make) const {
    return kept_ == nullptr ? make() : (kept_->*memo)(options_up_to(stage, options_), make);
  }

  const Options& options_;
  KeptStages* kept_;
};

}  // namespace dynasurf::ventricle
