// Prints the table of README.md: hearts as PET, MR, CT, masks and label maps show them, against their truth.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

using namespace dynasurf;

namespace {

struct Heart {
  const char* name;
  double edv_ml, ef_percent, wall_ml;
};
constexpr Heart hearts[] = {{"usual", 110, 60, 120}, {"small", 60, 65, 90}, {"wide", 220, 30, 170}};

enum class Drawn { grey, mask, labels };

/// How a scanner or a person shows a heart.
struct Kind {
  const char* name;
  const char* preset;
  synthetic::Lattice lattice;
  double fwhm_mm = 0, cavity = 0.1, background = 0.1, noise_percent = 0, counts = 0, filter_mm = 0, right_ventricle = 0;
  Drawn drawn = Drawn::grey;
};

std::vector<Kind> kinds() {
  const synthetic::Lattice mr{80, 80, 15, 1.8, 1.8, 8}, ct{96, 96, 70, 1.5, 1.5, 1.8}, pet{48, 48, 40, 3.3, 3.3, 3.3};
  return {
      {.name = "PET, 6 mm", .preset = "pet", .lattice = pet, .fwhm_mm = 6, .counts = 80, .filter_mm = 4},
      {.name = "PET, 7.5 mm", .preset = "pet", .lattice = pet, .fwhm_mm = 7.5, .counts = 80, .filter_mm = 5},
      {.name = "MR, bright muscle", .preset = "mr", .lattice = mr, .noise_percent = 6},
      {.name = "MR, right ventricle", .preset = "mr", .lattice = mr, .noise_percent = 6, .right_ventricle = 0.4},
      {.name = "CT, bright muscle", .preset = "ct", .lattice = ct, .noise_percent = 6},
      {.name = "MR, bright blood", .preset = "mr", .lattice = mr, .cavity = 3, .background = 0.4, .noise_percent = 6},
      {.name = "mask, MR voxels", .preset = "mr", .lattice = mr, .drawn = Drawn::mask},
      {.name = "mask, CT voxels", .preset = "ct", .lattice = ct, .drawn = Drawn::mask},
      {.name = "labels 1 wall 2 cavity", .preset = "mr", .lattice = mr, .drawn = Drawn::labels},
  };
}

synthetic::VirtualPatient patient_of(const Heart& heart, const Kind& kind) {
  synthetic::VirtualPatient p;
  p.edv_ml = heart.edv_ml, p.ef_percent = heart.ef_percent, p.wall_ml = heart.wall_ml;
  p.fwhm_mm = kind.fwhm_mm, p.lattice = kind.lattice;
  p.cavity = kind.cavity, p.background = kind.background, p.right_ventricle = kind.right_ventricle;
  p.noise = {.peak_counts = kind.counts, .filter_fwhm_mm = kind.filter_mm, .gaussian_percent = kind.noise_percent};
  p.pose.offset_x_mm = 3, p.pose.offset_y_mm = -4;
  if (kind.drawn != Drawn::grey) p.cavity = 0, p.background = 0;
  return p;
}

Study draw(const Heart& heart, const Kind& kind, synthetic::Phantom& phantom) {
  const synthetic::VirtualPatient patient = patient_of(heart, kind);
  phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  Study study = phantom.study;
  if (kind.drawn == Drawn::grey) return study;
  synthetic::VirtualPatient filled = patient;
  filled.cavity = 1;
  const Study solid = synthetic::make_phantom(synthetic::PhantomOptions{filled}).study;
  for (std::size_t g = 0; g < study.gates.size(); ++g) {
    const auto largest = [](const Image& image) { return *std::max_element(image.values.begin(), image.values.end()); };
    const float half = largest(study.gates[g]) / 2, half_solid = largest(solid.gates[g]) / 2;
    for (std::size_t v = 0; v < study.gates[g].values.size(); ++v) {
      float& value = study.gates[g].values[v];
      const bool is_wall = value >= half, is_heart = solid.gates[g].values[v] >= half_solid;
      value = is_wall ? 1.0F : is_heart && kind.drawn == Drawn::labels ? 2.0F : 0.0F;
    }
  }
  return study;
}

struct Numbers {
  double edv = NAN, esv = NAN, ef = NAN, wall = NAN;
};

/// A number with a sign, or a dash.
std::string figure(double value, int width) {
  if (std::isnan(value)) return std::string(static_cast<std::size_t>(width - 1), ' ') + "-";
  char text[32];
  std::snprintf(text, sizeof text, "%+*.1f", width, value);
  return text;
}

void print_errors(const Numbers& n, const Numbers& truth) {
  std::printf("  %s %s %s %s", figure(100 * (n.edv / truth.edv - 1), 6).c_str(),
              figure(100 * (n.esv / truth.esv - 1), 6).c_str(), figure(n.ef - truth.ef, 5).c_str(),
              figure(100 * (n.wall / truth.wall - 1), 6).c_str());
}

void print_row(const Heart& heart, const Kind& kind) {
  synthetic::Phantom phantom;
  const Study study = draw(heart, kind, phantom);
  Numbers truth{0, 1e9, 0, 0};
  for (const synthetic::TrueGate& gate : phantom.truth) {
    truth.edv = std::max(truth.edv, gate.endo_ml), truth.esv = std::min(truth.esv, gate.endo_ml);
    truth.wall += gate.wall_ml() / static_cast<double>(phantom.truth.size());
  }
  truth.ef = 100 * (1 - truth.esv / truth.edv);
  ventricle::Options options = ventricle::preset(kind.preset);
  if (kind.drawn == Drawn::labels) options.label = 1;
  const ventricle::Result result = ventricle::reconstruct(study, options);
  Numbers fit, edge;
  int held = 0;
  if (result.readings.psf_corrected && result.readings.psf_corrected->ef_percent) {
    const psf_fit::FittedBeat& f = *result.readings.psf_corrected;
    fit = {f.edv_ml.value, f.esv_ml.value, f.ef_percent->value, f.wall_ml.value};
    const auto holds = [](const heart::Estimate& e, double t) { return e.low() <= t && t <= e.high(); };
    held = holds(f.edv_ml, truth.edv) + holds(f.esv_ml, truth.esv) + holds(*f.ef_percent, truth.ef) +
           holds(f.wall_ml, truth.wall);
  }
  if (const ventricle::Reading& r = result.readings.edge; r.ef_percent)
    edge = {r.edv_ml->value, r.esv_ml->value, r.ef_percent->value, NAN};
  double seconds = 0;
  for (const auto& [stage, s] : result.seconds) seconds += s;
  std::printf("%-23s %-6s", kind.name, heart.name);
  print_errors(fit, truth);
  std::printf("   %d of 4", held);
  print_errors(edge, truth);
  std::printf("  %5.1f  %s", seconds, std::string(word_of(result.verdict)).c_str());
  for (const ventricle::QualityFlag& flag : result.flags) std::printf(" %s", flag.code.c_str());
  for (const Note& note : result.notes)
    if (note.code.starts_with("fit.")) std::printf(" %s", note.code.c_str());
  std::printf("\n");
  std::fflush(stdout);
}

}  // namespace

int main(int count, char** arguments) {
  std::printf(
      "                               unbiased                    held    classic edge\n"
      "image                   heart    EDV%%   ESV%%    EF  wall%%           EDV%%   ESV%%    EF  wall%%  s      "
      "verdict, flags\n");
  for (const Kind& kind : kinds()) {
    if (count > 1 && std::string(kind.name).find(arguments[1]) == std::string::npos) continue;
    for (const Heart& heart : hearts) print_row(heart, kind);
  }
}
