#pragma once
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "dynasurf/core/options.hpp"
#include "dynasurf/core/study.hpp"
#include "dynasurf/heart/locate.hpp"
#include "dynasurf/psf_fit/detail/fit_start.hpp"

namespace dynasurf::ventricle {

/// Who says which way the heart lies in the volume.
enum class OrientationMethod { header, data, automatic };
inline std::span<const std::string_view> names_of(OrientationMethod) {
  static constexpr std::array<std::string_view, 3> names{"header", "data", "auto"};
  return names;
}

/// How the way that the heart lies is found.
struct Orientation {
  OrientationMethod method = OrientationMethod::automatic;
  double most_tilt_deg = 20;
  double least_contrast = 0.3;
  double widest_pixel_mm = 4.5;
  std::optional<double> voxel_mm;
};
void describe(auto& visit, Orientation& o) {
  visit("method", o.method,
        OptionInfo{
            "header: a short-axis stack as the file says; data: always cut anew square to the axis that was found; "
            "auto: the file's short-axis stack is kept while the data do not contradict it, others are cut anew"});
  visit("most_tilt_deg", o.most_tilt_deg,
        OptionInfo{"a stack whose slices lean by less than this from square to the long axis is kept", "deg", 0, 90});
  visit("least_contrast", o.least_contrast,
        OptionInfo{"what was found contradicts a header only when its wall is this clear", "", 0, 1});
  visit("widest_pixel_mm", o.widest_pixel_mm,
        OptionInfo{
            "wider pixels of a stack that is kept are divided around the heart: edges of a small ventricle need room",
            "mm", 0.5, 100});
  visit("voxel_mm", o.voxel_mm,
        OptionInfo{"voxels of the new stack; unset: the smallest distance of voxels in the old one, at most 4 mm", "mm",
                   0.5, 20});
}

/// What a reader decides about a result.
enum class Decision { none, accepted, rejected };
inline std::span<const std::string_view> names_of(Decision) {
  static constexpr std::array<std::string_view, 3> names{"none", "accepted", "rejected"};
  return names;
}

/// Where the heart lies, as far as a person says so. World frame: DICOM's LPS. Each value replaces what would be found;
/// the reader's decision changes no number.
struct UserOverrides {
  std::optional<std::array<double, 3>> center_mm, axis;
  std::optional<double> radius_mm;
  std::optional<int> first_slice, last_slice;
  std::optional<double> base_plane_mm, base_shift_mm;
  std::vector<int> exclude_gates;
  std::vector<double> endo_points, epi_points;  // gate,x,y,z of each, mm
  Decision decision = Decision::none;
  std::string reader, comment;
};
void describe(auto& visit, UserOverrides& o) {
  visit("center_mm", o.center_mm, OptionInfo{"middle of the heart x,y,z to within 25 mm, world (LPS)", "mm"});
  visit("axis", o.axis, OptionInfo{"long axis x,y,z from apex to base, world (LPS), any length"});
  visit("radius_mm", o.radius_mm, OptionInfo{"radius of the circle around the ventricle", "mm", 5, 200});
  visit("first_slice", o.first_slice, OptionInfo{"first slice of the ventricle, from 1 at the apex", "", 1, 10000});
  visit("last_slice", o.last_slice, OptionInfo{"last slice of the ventricle, from 1 at the apex", "", 1, 10000});
  visit("base_plane_mm", o.base_plane_mm,
        OptionInfo{"height of the valve plane in all gates: along the stack, from the middle of slice 1 at the apex",
                   "mm"});
  visit("base_shift_mm", o.base_shift_mm,
        OptionInfo{"moves the valve plane of every gate along the stack, away from the apex", "mm", -100, 100});
  visit("exclude_gates", o.exclude_gates,
        OptionInfo{"gates to leave out, such as 3,4: the means of their neighbours stand in their place"});
  visit("endo_points", o.endo_points,
        OptionInfo{"places on the inner wall that the fit goes through: gate,x,y,z of each, world (LPS)", "mm"});
  visit("epi_points", o.epi_points,
        OptionInfo{"places on the outer wall that the fit goes through: gate,x,y,z of each, world (LPS)", "mm"});
  visit("decision", o.decision, OptionInfo{"what a reader decides about the result: recorded, changes no number"});
  visit("reader", o.reader, OptionInfo{"who decides"});
  visit("comment", o.comment, OptionInfo{"why, in the reader's words"});
}

/// The places on both walls that a person says. Throws OptionError unless each has four numbers, of which the first is
/// a gate of the study and the others are a place inside its volume.
std::vector<psf_fit::WallPoint> wall_points(const UserOverrides& manual, const Study& study);

/// The hints that a person's values give. Throws OptionError when an axis has no length.
heart::LocateHints hints_of(const UserOverrides& manual);

/// The heart in the mean of the gates. Its shape tells apex from base; where its two ends look alike, as those of a
/// tube without an apex, the order of the slices if the file tells it; and where a part of the wall is not seen, its
/// motion over the beat (`outward_motion_mm`), or else that order.
std::optional<heart::Location> locate_upright(const Study& study, const heart::LocateHints& hints);
/// How its apex and base were told apart, where that asks for a look ("orientation.ends_by_motion",
/// "orientation.ends_by_shape").
void note_ends(const Study& study, const heart::Location& heart, Notes& notes);

/// The grid of a short-axis stack around a heart, slices from apex to base, its columns horizontal in the world (so
/// that the anterior wall is up and the septum left, as such stacks are shown). World frame.
Grid short_axis_grid(const heart::LvShell& heart, double voxel_mm);

/// The study cut anew on that grid by one cubic interpolation.
Study reorient(const Study& study, const heart::LvShell& heart, double voxel_mm);

/// The same slices with finer pixels (cubic interpolation), cut to the surroundings of the heart: where columns or rows
/// are wider than `widest_mm`, both are divided by the least whole number that does. World positions stay.
Study with_finer_pixels(const Study& study, const heart::LvShell& heart, double widest_mm);

/// The study as a short-axis stack: as it is or cut anew, with notes that say what was done and why
/// ("orientation.reoriented", "orientation.refined", "orientation.uncertain"). `heart` is where it was found or absent.
/// Throws InputError when the file says that the stack is no short-axis one, and the method does not allow or the data
/// do not tell how to cut it.
Study orient(const Study& study, const std::optional<heart::Location>& heart, const Orientation& options);

}  // namespace dynasurf::ventricle
