#pragma once
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/projections.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/synthetic/camera_options.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::synthetic {

/// The collimator that the options name.
Collimator collimator_of(const Acquisition& acquisition);

/// FWHM at the distance z from its face: R² = Ri² + (d (le + z) / le)², with le the length of the holes less two mean
/// free paths in lead, 0.74 mm at 140 keV (Anger 1964; Cherry, Sorenson, Phelps, Physics in Nuclear Medicine, ch. 14).
CameraResponse response_of(const Collimator& collimator);
double fwhm_at(const CameraResponse& response, double distance_mm);

/// Counts per second and MBq of Tc-99m in air, at any distance: (K d / le)² (d / (d + t))² with K = 0.26 for hexagonal
/// holes (same sources), times 0.885 photons per decay and 0.86 for crystal and window (an estimate).
double sensitivity_cps_per_mbq(const Collimator& collimator);

/// Expected counts in each view of `activity`, one image per gate, all on one grid of n × n × n cubic voxels with the
/// axes of the world; bins are voxels. The sum over a view is that over the activity, less what is attenuated, so that
/// a point gives as many counts at any distance. `attenuation` holds 1/mm on the same grid. `response` null: no blur.
/// Attenuation is exact for even voxels; blur grows in steps from plane to plane (McCarthy and Miller 1991).
/// Throws InputError when the grids do not fit.
Projections project(const std::vector<Image>& activity, const Image* attenuation, const CameraResponse* response,
                    const std::vector<double>& angle_deg, const std::vector<double>& radius_mm);
/// The adjoint of `project`: one image per gate on the cubic grid of the projections.
std::vector<Image> back_project(const Projections& projections, const Image* attenuation,
                                const CameraResponse* response);

/// The grid of the reconstructed voxels: as many and as large as the bins.
Grid transaxial_grid(const Projections& projections);
/// The grid on which `acquire` wants the activity: `oversampling` voxels per bin.
Grid activity_grid(const Acquisition& acquisition, const Vec3& centre);

/// What the camera counts of a beating activity. Scatter follows a build-up that is linear in the attenuation length of
/// the way out (Siegel et al. 1985 use the like) and falls exponentially beside its source (Axelsson et al. 1984); the
/// counts of two narrow windows beside the peak tell it again, as TEW does (Ogawa et al. 1991). Movements carry the
/// activity with them, not the attenuation. `radius_mm`: per view.
/// The same seed gives the same bytes for any number of threads. Throws OptionError, InputError.
Projections acquire(const std::vector<Image>& activity, const Image& attenuation, const std::vector<double>& radius_mm,
                    const Acquisition& acquisition, std::uint64_t seed);
std::vector<double> angles_of(const Acquisition& acquisition);

/// Reconstructs each gate, in counts per voxel and view. Filtered backprojection may be negative. `attenuation`, on
/// `transaxial_grid`, is needed only where the options ask for it. Throws OptionError, InputError.
std::vector<Image> reconstruct_views(const Projections& projections, const Image* attenuation,
                                     const Reconstruction& options);

/// Trilinear interpolation at the voxels of another grid; 0 outside.
Image cut_out(const Image& image, const Grid& grid);

/// A patient, what the camera counted of him, and what was made of it.
struct CameraStudy {
  Phantom truth;                 // its study is the activity itself, on the fine grid
  Image attenuation;             // 1/mm, on the grid of `transaxial`
  Projections projections;       // counts
  Study transaxial, short_axis;  // voxels below 0 are set to 0, as files hold them
};

/// Makes all of it. The same options give the same bytes for any number of threads. Throws OptionError, Cancelled.
CameraStudy make_camera_study(const CameraPhantom& options, const Progress& progress = {});

}  // namespace dynasurf::synthetic
