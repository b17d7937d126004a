#pragma once
#include <array>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/edge_map.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/mesh/keyframes.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/ventricle/base_plane.hpp"
#include "dynasurf/ventricle/closure.hpp"
#include "dynasurf/ventricle/contour_pipeline.hpp"
#include "dynasurf/ventricle/fit/blur_fit.hpp"
#include "dynasurf/ventricle/labels.hpp"
#include "dynasurf/ventricle/locate.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"
#include "dynasurf/ventricle/orientation.hpp"
#include "dynasurf/ventricle/result.hpp"
#include "dynasurf/ventricle/settle.hpp"
#include "dynasurf/ventricle/surface.hpp"

namespace dynasurf {

/// The free model whose particles stop where the border runs inside its voxels. The thesis stops them at the voxels'
/// outer faces, half a voxel from the edge, which widens small cavities most and lowers their ejection fraction.
inline Evolution subvoxel_evolution() {
  Evolution e;
  e.stop.point = StopPoint::subvoxel;
  return e;
}

/// How surfaces are found. `surface`: deforming triangle meshes, each in the field of its own border (PIPE-2).
/// `contour`: a contour in every slice, joined to a surface (PIPE-4, thesis 6.1.6.1). `direct`: the first version of
/// the system, with one field for both walls made straight from the image, and the inner surface growing from inside
/// (PIPE-1, thesis 7.1); the labels only say where particles stop.
enum class Pipeline { surface, contour, direct };
std::span<const std::string_view> names_of(Pipeline);

/// Everything that steers the ventricle pipeline (PIPE-2, thesis 7.1 and appendix A.8 of the specification).
struct VentricleOptions {
  Pipeline pipeline = Pipeline::surface;
  int label = 0;
  Orientation orientation;
  Manual manual;
  double noise_fraction = 0;
  Preparation prepare;
  EdgeOptions edges = Canny{};
  Labelling labels;
  Closure closure;
  EdgeMapOptions edge_map;
  FieldOptions field = Gvf{};
  int mesh_level = 3;
  Placement placement;
  Evolution evolution = subvoxel_evolution();
  Settle settle;
  Tidy tidy;
  ContourPipeline contour;
  bool warm_start = false;
  Keyframes keyframes;
  MeasureOptions measures;
  BlurFit fit;
};
void describe(auto& visit, VentricleOptions& o) {
  visit("pipeline", o.pipeline,
        Field{"surface: deforming meshes, a field for each wall; contour: a contour in every slice (thesis 6.1.6.1); "
              "direct: one field straight from the image"});
  visit("label", o.label,
        Field{"the muscle's value in a label map, all else is nothing; 0: the study is an image", "", 0, 1e6});
  visit("orientation", o.orientation, Field{"which way the heart lies in the volume"});
  visit("manual", o.manual, Field{"what a person says in place of what would be found"});
  visit("noise_fraction", o.noise_fraction,
        Field{"values below this share of the maximum are set to 0 first; 0 keeps all (thesis 6.1.2.5)",
              "of the maximum", 0, 1});
  visit("prepare", o.prepare, Field{"what the thesis tried on the values first, and gave up"});
  visit("edges", o.edges, Field{"edge detector"});
  visit("labels", o.labels, Field{"finding the two borders among the edges"});
  visit("closure", o.closure, Field{"closing the ends of the borders"});
  visit("edge_map", o.edge_map, Field{"what the field of pipeline direct is made from"});
  visit("field", o.field, Field{"vector field of each border"});
  visit("mesh_level", o.mesh_level, Field{"2, 3, 4: 162, 642, 2562 vertices per surface (thesis table 5.2)", "", 0, 6});
  visit("placement", o.placement, Field{"what the surfaces start from"});
  visit("evolution", o.evolution, Field{"the deformable model"});
  visit("settle", o.settle, Field{"from where particles stopped to the steepest slope; not for pipeline contour"});
  visit("tidy", o.tidy, Field{"better triangles on the finished surfaces, and none that cut each other"});
  visit("contour", o.contour, Field{"the contours of pipeline contour"});
  visit("warm_start", o.warm_start, Field{"start each gate from the surface of the gate before, a little enlarged"});
  visit("keyframes", o.keyframes, Field{"surfaces between the gates"});
  visit("measures", o.measures, Field{"what is measured on the surfaces"});
  visit("fit", o.fit, Field{"surfaces of all gates fitted through the point spread: PSF-corrected volumes"});
}

/// What a run passed through, gate by gate, for saving and drawing: called once per gate if given.
struct Stages {
  int gate = 0;
  const Image* image = nullptr;  // canonical, normalised
  const EdgeMap* edges = nullptr;
  const Labels* labels = nullptr;
  const Image* border_endo = nullptr;  // closed border volumes; null where there is no border
  const Image* border_epi = nullptr;
  const VectorField* field_endo = nullptr;
  const VectorField* field_epi = nullptr;
};
using StageSink = std::function<void(const Stages&)>;

/// The whole way from a study to surfaces and numbers. Hard data never throw: the verdict and the notes say it.
/// Throws InputError for a study it cannot work on (fewer than 3 slices, NaN, a long-axis or transaxial view in which
/// no ventricle is found), OptionError, Cancelled. The same bytes for any number of threads.
/// `start` is the mesh of placement.shape file. With a `mask`, placed in the world like the study, nothing outside its
/// voxels above 0 is considered (`confine`).
VentricleResult reconstruct(const Study& study, const VentricleOptions& options, const Progress& progress = {},
                            const StageSink& keep = {}, const TriMesh* start = nullptr, const Image* mask = nullptr);

/// What one gate has before its surfaces.
struct GateBorders {
  EdgeMap edges;
  Labels labels;
  int base_slice = -1;  // highest slice of the ventricle, -1: unknown
};

struct BorderResult {
  Study study;                    // canonical: slices apex first, values normalised and prepared
  std::optional<Location> heart;  // world frame
  Circle coarse;                  // that the edges were looked for in
  std::vector<GateBorders> gates;
  Notes notes;
  std::vector<std::pair<std::string, double>> seconds;  // per stage, in order, summed over gates
};

/// The first half of `reconstruct`: from a study to labelled edges. Throws as it does.
BorderResult find_borders(const Study& study, const VentricleOptions& options, const Progress& progress = {},
                          const Image* mask = nullptr);

}  // namespace dynasurf
