#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::synthetic {
namespace {

// What is drawn of a heart, and what of each of its acquisitions, comes from streams of its own.
constexpr std::uint64_t heart_stream = 71, acquisition_stream = 72;
constexpr std::uint64_t most_repeats = 1000;

double between(Random& random, double low, double high) { return low + (high - low) * random.uniform(); }

/// Normal, and never beyond the limits: what falls outside stands at them.
double about(Random& random, double mean, double sd, double low, double high) {
  return std::clamp(mean + sd * random.normal(), low, high);
}

/// Healthy, mildly and badly failing hearts, three fifths, one fifth, one fifth; a failing heart is wider.
void draw_function(Random& random, bool woman, VirtualPatient& o) {
  const double health = random.uniform();
  const double ef = health < 0.6 ? 64 : health < 0.8 ? 47 : 32;
  const double growth = health < 0.6 ? 1 : health < 0.8 ? 1.25 : 1.7;
  o.ef_percent = about(random, ef, 6, 12, 80);
  o.edv_ml = std::clamp((woman ? 85 : 110) * growth * own::exp(0.16 * random.normal()), 45.0, 320.0);
  o.wall_ml = std::clamp((woman ? 95 : 125) * own::exp(0.14 * random.normal() + 0.25 * own::log(growth)), 70.0, 260.0);
  o.length_to_width = about(random, growth > 1.5 ? 1.5 : 1.65, 0.08, 1.35, 1.85);
  o.base_excursion_mm = 12 * o.ef_percent / 60;
  o.heart_rate_bpm = about(random, 72, 10, 50, 110);
}

void draw_surroundings(Random& random, VirtualPatient& o) {
  if (random.uniform() < 0.4) {
    constexpr Defect places[] = {Defect::inferior, Defect::lateral, Defect::apical, Defect::anteroapical,
                                 Defect::septal};
    o.defect = places[std::min<std::size_t>(4, 5 * random.uniform())];
    o.defect_extent_deg = between(random, 50, 110);
    o.defect_severity = between(random, 0.4, 0.9);
  }
  o.right_ventricle = between(random, 0.25, 0.45);
  if (random.uniform() < 0.2) {
    o.gut_amplitude = between(random, 0.4, 1.2);
    o.gut_gap_mm = between(random, 5, 20);
  }
  o.irregular.walls = between(random, 0.2, 0.8);
  o.irregular.papillary_mm = between(random, 3, 6);
  o.azimuth_deg = about(random, 45, 8, 20, 70);
  o.elevation_deg = about(random, 30, 7, 5, 50);
}

void draw_acquisition(Random& random, VirtualPatient& o) {
  o.pose.offset_x_mm = between(random, -8, 8);
  o.pose.offset_y_mm = between(random, -8, 8);
  o.pose.tilt_deg = between(random, 0, 6);
  o.pose.tilt_towards_deg = between(random, -180, 180);
  o.noise.peak_counts = std::round(between(random, 70, 180));
  o.noise.seed = random.next();
}

}  // namespace

DrawnPatient draw_patient(std::uint64_t seed, std::uint64_t number, int repeat) {
  Random heart(seed, heart_stream, number);
  DrawnPatient drawn;
  drawn.sex = heart.uniform() < 0.45 ? "F" : "M";
  drawn.site = heart.uniform() < 0.5 ? "A" : "B";
  drawn.age_years = std::round(about(heart, 64, 11, 35, 90));
  draw_function(heart, drawn.sex == "F", drawn.options);
  draw_surroundings(heart, drawn.options);
  drawn.options.fwhm_mm = about(heart, drawn.site == "A" ? 11 : 13, 0.5, 9, 15);
  Random acquisition(seed, acquisition_stream, number * most_repeats + repeat);
  draw_acquisition(acquisition, drawn.options);
  return drawn;
}

Lattice small_lattice() { return {40, 40, 20, 4.5, 4.5, 6}; }

}  // namespace dynasurf::synthetic
