#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "dynasurf/core/progress.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/synthetic/options.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::synthetic {

/// Low energy high resolution, low energy general purpose, a cardiac CZT camera's, or one's own numbers.
enum class CollimatorModel { lehr, legp, czt, own };
inline std::span<const std::string_view> names_of(CollimatorModel) {
  static constexpr std::array<std::string_view, 4> names{"lehr", "legp", "czt", "own"};
  return names;
}

/// Parallel holes of lead and the crystal behind them.
struct Collimator {
  double hole_mm = 1.11, septum_mm = 0.16, length_mm = 24.05, intrinsic_mm = 3.8;
};
void describe(auto& visit, Collimator& o) {
  visit("hole_mm", o.hole_mm, OptionInfo{"width of a hole across flats", "mm", 0.1, 20});
  visit("septum_mm", o.septum_mm, OptionInfo{"thickness of the walls between holes", "mm", 0.01, 10});
  visit("length_mm", o.length_mm, OptionInfo{"length of the holes", "mm", 2, 200});
  visit("intrinsic_mm", o.intrinsic_mm, OptionInfo{"full width at half maximum of the crystal by itself", "mm", 0, 20});
}

/// The path of the detector: a circle, or as near to the body as it gets.
enum class Orbit { circular, body_contour };
inline std::span<const std::string_view> names_of(Orbit) {
  static constexpr std::array<std::string_view, 2> names{"circular", "body_contour"};
  return names;
}

/// How the camera goes around the patient, and what reaches it.
struct Acquisition {
  CollimatorModel collimator = CollimatorModel::lehr;
  Collimator own_collimator;
  int views = 64;
  double start_deg = -45, arc_deg = 180;
  Orbit orbit = Orbit::circular;
  double radius_mm = 220, gap_mm = 15;
  int size = 64;
  double bin_mm = 6.4;
  int oversampling = 2;
  bool attenuation = true;
  double scatter = 0.3, scatter_slope_per_cm = 0.12;
  double million_counts = 4;
  bool is_noisy = true;
  double rejected_percent = 0;
  double breathing_mm = 0;
  double move_x_mm = 0, move_y_mm = 0, move_z_mm = 0, move_at = 0.5;
};
void describe(auto& visit, Acquisition& o) {
  visit(
      "collimator", o.collimator,
      OptionInfo{
          "low-energy high resolution, low-energy general purpose, wide holes before CZT near the body, or your own"});
  visit("own_collimator", o.own_collimator, OptionInfo{"used with collimator = own"});
  visit("views", o.views, OptionInfo{"stops on the arc", "", 8, 360});
  visit(
      "start_deg", o.start_deg,
      OptionInfo{"first view: 0 in front, 90 at the patient's left; -45 is right anterior oblique", "deg", -360, 360});
  visit("arc_deg", o.arc_deg, OptionInfo{"way around the patient, towards his left first", "deg", 90, 360});
  visit("orbit", o.orbit, OptionInfo{"circular, or as near to the body as gap_mm"});
  visit("radius_mm", o.radius_mm, OptionInfo{"from the axis to the collimator on a circle", "mm", 50, 500});
  visit("gap_mm", o.gap_mm, OptionInfo{"between body and collimator along the body", "mm", 0, 200});
  visit("size", o.size, OptionInfo{"rows and columns of the camera", "", 16, 128});
  visit("bin_mm", o.bin_mm, OptionInfo{"size of a bin, and of the reconstructed voxels", "mm", 1, 20});
  visit("oversampling", o.oversampling,
        OptionInfo{"voxels of the true activity per bin, along each axis; 2 keeps the interpolation small", "", 1, 4});
  visit("attenuation", o.attenuation, OptionInfo{"photons are lost in the body"});
  visit("scatter", o.scatter,
        OptionInfo{"scattered photons per unscattered one and attenuation length of the way out; 0: none", "", 0, 2});
  visit("scatter_slope_per_cm", o.scatter_slope_per_cm,
        OptionInfo{"how fast scatter falls beside its source", "1/cm", 0.02, 2});
  visit("million_counts", o.million_counts,
        OptionInfo{"expected counts of all gates and views, before beats are rejected", "million", 1e-3, 1e4});
  visit("is_noisy", o.is_noisy, OptionInfo{"draw counts; false: their means"});
  visit("rejected_percent", o.rejected_percent,
        OptionInfo{"part of the beats that is rejected, on average; differs from view to view", "%", 0, 50});
  visit("breathing_mm", o.breathing_mm, OptionInfo{"way of everything along the body in a breath", "mm", 0, 60});
  visit("move_x_mm", o.move_x_mm, OptionInfo{"the patient moves once, to his left", "mm", -100, 100});
  visit("move_y_mm", o.move_y_mm, OptionInfo{"the same to his back", "mm", -100, 100});
  visit("move_z_mm", o.move_z_mm, OptionInfo{"the same to his head", "mm", -100, 100});
  visit("move_at", o.move_at, OptionInfo{"part of the views before he moves", "", 0, 1});
}

/// What the ramp filter is multiplied by.
enum class Window { ramp, butterworth, hann };
inline std::span<const std::string_view> names_of(Window) {
  static constexpr std::array<std::string_view, 3> names{"ramp", "butterworth", "hann"};
  return names;
}

/// Filtered backprojection. The window is applied to rows and columns alike, the ramp across the patient.
struct Fbp {
  static constexpr std::string_view name = "fbp";
  Window window = Window::butterworth;
  double cutoff_per_cm = 0.35, order = 5;
};
void describe(auto& visit, Fbp& o) {
  visit("window", o.window, OptionInfo{"ramp: none; butterworth: 1 / sqrt(1 + (f / cutoff)^(2 order)); hann"});
  visit("cutoff_per_cm", o.cutoff_per_cm,
        OptionInfo{"where a Butterworth window is 0.71, and a Hann window 0", "cycles/cm", 0.01, 5});
  visit("order", o.order, OptionInfo{"of the Butterworth window", "", 0.5, 30});
}

/// Expectation maximisation of the likelihood with ordered subsets; one subset is MLEM.
struct Osem {
  static constexpr std::string_view name = "osem";
  int iterations = 2, subsets = 8;
  bool attenuation = false, scatter = false, resolution = false;
  double filter_fwhm_mm = 10;
};
void describe(auto& visit, Osem& o) {
  visit("iterations", o.iterations, OptionInfo{"passes through all views", "", 1, 200});
  visit("subsets", o.subsets, OptionInfo{"parts of the views per pass; must divide their number; 1: MLEM", "", 1, 120});
  visit("attenuation", o.attenuation, OptionInfo{"model attenuation by the true map"});
  visit("scatter", o.scatter, OptionInfo{"add the scatter that side windows tell to the model"});
  visit("resolution", o.resolution, OptionInfo{"model the blur that grows with distance"});
  visit("filter_fwhm_mm", o.filter_fwhm_mm, OptionInfo{"Gaussian filter after it; 0: none", "mm", 0, 100});
}

/// The ways from projections to slices.
using Reconstruction = std::variant<Fbp, Osem>;

/// The short-axis stack that is cut from the transaxial one, by trilinear interpolation.
struct Reorientation {
  int size = 64, slices = 32;
  double axis_error_deg = 0, axis_error_towards_deg = 0;
};
void describe(auto& visit, Reorientation& o) {
  visit("size", o.size, OptionInfo{"rows and columns of a slice", "", 8, 512});
  visit("slices", o.slices, OptionInfo{"slices from apex to base", "", 4, 512});
  visit("axis_error_deg", o.axis_error_deg, OptionInfo{"angle between the slices' normal and the axis", "deg", 0, 60});
  visit("axis_error_towards_deg", o.axis_error_towards_deg,
        OptionInfo{"direction into which it errs: 0 lateral wall, 90 inferior wall", "deg", -360, 360});
}

/// A virtual patient without the options that the camera decides: lattice, blur and noise.
struct CameraHeart : VirtualPatient {
  CameraHeart() {
    torso.present = true;
    right_ventricle = 0.4;
    cut = Cut::transaxial;
    fwhm_mm = 0;
    noise = {};
  }
};
void describe(auto& visit, CameraHeart& o) {
  auto those_left = [&](std::string_view name, auto& value, const OptionInfo& info) {
    for (const std::string_view decided : {"fwhm_mm", "cut", "base_first", "pose", "lattice", "noise"})
      if (name == decided) return;
    visit(name, value, info);
  };
  describe(those_left, static_cast<VirtualPatient&>(o));
}

/// A virtual patient seen by a rotating gamma camera: projections, reconstructed, cut along the heart's axes.
struct CameraPhantom {
  static constexpr std::string_view name = "camera";
  CameraHeart heart;
  bool arms_down = false;
  Acquisition acquisition;
  Reconstruction reconstruction = Osem{};
  Reorientation reorientation;
  std::uint64_t seed = 1;
};
void describe(auto& visit, CameraPhantom& o) {
  visit("heart", o.heart, OptionInfo{"the virtual patient"});
  visit("arms_down", o.arms_down, OptionInfo{"arms beside the chest, which attenuate and hold no activity"});
  visit("acquisition", o.acquisition, OptionInfo{"camera, orbit, counts, motion"});
  visit("reconstruction", o.reconstruction, OptionInfo{"how the projections become slices"});
  visit("reorientation", o.reorientation, OptionInfo{"the short-axis stack"});
  visit("seed", o.seed, OptionInfo{"the same seed gives the same bytes"});
}

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

/// Throws OptionError unless the subsets divide the views.
void require_even_subsets(const Osem& options, std::size_t views);

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
