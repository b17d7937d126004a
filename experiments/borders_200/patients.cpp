#include "patients.hpp"

#include <array>
#include <cmath>

#include "dynasurf/synthetic/detail/random.hpp"

namespace dynasurf {
namespace {

class Dice {
 public:
  explicit Dice(int number) : random_(20040, static_cast<std::uint64_t>(number)) {}
  double between(double low, double high) { return low + (high - low) * random_.uniform(); }
  double log_between(double low, double high) { return low * std::pow(high / low, random_.uniform()); }
  bool one_in(int n) { return random_.uniform() * n < 1; }
  template <class T, std::size_t N>
  T any(const std::array<T, N>& choices) {
    return choices[static_cast<std::size_t>(random_.uniform() * N)];
  }

 private:
  synthetic::Random random_;
};

int voxels_for(double field_mm, double spacing_mm) { return static_cast<int>(std::ceil(field_mm / spacing_mm)); }

}  // namespace

Patient draw_patient(int number) {
  Dice dice(number);
  Patient p;
  p.number = number;
  synthetic::VirtualPatient& o = p.options;
  // Kinds go round, so that a third is a third in every part of the series.
  p.oblique = number % 3 == 0;
  p.has_defect = (number / 3) % 3 == 0;
  p.has_gut = (number / 9) % 3 == 0;

  o.edv_ml = dice.log_between(40, 350);
  o.ef_percent = dice.between(15, 80);
  o.wall_ml = (70 + 0.35 * o.edv_ml) * dice.between(0.85, 1.15);
  o.length_to_width = dice.between(1.45, 1.85);
  o.base_excursion_mm = dice.between(0.12, 0.2) * o.ef_percent;
  o.gates = dice.one_in(2) ? 8 : 16;
  o.fwhm_mm = dice.between(8, 16);
  o.cavity = dice.between(0.04, 0.15);
  o.background = dice.between(0.03, 0.12);
  if (p.has_defect) {
    o.defect = dice.any(std::array{synthetic::Defect::inferior, synthetic::Defect::lateral, synthetic::Defect::apical,
                                   synthetic::Defect::anteroapical, synthetic::Defect::septal});
    o.defect_extent_deg = dice.between(50, 100);
    o.defect_severity = dice.between(0.5, 0.9);
  }
  if (p.has_gut) {
    o.gut_amplitude = dice.between(0.5, 1.3);
    o.gut_gap_mm = dice.between(4, 16);
    o.gut_radius_mm = dice.between(10, 18);
    o.gut_position = dice.between(0.1, 0.9);
  }
  if (dice.one_in(2)) o.right_ventricle = dice.between(0.2, 0.45);
  o.azimuth_deg = dice.between(30, 60);
  o.elevation_deg = dice.between(10, 45);
  o.base_first = dice.one_in(2);

  const double pixel = dice.any(std::array{2.8, 3.3, 4.0, 4.8, 5.6, 6.4, 7.0});
  const double slice = !p.oblique && 2 * pixel <= 7 && dice.one_in(2) ? 2 * pixel : pixel;
  const double across = p.oblique ? dice.between(230, 300) : dice.between(170, 230);
  const double along = p.oblique ? dice.between(170, 220) : dice.between(130, 160);
  o.lattice = {voxels_for(across, pixel), voxels_for(across, pixel), voxels_for(along, slice), pixel, pixel, slice};
  const double off = p.oblique ? 30 : 15;
  o.pose.offset_x_mm = dice.between(-off, off);
  o.pose.offset_y_mm = dice.between(-off, off);
  o.pose.offset_z_mm = dice.between(-6, 6);
  o.pose.tilt_deg = p.oblique ? dice.between(25, 155) : dice.between(0, 8);
  o.pose.tilt_towards_deg = dice.between(-180, 180);
  o.noise.peak_counts = dice.log_between(40, 250);
  o.noise.filter_fwhm_mm = std::min(8.0, 0.8 * o.fwhm_mm);
  o.noise.seed = 1000 + static_cast<std::uint64_t>(number);
  return p;
}

synthetic::Phantom scan(const Patient& patient) {
  synthetic::Phantom phantom = synthetic::make_phantom(patient.options);
  Study& study = phantom.study;
  const bool is_transaxial = patient.oblique || patient.options.cut == synthetic::Cut::transaxial;
  study.view = is_transaxial ? View::transaxial : View::short_axis;
  // Half of the headers do not tell apex from base.
  if (is_transaxial || patient.number % 2) study.slice_order = SliceOrder::unknown;
  return phantom;
}

}  // namespace dynasurf
