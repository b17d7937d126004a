#pragma once
#include <optional>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/study.hpp"

namespace dynasurf::psf_fit {

/// How the surfaces are fitted through the camera's blur.
struct BlurFit {
  bool run = true;
  std::optional<double> fwhm_mm;
  double fwhm_uncertainty = 0.07;
  std::optional<double> filter_fwhm_mm;
  std::optional<double> butterworth_per_cm;
  double butterworth_order = 5;
  std::optional<double> thickness_mm;
  double thickness_uncertainty = 0.1;
  int shape_degree = 6, wall_degree = 4, uptake_degree = 12;
  double papillary_share = 0.016;
  Attenuation attenuation = Attenuation::unknown;
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
  visit("thickness_mm", o.thickness_mm,
        OptionInfo{"mean thickness of the wall at end-diastole without its apical third, where it is known, say from "
                   "echocardiography; unset: 10 mm or so, and the data decide",
                   "mm", 3, 40});
  visit("thickness_uncertainty", o.thickness_uncertainty,
        OptionInfo{"how far the given thickness may be off, as a part of it (one standard deviation)", "", 0.01, 0.5});
  visit("shape_degree", o.shape_degree, OptionInfo{"spherical harmonics of the inner wall's shape", "", 2, 12});
  visit("wall_degree", o.wall_degree, OptionInfo{"of the thickness", "", 1, 12});
  visit("uptake_degree", o.uptake_degree, OptionInfo{"of the activity in the wall", "", 0, 12});
  visit(
      "papillary_share", o.papillary_share,
      OptionInfo{
          "largest part of the muscle that counts as papillary muscles in the cavity; less where the inner wall shows "
          "no trace of them, and the error bars hold anything from none to three times as much",
          "", 0, 0.2});
  visit("attenuation", o.attenuation,
        OptionInfo{"whether the reconstruction corrected attenuation; unknown: what the file says, and where it says "
                   "nothing, gated SPECT is searched for it"});
  visit("most_steps", o.most_steps, OptionInfo{"steps of the optimiser at most", "", 1, 1000});
}

}  // namespace dynasurf::psf_fit
