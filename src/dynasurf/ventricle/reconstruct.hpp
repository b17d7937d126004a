#pragma once
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/field/vector_field.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/ventricle/detail/contour_pipeline.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/result.hpp"
#include "dynasurf/ventricle/stage_cache.hpp"

namespace dynasurf::ventricle {

/// What one wall passed through, in the frame of its border's grid. What there was none of is null.
struct WallStages {
  const Image* border = nullptr;              // closed border volume; null where there is no border, then all else is
  const Image* edge_map = nullptr;            // that the field of pipeline direct is made from
  const Image* drag = nullptr;                // per voxel, where it is not the same everywhere
  const field::VectorField* field = nullptr;  // null for contours
  const TriMesh* start = nullptr;             // what was deformed; null for contours
  const dynamics::EvolutionResult* evolved = nullptr;  // as the particles came to rest, with histories
  const TriMesh* settled = nullptr;                    // moved on to the steepest slope
  const WallContours* contours = nullptr;              // of pipeline contour: px of the image, per slice
};

/// What a run passed through, gate by gate, for saving and drawing: called once per gate if given.
struct Intermediates {
  int gate = 0;
  const Image* image = nullptr;  // canonical, normalised
  const image::EdgeMap* edges = nullptr;
  const Labels* labels = nullptr;
  WallStages endo, epi;
};
/// Receives the intermediates of one gate.
using IntermediateSink = std::function<void(const Intermediates&)>;

/// Stages that a caller replaces by functions of his own, each with a name that a note of the result tells
/// ("stage.replaced"). Called from several threads at once. The edges lie on the image's grid; so do the labels'
/// borders.
struct OwnStages {
  std::function<image::EdgeMap(const Image&)> edges;
  std::function<Labels(const Image&, const image::EdgeMap&)> labels;
  std::string edges_name = "a function of the caller", labels_name = "a function of the caller";
};

/// What a caller adds to a run of his own.
struct Additions {
  IntermediateSink keep = {};
  /// The mesh of placement.shape file. Outlives the run, as the mask does.
  const TriMesh* start = nullptr;
  /// Placed in the world like the study: nothing outside its voxels above 0 is considered (`confine`).
  const Image* mask = nullptr;
  OwnStages stages = {};
  /// Of `find_borders`: no other gate is looked at, and the fields around its borders are made too.
  std::optional<int> only_gate = {};
  /// The location of the heart from an earlier call; absent: it is searched for. Valid for the same study, mask,
  /// options manual.exclude_gates, manual.center_mm, manual.axis and manual.radius_mm alone.
  std::optional<heart::Location> located = {};
  /// Of `reconstruct`: what an earlier call found, for stages that need not be done again; null: all are. Not used
  /// beside `stages` or `located`.
  StageCache* cache = nullptr;
};

/// The whole way from a study to surfaces and numbers. Hard data never throw: the verdict and the notes say it.
/// Throws InputError for a study it cannot work on (fewer than 3 slices, NaN, a long-axis or transaxial view in which
/// no ventricle is found), OptionError, Cancelled. The same bytes for any number of threads.
Result reconstruct(const Study& study, const Options& options, const Progress& progress = {},
                   const Additions& own = {});

/// The closed border of one wall and the field that it makes, in the frame of its own grid.
struct BorderField {
  Image border;
  field::VectorField field;
};

/// What one gate has before its surfaces.
struct GateBorders {
  image::EdgeMap edges;
  Labels labels;
  int base_slice = -1;                   // highest slice of the ventricle, -1: unknown
  std::optional<BorderField> endo, epi;  // of the gate that alone was asked for
};

/// What `find_borders` found in all gates.
struct BorderResult {
  Study study;                           // canonical: slices apex first, values normalised and prepared
  std::optional<heart::Location> heart;  // world frame
  Circle coarse;                         // that the edges were looked for in
  std::vector<GateBorders> gates;
  Notes notes;
  std::vector<std::pair<std::string, double>> seconds;  // per stage, in order, summed over gates
};

/// The first half of `reconstruct`: from a study to labelled edges. Throws as it does.
BorderResult find_borders(const Study& study, const Options& options, const Progress& progress = {},
                          const Additions& own = {});

}  // namespace dynasurf::ventricle
