#pragma once
#include <span>
#include <string_view>

#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/field/edge_map.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/heart/base_plane.hpp"
#include "dynasurf/image/intensity.hpp"
#include "dynasurf/mesh/motion.hpp"
#include "dynasurf/mesh/repair.hpp"
#include "dynasurf/mesh/shapes.hpp"
#include "dynasurf/psf_fit/blur_fit.hpp"
#include "dynasurf/ventricle/detail/closure.hpp"
#include "dynasurf/ventricle/detail/contour_pipeline.hpp"
#include "dynasurf/ventricle/detail/orientation.hpp"
#include "dynasurf/ventricle/detail/settle.hpp"
#include "dynasurf/ventricle/labels.hpp"
#include "dynasurf/ventricle/measures/measures.hpp"

namespace dynasurf::ventricle {

/// The free model whose particles stop where the border runs inside its voxels. The thesis stops them at the voxels'
/// outer faces, half a voxel from the edge, which widens small cavities most and lowers their ejection fraction.
inline dynamics::Evolution subvoxel_evolution() {
  dynamics::Evolution e;
  e.stop.point = dynamics::StopPoint::subvoxel;
  return e;
}

/// How surfaces are found. `surface`: deforming triangle meshes, each in the field of its own border (PIPE-2).
/// `contour`: a contour in every slice, joined to a surface (PIPE-4, thesis 6.1.6.1). `direct`: the first version of
/// the system, with one field for both walls made straight from the image, and the inner surface growing from inside
/// (PIPE-1, thesis 7.1); the labels only say where particles stop.
enum class Pipeline { surface, contour, direct };
std::span<const std::string_view> names_of(Pipeline);

/// How the first and the last slice with borders are found (FUT-USEFULSLICES): `heart`: from the apex and the valve
/// plane of the heart that was found; `score`: each slice by itself is scored by its edges, and the longest run of good
/// ones is taken.
enum class UsefulSlices { heart, score };
std::span<const std::string_view> names_of(UsefulSlices);

/// Everything that steers the ventricle pipeline (PIPE-2, thesis 7.1 and appendix A.8 of the specification).
struct Options {
  Pipeline pipeline = Pipeline::surface;
  int label = 0;
  Orientation orientation;
  UserOverrides manual;
  UsefulSlices useful_slices = UsefulSlices::heart;
  double noise_fraction = 0;
  image::Preparation prepare;
  image::EdgeOptions edges = image::Canny{};
  Labelling labels;
  Closure closure;
  field::EdgeMapOptions edge_map;
  field::FieldOptions field = field::SteadyGvf{};
  int mesh_level = 3;
  mesh::Placement placement;
  dynamics::Evolution evolution = subvoxel_evolution();
  Settle settle;
  mesh::Tidy tidy;
  ContourPipeline contour;
  bool warm_start = false;
  bool warm_backward = false;
  mesh::Keyframes keyframes;
  MeasureOptions measures;
  psf_fit::BlurFit fit;
};
void describe(auto& visit, Options& o) {
  visit("pipeline", o.pipeline,
        OptionInfo{
            "surface: deforming meshes, a field for each wall; contour: a contour in every slice (thesis 6.1.6.1); "
            "direct: one field straight from the image"});
  visit("label", o.label,
        OptionInfo{"the muscle's value in a label map, all else is nothing; 0: the study is an image", "", 0, 1e6});
  visit("orientation", o.orientation, OptionInfo{"which way the heart lies in the volume"});
  visit("manual", o.manual, OptionInfo{"what a person says in place of what would be found"});
  visit(
      "useful_slices", o.useful_slices,
      OptionInfo{"first and last slice: where the heart that was found has its apex and its valves, or the longest run "
                 "of slices whose edges close a ring of a wall"});
  visit("noise_fraction", o.noise_fraction,
        OptionInfo{"values below this share of the maximum are set to 0 first; 0 keeps all (thesis 6.1.2.5)",
                   "of the maximum", 0, 1});
  visit("prepare", o.prepare, OptionInfo{"what the thesis tried on the values first, and gave up"});
  visit("edges", o.edges, OptionInfo{"edge detector"});
  visit("labels", o.labels, OptionInfo{"finding the two borders among the edges"});
  visit("closure", o.closure, OptionInfo{"closing the ends of the borders"});
  visit("edge_map", o.edge_map, OptionInfo{"what the field of pipeline direct is made from"});
  visit("field", o.field, OptionInfo{"vector field of each border"});
  visit("mesh_level", o.mesh_level,
        OptionInfo{"2, 3, 4: 162, 642, 2562 vertices per surface (thesis table 5.2)", "", 0, 6});
  visit("placement", o.placement, OptionInfo{"what the surfaces start from"});
  visit("evolution", o.evolution, OptionInfo{"the deformable model"});
  visit("settle", o.settle, OptionInfo{"from where particles stopped to the steepest slope; not for pipeline contour"});
  visit("tidy", o.tidy, OptionInfo{"better triangles on the finished surfaces, and none that cut each other"});
  visit("contour", o.contour, OptionInfo{"the contours of pipeline contour"});
  visit("warm_start", o.warm_start,
        OptionInfo{"start each gate from the surface of the gate before, enlarged until it lies around the border"});
  visit("warm_backward", o.warm_backward,
        OptionInfo{"with warm_start: through the beat from its last gate to its first"});
  visit("keyframes", o.keyframes, OptionInfo{"surfaces between the gates"});
  visit("measures", o.measures, OptionInfo{"what is measured on the surfaces"});
  visit("fit", o.fit, OptionInfo{"surfaces of all gates fitted through the point spread: PSF-corrected volumes"});
}

/// Named sets of options: "psf_corrected", the default: surfaces on the largest gradient, then the fit through the
/// camera's blur; "edges" for the first alone; "thesis" for the pipeline exactly as it was published, where ours
/// differs; "pet", "mr" and "ct" for the default at their usual resolution: about 6 mm, which the data decide, and
/// none.
std::span<const std::string_view> preset_names();

/// Throws OptionError with the choices for an unknown name.
Options preset(std::string_view name);

}  // namespace dynasurf::ventricle
