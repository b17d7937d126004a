// unbiased_200 run plain|unlike|untold FIRST END: one row of numbers per patient, to the console.
// unbiased_200 table ROWS FOLDER: the tables of all rows of a file, and Bland-Altman plots in the folder.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "dynasurf/mesh/closest_point.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "../borders_200/patients.hpp"
#include "rows.hpp"

namespace dynasurf {
namespace {

/// A patient whose heart, camera and noise differ from what is fitted, and whose point spread is told 10 % too wide or
/// too narrow.
double make_unlike(Patient& patient) {
  synthetic::Random dice(20041, static_cast<std::uint64_t>(patient.number));
  const auto between = [&](double low, double high) { return low + (high - low) * dice.uniform(); };
  patient.options.irregular = {between(0.5, 1.2), between(2.5, 5), between(0, 0.15), between(0, 0.15)};
  patient.options.noise.texture = between(0.2, 0.7);
  return patient.number % 2 == 0 ? 1.1 : 0.9;
}

/// Mean distance of the fitted wall's vertices below the base from the true wall.
double distance_mm(const TriMesh& fitted, const TriMesh& truth, const heart::BasePlane& base) {
  constexpr double lid_mm = 3;
  const mesh::ClosestPoint closest(truth);
  double sum = 0, count = 0;
  for (const Vec3& p : fitted.vertices)
    if (base.height(p) < -lid_mm) sum += std::sqrt(closest(p).distance2), count += 1;
  return count > 0 ? sum / count : 0;
}

void examine(const std::string& generator, int number) {
  Patient patient = draw_patient(number);
  const double told = generator == "unlike" ? make_unlike(patient) : 1;
  const synthetic::Phantom phantom = scan(patient);
  const synthetic::VirtualPatient& p = patient.options;
  ventricle::Options options = ventricle::preset("psf_corrected");
  const bool is_told = generator != "untold";
  if (is_told) options.fit.fwhm_mm = told * p.fwhm_mm, options.fit.filter_fwhm_mm = p.noise.filter_fwhm_mm;
  const auto begin = std::chrono::steady_clock::now();
  const ventricle::Result result = ventricle::reconstruct(phantom.study, options);
  Row row;
  row.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  row.generator = generator, row.number = number;
  row.has_defect = p.defect != synthetic::Defect::none, row.has_gut = p.gut_amplitude > 0;
  row.fwhm.truth = p.fwhm_mm, row.told_mm = is_told ? told * p.fwhm_mm : 0;
  row.edv = {*phantom.edv_ml, 0, 0}, row.esv = {*phantom.esv_ml, 0, 0}, row.ef = {*phantom.ef_percent, 0, 0};
  for (const synthetic::TrueGate& gate : phantom.truth)
    row.wall.truth += gate.wall_ml() / static_cast<double>(phantom.truth.size());
  row.edge_edv = result.readings.edge.edv_ml.value_or(heart::Estimate{}).value;
  row.edge_ef = result.readings.edge.ef_percent.value_or(heart::Estimate{}).value;
  if (result.readings.psf_corrected) {
    const psf_fit::FittedBeat& fit = *result.readings.psf_corrected;
    const auto take = [](Measured& reading, const heart::Estimate& e) { reading.value = e.value, reading.sd = e.sd; };
    take(row.fwhm, fit.fwhm_mm), take(row.edv, fit.edv_ml), take(row.esv, fit.esv_ml), take(row.wall, fit.wall_ml);
    if (fit.ef_percent) take(row.ef, *fit.ef_percent);
    row.wall_variation = 100 * fit.wall_variation;
    for (const int g : {fit.ed_gate, fit.es_gate}) {
      const psf_fit::FittedGate& gate = fit.gates[static_cast<std::size_t>(g)];
      const synthetic::TrueGate& truth = phantom.truth[static_cast<std::size_t>(g)];
      row.distance_mm +=
          (distance_mm(gate.endo, truth.endo, gate.base) + distance_mm(gate.epi, truth.epi, gate.base)) / 4;
    }
  }
  std::printf("%s\n", line_of(row).c_str());
  std::fflush(stdout);
}

}  // namespace
}  // namespace dynasurf

int main(int count, char** words) try {
  const std::string mode = count > 1 ? words[1] : "";
  if (mode == "run" && count == 5) {
    for (int n = std::atoi(words[3]); n < std::atoi(words[4]); ++n) dynasurf::examine(words[2], n);
  } else if (mode == "table" && count == 4) {
    dynasurf::print_tables(dynasurf::read_rows(words[2]), words[3]);
  } else {
    std::fprintf(stderr, "expected: run plain|unlike|untold FIRST END, or table ROWS FOLDER\n");
    return 1;
  }
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "%s\n", e.what());
  return 2;
}
