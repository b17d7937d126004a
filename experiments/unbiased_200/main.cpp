#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/study_io.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/ventricle/fit/blur_fit.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "../borders_200/patients.hpp"

namespace dynasurf {
namespace {
void examine(int number, double fwhm_factor) {
  Patient patient = draw_patient(number);
  Phantom phantom = scan(patient);
  const VirtualPatient& p = patient.options;
  VentricleResult r = reconstruct(phantom.study, VentricleOptions{});
  FitStart start;
  for (const Gate& g : r.gates) {
    if (!g.endo || !g.epi) {
      std::printf("%3d no surfaces\n", number);
      return;
    }
    start.endo.push_back(g.endo->mesh);
    start.epi.push_back(g.epi->mesh);
    start.base.push_back(g.base_plane);
  }
  start.axis = r.study.grid().direction.col(2);
  start.lateral = r.study.grid().direction.col(0);
  BlurFit o;
  if (fwhm_factor > 0) o.fwhm_mm = p.fwhm_mm * fwhm_factor, o.filter_fwhm_mm = p.noise.filter_fwhm_mm;
  const auto t0 = std::chrono::steady_clock::now();
  FittedBeat b = fit_through_blur(phantom.study, start, o);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  const double edv = *phantom.edv_ml, esv = *phantom.esv_ml, ef = *phantom.ef_percent;
  double wall = 0;
  for (auto& t : phantom.truth) wall += t.wall_ml() / phantom.truth.size();
  std::printf(
      "%3d %s def=%-12s gut=%.1f/%2.0f rv=%.1f g=%2d px=%.1f n=%3.0f fwhm %4.1f>%4.1f | edv %5.1f edge %+5.1f%% fit "
      "%+5.1f%% sd %4.1f%% | esv %5.1f edge %+5.1f%% fit %+5.1f%% sd %4.1f%% | ef %4.1f edge %+4.1f fit %+4.1f sd "
      "%3.1f | wall %5.1f fit %+5.1f%% sd %4.1f%% cv %.3f | cav %.2f>%.2f bg %.2f>%.2f | %2d%s %.2fs\n",
      number, patient.oblique ? "obl" : "sax", std::string(word_of(p.defect)).c_str(), p.gut_amplitude, p.gut_gap_mm,
      p.right_ventricle, p.gates, p.lattice.dx_mm, p.noise.peak_counts, p.fwhm_mm, b.fwhm_mm.value, edv,
      100 * (*r.edv_ml / edv - 1), 100 * (b.edv_ml.value / edv - 1), 100 * b.edv_ml.sd / edv, esv,
      100 * (*r.esv_ml / esv - 1), 100 * (b.esv_ml.value / esv - 1), 100 * b.esv_ml.sd / esv, ef, *r.ef_percent - ef,
      b.ef_percent->value - ef, b.ef_percent->sd, wall, 100 * (b.wall_ml.value / wall - 1), 100 * b.wall_ml.sd / wall,
      b.wall_variation, p.cavity, b.cavity, p.background, b.background, b.steps, b.converged ? "" : "!", seconds);
  std::fflush(stdout);
}
}  // namespace
}  // namespace dynasurf
int main(int n, char** a) {
  for (int i = std::atoi(a[1]); i < std::atoi(a[2]); ++i) dynasurf::examine(i, n > 3 ? std::atof(a[3]) : 0);
}
