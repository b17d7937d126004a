// Figures 2.8 to 2.12 of the thesis with a score: edge detectors over widths and thresholds on large and small hearts.
#include <cstdio>
#include <string>

#include "study.hpp"

using namespace dynasurf;
using namespace dynasurf::experiments;
using namespace dynasurf::experiments::edge_study;

namespace {

void head(const char* title) {
  std::printf("\n%s\n\n", title);
  std::printf("%-34s %6s %6s | %5s %5s %5s %6s | %5s %5s %5s %6s\n", "", "pixels", "comps", "prec", "rec", "Pratt",
              "offset", "prec", "rec", "Pratt", "offset");
}

void print(const std::string& name, const Row& r) {
  std::printf("%-34s %6.1f %6.1f | %5.2f %5.2f %5.2f %+6.2f | %5.2f %5.2f %5.2f %+6.2f\n", name.c_str(), r.edges,
              r.components, r.endo.precision(), r.endo.recall(), r.endo.pratt(), r.endo.mean_offset(),
              r.epi.precision(), r.epi.recall(), r.epi.pratt(), r.epi.mean_offset());
  std::fflush(stdout);
}

std::string name_of(const char* method, double sigma, double low, double high) {
  char text[80];
  std::snprintf(text, sizeof text, "%s sigma %.1f, %.2f/%.2f", method, sigma, low, high);
  return text;
}

void study(double spacing_mm, int pixels) {
  const std::vector<Scene> scenes = hearts(spacing_mm, pixels);
  std::printf("\n==== hearts %.0f px wide (%.2f mm) ====\n", width_of(scenes), spacing_mm);
  const auto canny = [&](double s, double low, double high, image::CannyThreshold how, const char* name) {
    print(name_of(name, s, low, high),
          measure(scenes, image::Canny{.sigma_px = s, .low = low, .high = high, .threshold = how}));
  };
  const auto compass = [&](double s, double low, double high) {
    print(name_of("compass", s, low, high), measure(scenes, image::Compass{.sigma_px = s, .low = low, .high = high}));
  };

  head("Sobel and Canny (figure 2.8): inner border | outer border");
  for (const double t : {0.1, 0.2, 0.3, 0.5, 0.7}) {
    char name[40];
    std::snprintf(name, sizeof name, "sobel %.1f", t);
    print(name, measure(scenes, image::SobelEdges{.threshold = t}));
    std::snprintf(name, sizeof name, "sobel %.1f, thinned", t);
    print(name, measure(scenes, image::SobelEdges{.threshold = t, .thin = true}));
  }
  canny(1.8, 0.3, 0.8, image::CannyThreshold::max_fraction, "canny");
  canny(1.8, 0.3, 0.7, image::CannyThreshold::max_fraction, "canny");
  canny(1.0, 0.15, 0.3, image::CannyThreshold::max_fraction, "canny (our default)");
  canny(1.0, 0.3, 0.8, image::CannyThreshold::percentile, "canny percentile");
  print("revised canny (our default)", measure(scenes, image::CannyRevised{}));
  print("gradient squared 0.2, thinned", measure(scenes, image::GradientEdges{.thin = true}));
  print("roberts 0.3, thinned",
        measure(scenes,
                image::GradientEdges{.measure = image::GradientMeasure::roberts, .threshold = 0.3, .thin = true}));
  print("acc, then canny (our default)", measure(scenes, image::ContourCompletion{}));
  print("acc completing canny", measure(scenes, image::ContourCompletion{.complete = true}));

  head("Widths at 0.05/0.10 (figures 2.9, 2.11): inner border | outer border");
  constexpr double widths[] = {0.2, 0.6, 1.0, 1.4, 1.8, 2.2, 2.6, 3.0, 4.0, 5.0};
  for (const double s : widths) canny(s, 0.05, 0.1, image::CannyThreshold::max_fraction, "canny");
  for (const double s : widths) canny(s, 0.05, 0.1, image::CannyThreshold::percentile, "canny percentile");
  for (const double s : widths) compass(s, 0.05, 0.1);

  head("Thresholds at sigma 2.2 (figures 2.10, 2.12): inner border | outer border");
  constexpr double pairs[][2] = {{0.1, 0.7}, {0.3, 0.6}, {0.3, 0.7}};
  for (const auto& p : pairs) canny(2.2, p[0], p[1], image::CannyThreshold::max_fraction, "canny");
  for (const auto& p : pairs) canny(2.2, p[0], p[1], image::CannyThreshold::percentile, "canny percentile");
  for (const auto& p : pairs) compass(2.2, p[0], p[1]);
  for (const auto& p : pairs) compass(1.0, p[0], p[1]);
}

}  // namespace

int main() {
  std::printf(
      "Slices through the cavity of %d virtual patients; hits within %.0f px of the true border; offset in px,\n"
      "outwards positive.\n",
      patients, tolerance_px);
  study(2.4, 64);
  study(6.0, 32);
}
