#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <variant>

#include "dynasurf/core/options.hpp"

namespace dynasurf::synthetic {

/// The voxels a phantom is imaged with; the default is the thesis's acquisition.
struct Lattice {
  int nx = 64, ny = 64, nz = 23;
  double dx_mm = 2.87, dy_mm = 2.87, dz_mm = 5.74;
};
void describe(auto& visit, Lattice& o) {
  visit("nx", o.nx, OptionInfo{"voxels along i (columns)", "", 1, 1024});
  visit("ny", o.ny, OptionInfo{"voxels along j (rows)", "", 1, 1024});
  visit("nz", o.nz, OptionInfo{"slices", "", 1, 1024});
  visit("dx_mm", o.dx_mm, OptionInfo{"distance of columns", "mm", 0.05, 100});
  visit("dy_mm", o.dy_mm, OptionInfo{"distance of rows", "mm", 0.05, 100});
  visit("dz_mm", o.dz_mm, OptionInfo{"distance of slices", "mm", 0.05, 100});
}

/// Counts and noise. Without counts the largest value of a grey study is 1000.
struct Noise {
  double peak_counts = 0;
  double filter_fwhm_mm = 0;
  double gaussian_percent = 0;
  std::uint64_t seed = 1;
  double texture = 0;
};
void describe(auto& visit, Noise& o) {
  visit("peak_counts", o.peak_counts,
        OptionInfo{"expected counts of the hottest voxel of the study before the filter; 0: no Poisson noise", "", 0,
                   1e7});
  visit("filter_fwhm_mm", o.filter_fwhm_mm,
        OptionInfo{
            "Gaussian filter after the counts were drawn, which makes the noise of neighbours alike; it is part of "
            "the point spread asked for, not added to it",
            "mm", 0, 100});
  visit("gaussian_percent", o.gaussian_percent,
        OptionInfo{"standard deviation of added Gaussian noise, in percent of the largest value", "%", 0, 100});
  visit("seed", o.seed, OptionInfo{"the same seed gives the same bytes"});
  visit("texture", o.texture,
        OptionInfo{
            "part of the noise's slow waves that is missing, as a reconstruction from projections leaves it: noise "
            "of neighbours becomes opposite",
            "", 0, 1});
}

/// Where an object lies in the grid: its middle against the middle of the grid, its axis against the slices' normal.
struct Pose {
  double offset_x_mm = 0, offset_y_mm = 0, offset_z_mm = 0;
  double tilt_deg = 0, tilt_towards_deg = 0;
};
void describe(auto& visit, Pose& o) {
  visit("offset_x_mm", o.offset_x_mm, OptionInfo{"middle of the object beside the middle of the grid, along i", "mm"});
  visit("offset_y_mm", o.offset_y_mm, OptionInfo{"the same along j", "mm"});
  visit("offset_z_mm", o.offset_z_mm, OptionInfo{"the same along k", "mm"});
  visit("tilt_deg", o.tilt_deg, OptionInfo{"angle between the object's axis and k", "deg", 0, 180});
  visit("tilt_towards_deg", o.tilt_towards_deg,
        OptionInfo{"direction into which the base leans: 0 is +i, 90 is +j", "deg", -360, 360});
}

/// Two coaxial "cylinder on half sphere" walls, half sphere (apex) at low k, open at the top (thesis app. D).
struct CupShape {
  double inner_radius_mm = 20, outer_radius_mm = 35, height_mm = 55;
};
void describe(auto& visit, CupShape& o) {
  visit("inner_radius_mm", o.inner_radius_mm, OptionInfo{"R1 of thesis app. D", "mm", 0.1, 1000});
  visit("outer_radius_mm", o.outer_radius_mm, OptionInfo{"R2 of thesis app. D", "mm", 0.1, 1000});
  visit("height_mm", o.height_mm, OptionInfo{"H of thesis app. D, length of the cylinder", "mm", 0, 1000});
}

/// Bright walls on a dark ground, or 1 inside and 0 outside.
enum class Values { grey, binary };
inline std::span<const std::string_view> names_of(Values) {
  static constexpr std::array<std::string_view, 2> names{"grey", "binary"};
  return names;
}

/// PH-HEBRON: the thesis's cardiac phantom (app. D). Analytic volumes 301461.995 mm3 (epi) and 85870.199 mm3 (endo);
/// the figures printed in the thesis (305301.4, 89794.5) do not follow from its radii. Its third radius, 45 mm, is
/// that of the lid and enters no volume.
struct Hebron {
  static constexpr std::string_view name = "hebron";
  CupShape shape;
  double sigma_mm = 4;
  Values values = Values::grey;
  double binary_level = 0.2;
  bool cover = false;
  double cover_radius_mm = 35;
  bool doubled = false;
  Pose pose;
  Lattice lattice;
  Noise noise;
};
void describe(auto& visit, Hebron& o) {
  visit("shape", o.shape, OptionInfo{"radii and height"});
  visit("sigma_mm", o.sigma_mm,
        OptionInfo{"standard deviation of the point spread (FWHM / 2.355); 0: none", "mm", 0, 50});
  visit("values", o.values, OptionInfo{"grey: counts; binary: 1 where the value reaches binary_level, else 0"});
  visit("binary_level", o.binary_level, OptionInfo{"part of the largest value where binary data begin", "", 0, 1});
  visit("cover", o.cover, OptionInfo{"close the open top by a disc one slice thick (VOL-COVER)"});
  visit("cover_radius_mm", o.cover_radius_mm, OptionInfo{"radius of that disc", "mm", 0, 1000});
  visit("doubled", o.doubled, OptionInfo{"double the resolution by the thesis's masks (VOL-DOUBLE)"});
  visit("pose", o.pose, OptionInfo{"offset and tilt"});
  visit("lattice", o.lattice, OptionInfo{"voxels"});
  visit("noise", o.noise, OptionInfo{"counts and noise"});
}

/// PH-MAYO: a Hebron scaled to the published overall volume, on coarse cubic voxels.
struct Mayo {
  static constexpr std::string_view name = "mayo";
  double volume_mm3 = 265501;
  double sigma_mm = 4;
  Pose pose;
  Lattice lattice{64, 64, 23, 5.388, 5.388, 5.388};
  Noise noise;
};
void describe(auto& visit, Mayo& o) {
  visit("volume_mm3", o.volume_mm3, OptionInfo{"volume of the outer solid (thesis 6.1.3)", "mm3", 1, 1e8});
  visit("sigma_mm", o.sigma_mm, OptionInfo{"standard deviation of the point spread", "mm", 0, 50});
  visit("pose", o.pose, OptionInfo{"offset and tilt"});
  visit("lattice", o.lattice, OptionInfo{"voxels"});
  visit("noise", o.noise, OptionInfo{"counts and noise"});
}

/// What is cut out of a wall.
enum class Missing { sector, patch, apex };
inline std::span<const std::string_view> names_of(Missing) {
  static constexpr std::array<std::string_view, 3> names{"sector", "patch", "apex"};
  return names;
}

/// PH-PARTIAL: a Mayo phantom part of whose wall is empty (thesis 6.1.3, table 6.14: 0.10, 0.32, 0.53).
struct Partial {
  static constexpr std::string_view name = "partial";
  double fraction = 0.32;
  Missing missing = Missing::sector;
  int pieces = 1;
  double towards_deg = 90;
  Mayo base;
};
void describe(auto& visit, Partial& o) {
  visit("fraction", o.fraction, OptionInfo{"part of the wall's volume that is empty", "", 0, 0.95});
  visit("missing", o.missing,
        OptionInfo{"sector: over the full height; patch: over the middle half of the cylinder; apex: from below"});
  visit("pieces", o.pieces, OptionInfo{"equal sectors or patches that share the fraction", "", 1, 12});
  visit("towards_deg", o.towards_deg,
        OptionInfo{"direction of the middle of the first piece: 0 is +i, 90 is +j", "deg"});
  visit("base", o.base, OptionInfo{"the phantom that is partly filled"});
}

/// PH-SPHERES: a binary shell between two concentric spheres; the central line reads 10 high voxels twice.
struct TwoSpheres {
  static constexpr std::string_view name = "spheres";
  int size = 50;
  double inner_radius_voxels = 8, outer_radius_voxels = 18;
  double spacing_mm = 1;
};
void describe(auto& visit, TwoSpheres& o) {
  visit("size", o.size, OptionInfo{"voxels along each side", "", 3, 512});
  visit("inner_radius_voxels", o.inner_radius_voxels, OptionInfo{"inner radius of the shell", "px", 0, 256});
  visit("outer_radius_voxels", o.outer_radius_voxels, OptionInfo{"outer radius of the shell", "px", 0.5, 256});
  visit("spacing_mm", o.spacing_mm, OptionInfo{"size of the voxels", "mm", 0.01, 100});
}

/// PH-SPHERE: one filled sphere of voxels, binary (thesis fig. 4.14).
struct VoxelSphere {
  static constexpr std::string_view name = "sphere";
  int size = 32;
  double radius_voxels = 10;
  double spacing_mm = 1;
};
void describe(auto& visit, VoxelSphere& o) {
  visit("size", o.size, OptionInfo{"voxels along each side", "", 3, 512});
  visit("radius_voxels", o.radius_voxels, OptionInfo{"radius", "px", 0.5, 256});
  visit("spacing_mm", o.spacing_mm, OptionInfo{"size of the voxels", "mm", 0.01, 100});
}

/// PH-GAP: a Hebron whose wall lacks a band around its middle (thesis fig. 5.8).
struct Gap {
  static constexpr std::string_view name = "gap";
  double part = 1.0 / 3.0;
  Hebron base;
};
void describe(auto& visit, Gap& o) {
  visit("part", o.part, OptionInfo{"part of the whole height that is empty, around the middle", "", 0, 0.9});
  visit("base", o.base, OptionInfo{"the phantom that loses the band"});
}

/// A wall of one volume through the beat, or the volumes that the thesis prints.
enum class WallVolume { constant, published };
inline std::span<const std::string_view> names_of(WallVolume) {
  static constexpr std::array<std::string_view, 2> names{"constant", "published"};
  return names;
}

/// PH-CYCLE: eight instants whose cavities have the volumes of thesis table 6.16 (EF 58.6 %).
struct CardiacCycle {
  static constexpr std::string_view name = "cycle";
  WallVolume wall = WallVolume::constant;
  double wall_ml = 215.591796;
  double sigma_mm = 4;
  double heart_rate_bpm = 70;
  Pose pose;
  Lattice lattice{64, 64, 24, 2.87, 2.87, 5.74};
  Noise noise;
};
void describe(auto& visit, CardiacCycle& o) {
  visit("wall", o.wall,
        OptionInfo{
            "constant: muscle keeps wall_ml, as it must; published: the wall volumes of table 6.16, which vary 1.8x"});
  visit("wall_ml", o.wall_ml, OptionInfo{"muscle volume of the constant wall", "ml", 1, 2000});
  visit("sigma_mm", o.sigma_mm, OptionInfo{"standard deviation of the point spread", "mm", 0, 50});
  visit("heart_rate_bpm", o.heart_rate_bpm, OptionInfo{"heart rate", "1/min", 20, 300});
  visit("pose", o.pose, OptionInfo{"offset and tilt"});
  visit("lattice", o.lattice, OptionInfo{"voxels"});
  visit("noise", o.noise, OptionInfo{"counts and noise"});
}

/// Which of the thesis's pathologies is shown.
enum class Disease { inferior, apical, lateral, anteroapical, digestive, right_ventricle, muga };
inline std::span<const std::string_view> names_of(Disease) {
  static constexpr std::array<std::string_view, 7> names{"inferior",  "apical",          "lateral", "anteroapical",
                                                         "digestive", "right_ventricle", "muga"};
  return names;
}

/// PH-PATHO: a Hebron with an occlusion, digestive uptake, a right ventricle, or seen by its blood pool (thesis 6.1.5).
struct Pathology {
  static constexpr std::string_view name = "pathology";
  Disease disease = Disease::inferior;
  double extent_deg = 75;
  double uptake = 0.1;
  double amplitude = 0.8;
  Hebron base;
};
void describe(auto& visit, Pathology& o) {
  visit("disease", o.disease, OptionInfo{"what is wrong; muga: bright blood pool, dark wall"});
  visit("extent_deg", o.extent_deg, OptionInfo{"width of the sick sector (60-90 in PH-PATHO)", "deg", 0, 360});
  visit("uptake", o.uptake, OptionInfo{"what is left in the sick wall, 1 is healthy", "", 0, 1});
  visit("amplitude", o.amplitude,
        OptionInfo{"activity of the digestive blob (0.5-1) or of the right ventricle's wall (0.3-0.5)", "", 0, 10});
  visit("base", o.base, OptionInfo{"the phantom that falls ill"});
}

/// The part of the wall with less uptake.
enum class Defect { none, inferior, lateral, apical, anteroapical, septal };
inline std::span<const std::string_view> names_of(Defect) {
  static constexpr std::array<std::string_view, 6> names{"none",   "inferior",     "lateral",
                                                         "apical", "anteroapical", "septal"};
  return names;
}

/// What lies around the heart in a field of view of the chest or the whole body. Activities: healthy muscle is 1.
struct Torso {
  bool present = false;
  double liver = 0.6, gallbladder = 1.5, lung = 0.12, spleen = 0.5, kidneys = 0.6, bowel = 0.4, bladder = 1.5;
};
void describe(auto& visit, Torso& o) {
  visit("present", o.present, OptionInfo{"organs and skin around the heart; false: background everywhere"});
  visit("liver", o.liver, OptionInfo{"activity of the liver, whose left lobe lies under the heart", "", 0, 10});
  visit("gallbladder", o.gallbladder, OptionInfo{"activity of the gallbladder", "", 0, 10});
  visit("lung", o.lung, OptionInfo{"activity of both lungs", "", 0, 10});
  visit("spleen", o.spleen, OptionInfo{"activity of the spleen", "", 0, 10});
  visit("kidneys", o.kidneys, OptionInfo{"activity of the kidneys", "", 0, 10});
  visit("bowel", o.bowel, OptionInfo{"activity of the bowel far from the heart", "", 0, 10});
  visit("bladder", o.bladder, OptionInfo{"activity of the urinary bladder", "", 0, 10});
}

/// What real hearts and cameras have and the plain virtual patient has not, to see what a method owes to the likeness
/// of its model with the phantom. 0 everywhere: the plain one. The truth follows: volumes are those of the uneven
/// walls, with papillary muscles counted as cavity, as in clinical reading.
struct Irregularity {
  double walls = 0, papillary_mm = 0, tails = 0, depth = 0;
};
void describe(auto& visit, Irregularity& o) {
  visit("walls", o.walls,
        OptionInfo{"uneven walls: flat septum, bulges, ridges, differing thickness; 1: as in an atlas of hearts", "", 0,
                   2});
  visit("papillary_mm", o.papillary_mm,
        OptionInfo{"radius of two papillary muscles in the cavity; 0: none", "mm", 0, 15});
  visit("tails", o.tails, OptionInfo{"part of the point spread that reaches twice as far", "", 0, 0.9});
  visit("depth", o.depth,
        OptionInfo{"how much the width of the point spread differs from the first row to the last: from 1 - depth to "
                   "1 + depth times fwhm_mm",
                   "", 0, 0.5});
}

/// Points of the muscle that are followed over the beat, as tagged MR gives them.
struct Tags {
  int points = 0;
  double twist_deg = 19, error_mm = 0.3;
};
void describe(auto& visit, Tags& o) {
  visit("points", o.points, OptionInfo{"tracked points in the wall; 0: none", "", 0, 2000});
  visit("twist_deg", o.twist_deg,
        OptionInfo{
            "how far the apex turns against the base in systole, counter-clockwise seen from the apex; the image shows "
            "nothing of it",
            "deg", -60, 60});
  visit("error_mm", o.error_mm, OptionInfo{"standard deviation of each coordinate of a tracked point", "mm", 0, 10});
}

/// How the slices of a virtual patient lie.
enum class Cut { short_axis, transaxial };
inline std::span<const std::string_view> names_of(Cut) {
  static constexpr std::array<std::string_view, 2> names{"short_axis", "transaxial"};
  return names;
}

/// A virtual patient: a ventricle that beats with known volumes, seen by a gamma camera (see ventricle_shape.hpp and
/// the page docs/stages/phantoms.md for its geometry). Rows run from anterior to inferior, columns from septum to
/// lateral wall, slices from apex to base.
struct VirtualPatient {
  static constexpr std::string_view name = "patient";
  double edv_ml = 110, ef_percent = 60, wall_ml = 120;
  double length_to_width = 1.65;
  double base_excursion_mm = 12;
  int gates = 8;
  double heart_rate_bpm = 70;
  double fwhm_mm = 12;
  double cavity = 0.08, background = 0.06;
  Defect defect = Defect::none;
  double defect_extent_deg = 80, defect_severity = 0.9;
  Defect late_wall = Defect::none;
  double late_extent_deg = 90, delay_percent = 15;
  double gut_amplitude = 0, gut_gap_mm = 6, gut_radius_mm = 14, gut_position = 0.3;
  double right_ventricle = 0;
  Irregularity irregular;
  Tags tags;
  Torso torso;
  double azimuth_deg = 45, elevation_deg = 30;
  Cut cut = Cut::short_axis;
  bool base_first = false;
  Pose pose;
  Lattice lattice;
  Noise noise{120, 8, 0, 1};
};
void describe(auto& visit, VirtualPatient& o) {
  visit("edv_ml", o.edv_ml, OptionInfo{"volume of the cavity at end-diastole", "ml", 5, 1000});
  visit("ef_percent", o.ef_percent, OptionInfo{"ejection fraction", "%", 0, 95});
  visit("wall_ml", o.wall_ml, OptionInfo{"volume of the muscle, the same in every gate", "ml", 5, 1000});
  visit("length_to_width", o.length_to_width, OptionInfo{"cavity's length over its width at end-diastole", "", 0.8, 4});
  visit("base_excursion_mm", o.base_excursion_mm,
        OptionInfo{"way of the base plane towards the apex in systole", "mm", 0, 40});
  visit("gates", o.gates, OptionInfo{"gates per beat; 1: an ungated heart at rest in end-diastole", "", 1, 64});
  visit("heart_rate_bpm", o.heart_rate_bpm, OptionInfo{"heart rate", "1/min", 20, 300});
  visit("fwhm_mm", o.fwhm_mm,
        OptionInfo{"full width at half maximum of the point spread in the finished image; 0: none", "mm", 0, 100});
  visit("cavity", o.cavity, OptionInfo{"activity of the blood, healthy muscle is 1", "", 0, 10});
  visit("background", o.background, OptionInfo{"activity around the heart", "", 0, 10});
  visit("defect", o.defect, OptionInfo{"place of a perfusion defect"});
  visit("defect_extent_deg", o.defect_extent_deg,
        OptionInfo{"width of the defect around the axis; of an apical one, its opening seen from the middle", "deg", 0,
                   360});
  visit("defect_severity", o.defect_severity, OptionInfo{"part of the uptake that is lost there", "", 0, 1});
  visit(
      "late_wall", o.late_wall,
      OptionInfo{"a sector that contracts later, as after a block of conduction; whole sectors only, no apical ones"});
  visit("late_extent_deg", o.late_extent_deg, OptionInfo{"its width around the axis", "deg", 0, 360});
  visit("delay_percent", o.delay_percent, OptionInfo{"how much later it contracts", "% of the beat", 0, 50});
  visit("gut_amplitude", o.gut_amplitude,
        OptionInfo{"activity of a loop of gut below the inferior wall; 0: none", "", 0, 10});
  visit("gut_gap_mm", o.gut_gap_mm, OptionInfo{"gap between gut and heart at end-diastole", "mm", -20, 100});
  visit("gut_radius_mm", o.gut_radius_mm,
        OptionInfo{"half thickness of the gut; its half length is twice that", "mm", 1, 60});
  visit("gut_position", o.gut_position, OptionInfo{"height of the gut along the heart: 0 apex, 1 base", "", -0.5, 1});
  visit("right_ventricle", o.right_ventricle,
        OptionInfo{"activity of the right ventricle's wall (0.3-0.5 is usual); 0: none", "", 0, 10});
  visit("irregular", o.irregular, OptionInfo{"what real hearts and cameras have beyond the plain model"});
  visit("tags", o.tags, OptionInfo{"points of the smooth wall that are followed over the beat, for points.csv"});
  visit("torso", o.torso, OptionInfo{"what lies around the heart"});
  visit("azimuth_deg", o.azimuth_deg,
        OptionInfo{"long axis from the patient's front towards his left", "deg", -180, 180});
  visit("elevation_deg", o.elevation_deg, OptionInfo{"long axis downwards from the horizontal plane", "deg", -80, 80});
  visit("cut", o.cut, OptionInfo{"how the slices lie: square to the heart's long axis, or to the patient's"});
  visit("base_first", o.base_first, OptionInfo{"store the slices from the other end: from base to apex"});
  visit("pose", o.pose, OptionInfo{"offset and tilt of the heart in the stack"});
  visit("lattice", o.lattice, OptionInfo{"voxels"});
  visit("noise", o.noise, OptionInfo{"counts and noise"});
}

/// Which organ is shown.
enum class OrganShape { liver, prostate };
inline std::span<const std::string_view> names_of(OrganShape) {
  static constexpr std::array<std::string_view, 2> names{"liver", "prostate"};
  return names;
}
/// An image with noise, or a label map.
enum class OrganValues { grey, labels };
inline std::span<const std::string_view> names_of(OrganValues) {
  static constexpr std::array<std::string_view, 2> names{"grey", "labels"};
  return names;
}

/// An organ of one closed surface, as CT, MR or PET sees it or as a label map (FUT-MODALITY): +x to the patient's left,
/// +y to his back, +z to his head. A ball lies beside it as a neighbour.
struct Organ {
  static constexpr std::string_view name = "organ";
  OrganShape shape = OrganShape::liver;
  double volume_ml = 0;
  OrganValues values = OrganValues::grey;
  double inside = 1, outside = 0.4, neighbour = 1;
  double fwhm_mm = 0;
  Pose pose;
  Lattice lattice{72, 56, 44, 4, 4, 5};
  Noise noise;
};
void describe(auto& visit, Organ& o) {
  visit("shape", o.shape, OptionInfo{"what the organ is like"});
  visit("volume_ml", o.volume_ml, OptionInfo{"its volume; 0: 1500 for a liver, 40 for a prostate", "ml", 0, 10000});
  visit("values", o.values, OptionInfo{"grey: an image; labels: 1 in the organ, 2 in its neighbour, else 0"});
  visit("inside", o.inside, OptionInfo{"grey value of the organ", "", 0, 1e6});
  visit("outside", o.outside, OptionInfo{"grey value around it", "", 0, 1e6});
  visit("neighbour", o.neighbour, OptionInfo{"grey value of the ball beside it", "", 0, 1e6});
  visit("fwhm_mm", o.fwhm_mm, OptionInfo{"full width at half maximum of the point spread; 0: none", "mm", 0, 100});
  visit("pose", o.pose, OptionInfo{"offset and tilt"});
  visit("lattice", o.lattice, OptionInfo{"voxels"});
  visit("noise", o.noise, OptionInfo{"counts and noise"});
}

/// All phantoms.
using PhantomOptions =
    std::variant<Hebron, Mayo, Partial, TwoSpheres, VoxelSphere, Gap, CardiacCycle, Pathology, VirtualPatient, Organ>;

}  // namespace dynasurf::synthetic
