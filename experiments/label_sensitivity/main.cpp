// The parameters that the thesis left open, one at a time: what they do on one half of a set of virtual patients, and
// whether the other half agrees.
#include <array>
#include <cstdio>
#include <functional>
#include <string>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/image/edges.hpp"
#include "dynasurf/io/options_json.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/ventricle/label_borders.hpp"

#include "../support/border_scores.hpp"
#include "chart.hpp"

namespace {

using namespace dynasurf;
using namespace dynasurf::experiments;

constexpr int patients = 48;  // even ones for choosing, odd ones for reporting
constexpr double tolerance_px = 2;

Scene draw(int number) {
  synthetic::Random random(77, static_cast<std::uint64_t>(number));
  const auto between = [&](double a, double b) { return a + (b - a) * random.uniform(); };
  synthetic::VirtualPatient o;
  o.gates = 1;
  o.edv_ml = between(50, 250), o.wall_ml = (70 + 0.35 * o.edv_ml) * between(0.85, 1.15);
  o.fwhm_mm = between(8, 16);
  const double spacing = between(2.8, 6.5);
  const int pixels = static_cast<int>(std::ceil(190 / spacing));
  o.lattice = {pixels,  pixels,  static_cast<int>(std::ceil(170 / std::max(4.0, spacing))),
               spacing, spacing, std::max(4.0, spacing)};
  o.pose.offset_x_mm = between(-15, 15), o.pose.offset_y_mm = between(-15, 15);
  o.pose.tilt_deg = between(0, 12), o.pose.tilt_towards_deg = between(0, 360);
  if (number % 3 == 0) {
    constexpr synthetic::Defect defects[] = {synthetic::Defect::inferior, synthetic::Defect::lateral,
                                             synthetic::Defect::apical, synthetic::Defect::anteroapical,
                                             synthetic::Defect::septal};
    o.defect = defects[number / 3 % 5], o.defect_extent_deg = between(50, 100);
  }
  if (number % 4 == 0) o.gut_amplitude = between(0.5, 1.2);
  if (number % 5 == 0) o.right_ventricle = between(0.3, 0.5);
  o.noise = {between(40, 200), 8, 0, static_cast<std::uint64_t>(number + 1)};
  return scene_of(synthetic::make_phantom(o));
}

struct Result {
  Score endo, epi;
  double division = 0, count = 0;
  double mean_f1() const { return (endo.f1() + epi.f1()) / 2; }
};

struct Data {
  std::vector<Scene> scenes;
  std::vector<image::EdgeMap> edges;
};

/// Both halves: even patients first.
std::array<Result, 2> measure(const Data& data, const ventricle::Labelling& o) {
  std::vector<Result> each(data.scenes.size());
  parallel_for(each.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const Scene& s = data.scenes[n];
      const ventricle::Labels labels = ventricle::label_borders(s.image, data.edges[n], o);
      for (int k = 0; k < s.image.grid.dims[2]; ++k)
        for (const ventricle::Border wall : {ventricle::Border::endo, ventricle::Border::epi}) {
          std::vector<image::Pixel> pixels;
          const std::uint8_t bit =
              wall == ventricle::Border::endo ? ventricle::Labels::endo_bit : ventricle::Labels::epi_bit;
          for (int j = 0; j < s.image.grid.dims[1]; ++j)
            for (int i = 0; i < s.image.grid.dims[0]; ++i)
              if (labels.borders(i, j, k) & bit) pixels.push_back({i, j});
          const auto& line = (wall == ventricle::Border::endo ? s.endo : s.epi)[static_cast<std::size_t>(k)];
          (wall == ventricle::Border::endo ? each[n].endo : each[n].epi) += score_slice(pixels, line, tolerance_px);
        }
      each[n].division = std::abs(labels.division_slice - s.division_slice);
    }
  });
  std::array<Result, 2> halves;
  for (std::size_t n = 0; n < each.size(); ++n) {
    Result& h = halves[n % 2];
    h.endo += each[n].endo, h.epi += each[n].epi, h.division += each[n].division, h.count += 1;
  }
  return halves;
}

struct Parameter {
  std::string name;
  std::vector<double> values;
  std::function<void(ventricle::Labelling&, double)> set;
};

const std::vector<Parameter> parameters{
    {"n_min (circle.min_component_px)",
     {2, 4, 6, 8, 12, 16, 24},
     [](ventricle::Labelling& o, double v) { o.circle.min_component_px = static_cast<int>(v); }},
    {"tau of the centroid (centroid_tolerance_px)",
     {0.5, 0.75, 1, 1.5, 2, 3},
     [](ventricle::Labelling& o, double v) { o.circle.centroid_tolerance_px = v; }},
    {"T_circ (centroid_share)",
     {0.2, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9},
     [](ventricle::Labelling& o, double v) { o.circle.centroid_share = v; }},
    {"tau of the radius (radius_tolerance_px)",
     {0.5, 1, 1.5, 2, 3},
     [](ventricle::Labelling& o, double v) { o.circle.radius_tolerance_px = v; }},
    {"T_r (radius_share)",
     {0.1, 0.3, 0.5, 0.7, 0.9},
     [](ventricle::Labelling& o, double v) { o.circle.radius_share = v; }},
    {"s_c (centre_width)",
     {0.05, 0.1, 0.15, 0.25, 0.5, 2},
     [](ventricle::Labelling& o, double v) { o.circle.centre_width = v; }},
    {"offset (offset_px)", {0, 1, 2, 3, 5, 8}, [](ventricle::Labelling& o, double v) { o.circle.offset_px = v; }},
    {"jump (division.jump)",
     {0.02, 0.05, 0.1, 0.15, 0.2, 0.3, 0.5},
     [](ventricle::Labelling& o, double v) { o.division.jump = v; }},
};

}  // namespace

int main(int count, char** arguments) {
  Data data;
  data.scenes.resize(patients), data.edges.resize(patients);
  for (int n = 0; n < patients; ++n) {
    data.scenes[static_cast<std::size_t>(n)] = draw(n);
    data.edges[static_cast<std::size_t>(n)] =
        image::detect_edges(data.scenes[static_cast<std::size_t>(n)].image, image::Canny{});
  }
  std::printf(
      "%d virtual patients, half for choosing, half for reporting; the rest at its default. F1: mean of both\n"
      "borders, hits within %.0f px; division: mean distance from the true division slice. * marks the default.\n",
      patients, tolerance_px);
  struct Rule {
    const char* name;
    ventricle::LabelOptions method;
  };
  for (const Rule& rule : {Rule{"MLC, robust (the default)", ventricle::Mlc{}},
                           Rule{"MLC, strict thesis", ventricle::Mlc{.strict_thesis = true, .box_margin_px = 0}}}) {
    std::printf("\n== %s ==\n", rule.name);
    std::vector<Curve> curves;
    for (const Parameter& p : parameters) {
      Curve& curve = curves.emplace_back();
      curve.name = p.name.substr(0, p.name.find(" ("));
      std::printf("\n%-44s choosing F1  division | reporting F1  division\n", p.name.c_str());
      for (const double v : p.values) {
        ventricle::Labelling o, usual;
        o.method = usual.method = rule.method;
        p.set(o, v);
        const bool is_default = io::options_to_text(o) == io::options_to_text(usual);
        const auto r = measure(data, o);
        if (is_default) curve.usual = curve.values.size();
        curve.values.push_back(v), curve.choosing.push_back(r[0].mean_f1()), curve.reporting.push_back(r[1].mean_f1());
        std::printf("%40.2f %s         %.3f    %5.2f   |         %.3f    %5.2f\n", v, is_default ? "*" : " ",
                    r[0].mean_f1(), r[0].division / r[0].count, r[1].mean_f1(), r[1].division / r[1].count);
      }
      std::fflush(stdout);
    }
    if (count > 1 && std::holds_alternative<ventricle::Mlc>(rule.method) &&
        !std::get<ventricle::Mlc>(rule.method).strict_thesis)
      draw_curves(curves, arguments[1]);
  }
}
