#pragma once
// The study of the labellers: its hearts, its methods and its score. Tests ask it too.
#include <algorithm>
#include <ctime>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "dynasurf/image/edges.hpp"
#include "dynasurf/ventricle/label_borders.hpp"

#include "../support/border_scores.hpp"

namespace dynasurf::experiments::label_study {

constexpr double tolerance_px = 2;  // blur moves edges by one to one and a half
constexpr int seeds = 3;

inline synthetic::VirtualPatient heart(int seed) {
  synthetic::VirtualPatient o;
  o.gates = 1, o.noise.seed = static_cast<std::uint64_t>(seed);
  return o;
}

struct Case {
  std::string name;
  std::function<synthetic::PhantomOptions(int seed)> make;
  std::function<void(Image&)> spoil = [](Image&) {};
  bool has_outer_border = true;
};

inline Case patient(const std::string& name, const std::function<void(synthetic::VirtualPatient&)>& change) {
  return {name, [change](int seed) {
            synthetic::VirtualPatient o = heart(seed);
            change(o);
            return synthetic::PhantomOptions{o};
          }};
}

/// Noise in the shape of a contour: an arc of 200 degrees, 24 px around the middle, in a third of the slices.
inline void add_noise_contour(Image& image) {
  const Grid& g = image.grid;
  for (int k = 0; k < g.dims[2]; k += 3)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const double x = i - (g.dims[0] - 1) / 2.0, y = j - (g.dims[1] - 1) / 2.0, d = std::hypot(x, y) - 22;
        if (std::abs(std::atan2(y, x)) < 100 * std::numbers::pi / 180)
          image(i, j, k) += static_cast<float>(0.6 * std::exp(-d * d / 4));
      }
}

inline std::vector<Case> cases() {
  const auto defect = [](synthetic::Defect where, double extent) {
    return [=](synthetic::VirtualPatient& o) { o.defect = where, o.defect_extent_deg = extent; };
  };
  std::vector<Case> all{
      patient("full phantom", [](synthetic::VirtualPatient&) {}),
      patient(
          "small region",
          [](synthetic::VirtualPatient& o) { o.lattice = {32, 32, 24, 6, 6, 5.74}, o.edv_ml = 70, o.wall_ml = 100; }),
      patient("off centre", [](synthetic::VirtualPatient& o) { o.pose.offset_x_mm = 20, o.pose.offset_y_mm = -12; }),
      patient("tilted 15 deg",
              [](synthetic::VirtualPatient& o) { o.pose.tilt_deg = 15, o.pose.tilt_towards_deg = 60; }),
      patient("ischaemic 60", defect(synthetic::Defect::inferior, 60)),
      patient("ischaemic 90", defect(synthetic::Defect::inferior, 90)),
      patient("ischaemic 120", defect(synthetic::Defect::inferior, 120)),
      patient("apical", defect(synthetic::Defect::apical, 80)),
      patient("anteroapical", defect(synthetic::Defect::anteroapical, 80)),
      patient("noise contour", [](synthetic::VirtualPatient&) {}),
      patient("gut", [](synthetic::VirtualPatient& o) { o.gut_amplitude = 1.1; }),
      patient("right ventricle", [](synthetic::VirtualPatient& o) { o.right_ventricle = 0.4; }),
      patient("low counts", [](synthetic::VirtualPatient& o) { o.noise.peak_counts = 25; }),
      {"blood pool",
       [](int seed) {
         synthetic::Pathology o;
         o.disease = synthetic::Disease::muga, o.base.sigma_mm = 5;
         o.base.noise = {120, 8, 0, static_cast<std::uint64_t>(seed)};
         return synthetic::PhantomOptions{o};
       },
       [](Image&) {}, false},
  };
  all[9].spoil = add_noise_contour;
  return all;
}

struct Method {
  std::string name;
  ventricle::LabelOptions options;
};

inline const std::vector<Method> methods{{"none", ventricle::NoLabels{}},
                                         {"sign", ventricle::SignLabels{}},
                                         {"gradmag", ventricle::GradMagLabels{}},
                                         {"case", ventricle::CaseLabels{}},
                                         {"radial", ventricle::RadialLabels{}},
                                         {"mlc strict", ventricle::Mlc{.strict_thesis = true, .box_margin_px = 0}},
                                         {"mlc by gap", ventricle::Mlc{.use_gradient = false}},
                                         {"mlc", ventricle::Mlc{}}};

struct Result {
  Score endo, epi;
  double division = 0, milliseconds = 0;
  double mean_f1(bool has_outer_border) const { return has_outer_border ? (endo.f1() + epi.f1()) / 2 : endo.f1(); }
};

inline std::vector<image::Pixel> pixels_with(const Mask& m, int k, std::uint8_t bit) {
  std::vector<image::Pixel> pixels;
  for (int j = 0; j < m.grid.dims[1]; ++j)
    for (int i = 0; i < m.grid.dims[0]; ++i)
      if (m(i, j, k) & bit) pixels.push_back({i, j});
  return pixels;
}

inline Result measure(const std::vector<Scene>& scenes, const std::vector<image::EdgeMap>& edges,
                      const ventricle::LabelOptions& method) {
  Result r;
  ventricle::Labelling o;
  o.method = method;
  for (std::size_t n = 0; n < scenes.size(); ++n) {
    const Scene& s = scenes[n];
    const std::clock_t start = std::clock();
    const ventricle::Labels labels = ventricle::label_borders(s.image, edges[n], o);
    r.milliseconds += 1000.0 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    r.division += std::abs(labels.division_slice - s.division_slice);
    for (int k = 0; k < s.image.grid.dims[2]; ++k) {
      r.endo += score_slice(pixels_with(labels.borders, k, ventricle::Labels::endo_bit),
                            s.endo[static_cast<std::size_t>(k)], tolerance_px);
      r.epi += score_slice(pixels_with(labels.borders, k, ventricle::Labels::epi_bit),
                           s.epi[static_cast<std::size_t>(k)], tolerance_px);
    }
  }
  r.division /= static_cast<double>(scenes.size()), r.milliseconds /= static_cast<double>(scenes.size());
  return r;
}

/// The hearts of one state, with their edges.
struct Seen {
  std::vector<Scene> scenes;
  std::vector<image::EdgeMap> edges;
};
inline Seen see(const Case& c, int count = seeds) {
  Seen seen;
  for (int seed = 1; seed <= count; ++seed) {
    seen.scenes.push_back(scene_of(synthetic::make_phantom(c.make(seed))));
    Scene& scene = seen.scenes.back();
    c.spoil(scene.image);
    Notes notes;
    scene.image = image::normalise(std::move(scene.image), notes);
    seen.edges.push_back(image::detect_edges(scene.image, image::Canny{}));
  }
  return seen;
}

}  // namespace dynasurf::experiments::label_study
