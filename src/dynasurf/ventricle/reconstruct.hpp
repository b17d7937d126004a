#pragma once
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/keyframes.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/ventricle/labels.hpp"

namespace dynasurf {

/// Everything that steers the ventricle pipeline (PIPE-2, thesis 7.1 and appendix A.8 of the specification).
struct VentricleOptions {
  double noise_fraction = 0;
  EdgeOptions edges = Canny{};
  Labelling labels;
  bool cover = true;
  FieldOptions field = Gvf{};
  int mesh_level = 3;
  Placement placement;
  Evolution evolution;
  bool warm_start = false;
  Keyframes keyframes;
};
void describe(auto& visit, VentricleOptions& o) {
  visit("noise_fraction", o.noise_fraction,
        Field{"values below this share of the maximum are set to 0 first; 0 keeps all (thesis 6.1.2.5)",
              "of the maximum", 0, 1});
  visit("edges", o.edges, Field{"edge detector"});
  visit("labels", o.labels, Field{"finding the two borders among the edges"});
  visit("cover", o.cover,
        Field{"close the open base of each border with a disc, so that surfaces stop there (thesis 6.1.2.1)"});
  visit("field", o.field, Field{"vector field of each border"});
  visit("mesh_level", o.mesh_level, Field{"2, 3, 4: 162, 642, 2562 vertices per surface (thesis table 5.2)", "", 0, 6});
  visit("placement", o.placement, Field{"the ellipsoid that the surfaces start from"});
  visit("evolution", o.evolution, Field{"the deformable model"});
  visit("warm_start", o.warm_start, Field{"start each gate from the surface of the gate before, a little enlarged"});
  visit("keyframes", o.keyframes, Field{"surfaces between the gates"});
}

/// One surface of one gate. `mesh` is in the world frame.
struct Surface {
  TriMesh mesh;
  double volume_ml = 0;
  StopReason stop_reason = StopReason::max_steps;
  int steps = 0;
  double stopped_fraction = 0;  // particles that reached their border
  double within_one_voxel = 0;  // share of particles closer than one voxel to it
  double mean_distance_mm = 0;  // to the nearest centre of a border voxel
  TriangleQuality quality;
};

struct Gate {
  int gate = 0;  // 0-based
  std::optional<double> time_ms;
  Labels labels;                     // on the canonical grid, apex first
  std::optional<Surface> endo, epi;  // absent where the border was not found
  std::optional<double> wall_ml;     // epi - endo
};

enum class Verdict { ok, check, fail };
std::span<const std::string_view> names_of(Verdict);

/// One reason to distrust a result, with its number (CARD-SANITY and others).
struct Flag {
  std::string code;  // "wall_volume_varies", "surface_missing", ...
  Severity severity = Severity::warning;
  std::string message;
  double value = 0;
};

struct VentricleResult {
  Study study;  // canonical: slices apex first, values normalised
  std::vector<Gate> gates;
  std::optional<double> edv_ml, esv_ml, sv_ml, ef_percent;  // absent for ungated or failed studies
  std::optional<int> ed_gate, es_gate;                      // 0-based
  std::optional<double> wall_variation;                     // coefficient of variation of wall_ml over the cycle
  Verdict verdict = Verdict::fail;
  std::vector<Flag> flags;
  Notes notes;
  std::vector<std::pair<std::string, double>> seconds;  // per stage, in order, summed over gates
};

/// What a run passed through, gate by gate, for saving and drawing: called once per gate if given.
struct Stages {
  int gate = 0;
  const Image* image = nullptr;  // canonical, normalised
  const EdgeMap* edges = nullptr;
  const Labels* labels = nullptr;
  const VectorField* field_endo = nullptr;  // null where there is no border
  const VectorField* field_epi = nullptr;
};
using StageSink = std::function<void(const Stages&)>;

/// The whole way from a study to surfaces and numbers. Hard data never throw: the verdict and the notes say it.
/// Throws InputError for a study it cannot work on (view not short axis, fewer than 3 slices, NaN), OptionError,
/// Cancelled. The same bytes for any number of threads.
VentricleResult reconstruct(const Study& study, const VentricleOptions& options, const Progress& progress = {},
                            const StageSink& keep = {});

}  // namespace dynasurf
