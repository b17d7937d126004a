#pragma once
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/ventricle/estimate.hpp"
#include "dynasurf/ventricle/fit/detail/start.hpp"

namespace dynasurf::ventricle {

/// How the surfaces are fitted through the camera's blur.
struct BlurFit {
  bool run = true;
  std::optional<double> fwhm_mm;
  double fwhm_uncertainty = 0.07;
  std::optional<double> filter_fwhm_mm;
  std::optional<double> butterworth_per_cm;
  double butterworth_order = 5;
  int shape_degree = 6, wall_degree = 4, uptake_degree = 12;
  double papillary_share = 0.016;
  int most_steps = 60;
};
void describe(auto& visit, BlurFit& o) {
  visit("run", o.run, OptionInfo{"fit both surfaces of all gates together through the camera's blur"});
  visit("fwhm_mm", o.fwhm_mm,
        OptionInfo{"width of the point spread in the image, where it is known; 0: sharp; unset: 12 mm or so for SPECT, "
                   "6 for PET, and the data decide; sharp for MR, CT and masks",
                   "mm", 0, 60});
  visit("fwhm_uncertainty", o.fwhm_uncertainty,
        OptionInfo{"how far the given width may be off, as a part of it (one standard deviation); 0: exact", "", 0, 1});
  visit("filter_fwhm_mm", o.filter_fwhm_mm,
        OptionInfo{
            "width of the filter that the reconstruction applied to the voxels, a part of fwhm_mm; it matters where "
            "voxels are coarse; unset: half of the blur",
            "mm", 0, 60});
  visit("butterworth_per_cm", o.butterworth_per_cm,
        OptionInfo{"cutoff of the Butterworth filter that the reconstruction applied; 0: there was none; unset: what "
                   "the noise shows",
                   "cycles/cm", 0, 5});
  visit("butterworth_order", o.butterworth_order,
        OptionInfo{"its order: 1 / sqrt(1 + (f / cutoff)^(2 order)); used where its cutoff is given", "", 0.5, 30});
  visit("shape_degree", o.shape_degree, OptionInfo{"spherical harmonics of the inner wall's shape", "", 2, 12});
  visit("wall_degree", o.wall_degree, OptionInfo{"of the thickness", "", 1, 12});
  visit("uptake_degree", o.uptake_degree, OptionInfo{"of the activity in the wall", "", 0, 12});
  visit(
      "papillary_share", o.papillary_share,
      OptionInfo{
          "largest part of the muscle that counts as papillary muscles in the cavity; less where the inner wall shows "
          "no trace of them, and the error bars hold anything from none to three times as much",
          "", 0, 0.2});
  visit("most_steps", o.most_steps, OptionInfo{"steps of the optimiser at most", "", 1, 1000});
}

/// One gate as fitted. World frame. The triangles are the same for all gates and both walls: `rings` rows of
/// `segments` vertices from the apex (one vertex) to the rim at the base, then the lid that closes the base.
struct FittedGate {
  TriMesh endo, epi;
  Estimate endo_ml, epi_ml;
  BasePlane base;
};

class WallPosterior;

/// The walls of all gates that explain the image through the point spread, with their errors.
struct FittedBeat {
  std::vector<FittedGate> gates;
  int rings = 0, segments = 0;
  std::vector<double> uptake;  // per vertex of either wall over its median; 0 on the lid
  Estimate wall_ml;            // muscle, mean of the gates
  double wall_variation = 0;   // its coefficient of variation over the beat
  Estimate edv_ml, esv_ml, sv_ml;
  std::optional<Estimate> ef_percent;
  Estimate thickness_mm;  // of the wall at end-diastole: its volume over the mean area of its two sides
  int ed_gate = 0, es_gate = 0;
  Estimate fwhm_mm;
  double cavity = 0, background = 0;  // activities, the wall's median is 1
  double objective = 0;               // what is left, half a sum of squares over their variances
  int steps = 0;
  bool converged = false;
  int extracardiac_sources = 0;  // fitted with the heart
  // How much of the wall's mean thickness and of the point spread's width the data told (wall_posterior.hpp), 0 to 1.
  double thickness_from_data = 1, width_from_data = 1;
  std::shared_ptr<const WallPosterior> posterior;  // how sure anything is that is measured on the walls
  Notes notes;
};

/// Fits the walls of all gates at once: two surfaces of one topology per gate, regional uptake between them, levels of
/// blood and surroundings and hot neighbours, seen through a Gaussian point spread and compared with the voxels as they
/// were stored. Shapes and motion are smooth and periodic, the muscle's volume is constant.
/// `start` needs both surfaces in all gates of `study`. Deterministic for any number of threads.
FittedBeat fit_through_blur(const Study& study, const FitStart& start, const BlurFit& options,
                            const Progress& progress = {});

}  // namespace dynasurf::ventricle
