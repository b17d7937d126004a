#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/synthetic/options.hpp"

namespace dynasurf::synthetic {

/// What is known of a synthetic gate: the surfaces that were filled, closed at the base, in the world frame. All
/// gates of a phantom have the same triangles.
struct TrueGate {
  TriMesh endo, epi;               // fine closed meshes; may be empty where a phantom has none
  double endo_ml = 0, epi_ml = 0;  // analytic volumes where there is a formula, else of the meshes
  double phase = 0;                // part of the beat after the R wave at which the gate was taken, its middle
  /// Activity of the wall at each vertex, healthy muscle is 1; empty but for virtual patients.
  std::vector<double> endo_uptake, epi_uptake;
  double wall_ml() const { return epi_ml - endo_ml; }
};

/// Points that were followed over the beat, and what their motion is made of.
struct TrackedTruth {
  TrackedPoints points;
  Vec3 apex{0, 0, 0},
      base{0, 0, 0};              // of the first gate: where the long axis leaves the outer wall and the valve plane
  std::vector<double> twist_deg;  // per gate, of the apex against the base, from the first gate
};

/// A study together with its truth.
struct Phantom {
  Study study;
  std::string kind;
  std::vector<TrueGate> truth;                       // one per gate
  std::optional<Vec3> axis;                          // long axis of a virtual patient, apex to base, unit, world
  std::optional<double> edv_ml, esv_ml, ef_percent;  // largest and smallest true endo_ml of the gates; gated ones only
  /// The same of the beat between the gates, as asked for; absent where only instants are defined.
  std::optional<double> beat_edv_ml, beat_esv_ml, beat_ef_percent;
  std::optional<TrackedTruth> tracked;  // of virtual patients with tags
  double fwhm_mm = 0;                   // of the point spread in the finished image, any filter included
  double missing_fraction = 0;          // part of the wall's volume left empty
  PhantomOptions options;               // what it was made from, resolved
  Notes notes;
};

/// Makes the phantom that `options` describe. The study has format "synthetic", modality NM, short-axis slices with
/// the apex first, the axes of the world (LPS) and the middle of the grid at the world's origin; virtual patients are
/// oblique, as in a real scan. The same options give the same bytes for any number of threads.
/// Throws OptionError when an option is out of range or the options contradict each other.
Phantom make_phantom(const PhantomOptions& options);

/// The single phantoms; `make_phantom` calls them.
Phantom make_phantom(const Hebron& options);
Phantom make_phantom(const Mayo& options);
Phantom make_phantom(const Partial& options);
Phantom make_phantom(const TwoSpheres& options);
Phantom make_phantom(const VoxelSphere& options);
Phantom make_phantom(const Gap& options);
Phantom make_phantom(const CardiacCycle& options);
Phantom make_phantom(const Pathology& options);
Phantom make_phantom(const VirtualPatient& options);
Phantom make_phantom(const Organ& options);

/// One study of a made-up clinic: who was imaged, where, and what the phantom is made from.
struct DrawnPatient {
  VirtualPatient options;
  std::string_view sex;   // "F" or "M"
  int age_years = 0;      // 35 to 90
  std::string_view site;  // "A" or "B"; their cameras blur by about 11 and 13 mm
};

/// Draws the patient of this number, counted from 0: ejection fraction, volumes, muscle, a perfusion defect in two of
/// five, gut beside the heart in one of five, pose, uneven walls, camera, counts. Each depends on `seed` and `number`
/// alone, so that any part of a population can be made anew, in any order. The distributions are plausible for a clinic
/// and chosen by hand: they are taken from no registry. `repeat` is another acquisition of the same heart: the pose of
/// the stack and the noise differ.
DrawnPatient draw_patient(std::uint64_t seed, std::uint64_t number, int repeat = 0);

/// Voxels of which a study takes about a third of the time of a usual one: 40 x 40 x 20 of 4.5 x 4.5 x 6 mm.
Lattice small_lattice();

}  // namespace dynasurf::synthetic
