#pragma once
#include <array>
#include <optional>
#include <string_view>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/mesh/motion.hpp"
#include "dynasurf/ventricle/measures/detail/phase.hpp"
#include "dynasurf/ventricle/measures/detail/segments.hpp"
#include "dynasurf/ventricle/measures/detail/volume_curve.hpp"
#include "dynasurf/ventricle/measures/detail/wall_map.hpp"
#include "dynasurf/ventricle/measures/detail/wall_thickness.hpp"

namespace dynasurf::ventricle {

/// How the numbers of a beat are taken.
struct MeasureOptions {
  SegmentModel segments = SegmentModel::aha17;
  AnteriorRule anterior = AnteriorRule::automatic;
  int waves = 3;
};
void describe(auto& visit, MeasureOptions& o) {
  visit("segments", o.segments, OptionInfo{"how the wall is divided"});
  visit("anterior", o.anterior,
        OptionInfo{
            "where the anterior wall is: patient: towards the head; rows: against the rows of the short-axis stack; "
            "auto: by the patient where the long axis runs as in a patient"});
  visit("waves", o.waves,
        OptionInfo{"waves of the volume curve's periodic fit, as far as the gates tell them", "", 1, 8});
}

/// Density of the myocardium, g/mL.
inline constexpr double muscle_density = 1.05;

/// A surface and, where it is known better than from the image, the activity of the wall at its vertices.
struct WallSide {
  const TriMesh* mesh = nullptr;
  const std::vector<double>* uptake = nullptr;
};
/// What is measured: closed surfaces and the image of each gate, in the world frame, on any pipeline's way.
struct WallGate {
  WallSide endo, epi;  // without a mesh: not found in this gate
  const Image* image = nullptr;
  std::optional<heart::BasePlane> base_plane;
};
/// What the numbers of a beat are taken from.
struct MeasureInput {
  std::vector<WallGate> gates;  // in the order of the beat
  Vec3 axis{0, 0, 1};           // unit, from apex to base
  double cycle_ms = 0;          // R-R interval, 0: unknown
  bool from_edges = true;       // the surfaces are edges of a blurred image: their thickness is apparent
};

/// One gate in its own frame. Empty where a surface is missing or the frame was not found.
struct GateMeasures {
  double endo_ml = 0, epi_ml = 0;
  std::optional<HeartAxes> axes;
  WallThickness thickness;
  WallMap map;
  // From the surfaces of end diastole; absent where the triangles are not the same.
  std::optional<mesh::SurfaceMotion> endo_motion, epi_motion;
};

/// The maps of a study; absent samples where any gate that is needed lacks the wall.
struct PolarMaps {
  // Mean over the gates of the uptake, where all of them know it, else of `counts`; 100: see reference.hpp.
  PolarValues perfusion_percent;
  PolarValues thickness_ed_mm, thickness_es_mm;
  PolarValues thickening_percent;        // (es - ed) / ed of the thickness between the surfaces
  PolarValues count_thickening_percent;  // the same of the counts: what blur leaves of the thickening of thin walls
  PolarValues motion_mm;                 // of the endocardium from end diastole to end systole, inwards positive
  PolarValues phase_counts_deg, phase_motion_deg, phase_thickness_deg;  // onset of contraction (phase.hpp)
};

/// Standard deviations of a segment's numbers, where they are known (regional_errors.hpp).
struct SegmentErrors {
  std::optional<double> perfusion_percent, thickness_ed_mm, thickness_es_mm, thickening_percent, motion_mm,
      displacement_mm, area_strain_percent, phase_motion_deg, phase_thickness_deg;
};

/// `displacement_mm` and `area_strain_percent` are those of the endocardium from end diastole to end systole, means
/// over its vertices by their area: the length of a vertex's way whatever its direction, and the change of area around
/// it. They need one set of triangles for both gates; edges of an image do not hold their vertices to the muscle.
struct SegmentMeasures {
  Segment segment;
  double wall_share_percent = 0;  // of the mapped area at end diastole
  std::optional<double> perfusion_percent, thickness_ed_mm, thickness_es_mm, thickening_percent,
      count_thickening_percent, motion_mm, displacement_mm, area_strain_percent, phase_counts_deg, phase_motion_deg,
      phase_thickness_deg;
  SegmentErrors sd;
};

/// Every number a reader expects, from one pair of surfaces per gate (docs/stages/measures.md).
struct Measures {
  bool from_edges = true;
  bool cavity_alone = false;  // a blood pool: nothing of a wall is measured
  Perfusion perfusion_is = Perfusion::none;
  Anterior anterior;
  std::vector<GateMeasures> gates;
  int ed_gate = -1, es_gate = -1;  // 0-based, of the measured volumes; -1: none (es of an ungated study)
  std::optional<VolumeCurveFit> function;
  std::optional<double> muscle_ml, muscle_g;  // mean over the gates
  SegmentModel model = SegmentModel::aha17;
  PolarGrid grid;
  PolarMaps maps;
  std::vector<double> area_mm2;           // of the samples at end diastole
  std::vector<SegmentMeasures> segments;  // by number; empty without a mapped wall
  std::optional<PhaseSummary> phase_counts, phase_motion, phase_thickness;
};

/// Gates without both surfaces take no part; but where no gate has an outer surface, as in images of the blood pool,
/// the cavity's function, motion and phase by motion are measured alone. An ungated study has perfusion and thickness,
/// no function, motion or phase. A segment's percentages come from its mean thickness and counts, its phases from its
/// mean curves. Where the uptake is known, samples with less than 25 % of it have no onset by motion or thickness.
/// Maps without any value are empty.
Measures measure_walls(const MeasureInput& input, const MeasureOptions& options);

}  // namespace dynasurf::ventricle
