// What the studies of the thesis found, asked of the studies themselves: edges (2.2.5), labels (2.3), missing data
// (6.1.3), illness (6.1.5). Each on fewer hearts than in experiments/, with the same code.
#include <map>
#include <string>

#include <gtest/gtest.h>

#include "../../experiments/edge_study/study.hpp"
#include "../../experiments/label_study/study.hpp"
#include "../../experiments/missing_data/study.hpp"
#include "../../experiments/pathologies/study.hpp"

namespace dynasurf::experiments {
namespace {

edge_study::Row canny(const std::vector<Scene>& scenes, double sigma, double low, double high) {
  return edge_study::measure(scenes, image::Canny{.sigma_px = sigma, .low = low, .high = high});
}

TEST(EdgeStudy, FindsFewerEdgesWithGrowingWidth) {
  // Figures 2.9 and 2.11.
  for (const auto& scenes : {edge_study::hearts(2.4, 64), edge_study::hearts(6, 32)}) {
    double before = 1e9;
    for (const double sigma : {1.0, 2.2, 4.0}) {
      const double edges = canny(scenes, sigma, 0.05, 0.1).edges;
      EXPECT_LT(edges, before) << sigma;
      before = edges;
    }
  }
}

TEST(EdgeStudy, LosesTheInnerBorderOfASmallHeartFirst) {
  // Figure 2.11: from the fourth row on only the external border is left.
  const auto scenes = edge_study::hearts(6, 32);
  EXPECT_NEAR(edge_study::width_of(scenes), 11, 1);
  const edge_study::Row narrow = canny(scenes, 0.6, 0.05, 0.1), wide = canny(scenes, 4, 0.05, 0.1);
  EXPECT_GT(narrow.endo.recall(), 0.8);
  EXPECT_EQ(wide.endo.marked, 0);
  EXPECT_GT(wide.epi.marked, 0.8 * narrow.epi.marked);
  EXPECT_GT(wide.epi.pratt(), 0.8);
}

TEST(EdgeStudy, HasOurDefaultAheadOfThePublishedBestOnBlurredHearts) {
  const auto scenes = edge_study::hearts(2.4, 64);
  const edge_study::Row published = canny(scenes, 1.8, 0.3, 0.8), ours = edge_study::measure(scenes, image::Canny{});
  EXPECT_LT(published.endo.recall(), 0.2);
  EXPECT_GT(ours.endo.recall(), 0.5);
  EXPECT_GT(ours.epi.recall(), 0.95);
  EXPECT_GT(ours.epi.precision(), 0.9);
}

TEST(EdgeStudy, ThinsSobelToWhatCannyFinds) {
  // Figure 2.8.
  const auto scenes = edge_study::hearts(2.4, 64);
  const auto bands = edge_study::measure(scenes, image::SobelEdges{.threshold = 0.3}),
             lines = edge_study::measure(scenes, image::SobelEdges{.threshold = 0.3, .thin = true});
  EXPECT_LT(bands.epi.precision(), 0.5);
  EXPECT_GT(lines.epi.precision(), 0.95);
  EXPECT_GT(bands.edges, 3 * lines.edges);
}

/// Mean F1 of every method over some of the study's hearts, one seed each.
std::map<std::string, double> mean_f1(const std::vector<std::string>& states, std::map<std::string, double>* division) {
  std::map<std::string, double> sum;
  for (const label_study::Case& c : label_study::cases()) {
    if (std::find(states.begin(), states.end(), c.name) == states.end()) continue;
    const label_study::Seen seen = label_study::see(c, 1);
    for (const label_study::Method& method : label_study::methods) {
      const label_study::Result r = label_study::measure(seen.scenes, seen.edges, method.options);
      sum[method.name] += r.mean_f1(c.has_outer_border) / static_cast<double>(states.size());
      if (division != nullptr) (*division)[method.name] += r.division;
    }
  }
  return sum;
}

TEST(LabelStudy, HasTheThesissOrderOfMethods) {
  std::map<std::string, double> division;
  std::map<std::string, double> f1 = mean_f1({"full phantom", "off centre", "ischaemic 60", "ischaemic 90"}, &division);
  ASSERT_EQ(f1.size(), label_study::methods.size());
  EXPECT_LT(f1["sign"], f1["gradmag"]);
  EXPECT_LT(f1["gradmag"], f1["case"]);
  EXPECT_LT(f1["case"], f1["radial"]);
  EXPECT_LT(f1["radial"], f1["mlc"] + 0.005);
  EXPECT_GT(f1["mlc"], 0.92);
  EXPECT_EQ(division["mlc"], 0);
}

TEST(LabelStudy, ShowsWhatTheRejectedMethodsFailAt) {
  // A small region starves the field of vectors: figure 2.13. A defect makes one edge of both borders: figure 2.17.
  std::map<std::string, double> small = mean_f1({"small region"}, nullptr), sick = mean_f1({"ischaemic 60"}, nullptr);
  EXPECT_LT(small["case"], 0.5);
  EXPECT_GT(small["mlc"], 0.95);
  EXPECT_LT(sick["case"], 0.8);
  EXPECT_LT(sick["mlc strict"], sick["case"]);
  EXPECT_GT(sick["mlc"], 0.9);
}

TEST(MissingData, LowersTheVolumeAsTheThesisPublished) {
  // Table 6.14: 94.5 and 70.9 %. A test of the surface that bridges the hole, not of the phantom.
  const auto volume = [](double fraction, std::string_view preset) {
    return missing_data::outer_ml(missing_data::reconstruct_partial(fraction, synthetic::Missing::sector, preset));
  };
  const auto whole = volume(0, "thesis");
  ASSERT_TRUE(whole);
  for (std::size_t n = 1; n < 3; ++n) {
    const auto part = volume(missing_data::fractions[n], "thesis");
    ASSERT_TRUE(part);
    EXPECT_NEAR(100 * *part / *whole, missing_data::published_percent[n], 2.5) << missing_data::fractions[n];
  }
  // The default edges bridge a hole of a tenth: they lose less than half of it.
  EXPECT_GT(*volume(0.10, "edges") / *volume(0, "edges"), 0.95);
}

TEST(MissingData, IsNotPassedOverInSilence) {
  for (const synthetic::Missing where : {synthetic::Missing::sector, synthetic::Missing::apex})
    for (const double fraction : {0.32, 0.53})
      EXPECT_NE(missing_data::reconstruct_partial(fraction, where, "edges").verdict, ventricle::Verdict::ok)
          << fraction;
}

TEST(Pathologies, AreLabelledAndTheirSurfacesSmoothed) {
  // Six cases as in 6.1.5, and a right ventricle.
  for (const pathologies::Case& c : pathologies::cases()) {
    if (c.name == "healthy" || c.name == "blood pool") continue;
    SCOPED_TRACE(c.name);
    const synthetic::Phantom phantom = synthetic::make_phantom(c.made);
    const synthetic::TrueGate& truth = phantom.truth.front();
    const ventricle::Result rough = pathologies::at_rest(phantom, false), smooth = pathologies::at_rest(phantom, true);
    EXPECT_GT(pathologies::f1_of(smooth, truth.endo, ventricle::Labels::endo_bit), 0.85);
    EXPECT_GT(pathologies::f1_of(smooth, truth.epi, ventricle::Labels::epi_bit), 0.8);
    const auto &before = rough.gates.front().edge_surfaces, &after = smooth.gates.front().edge_surfaces;
    ASSERT_TRUE(after.endo && after.epi && before.endo && before.epi);
    EXPECT_LT(pathologies::peaks_of(after.endo, truth.endo), 0.7 * pathologies::peaks_of(before.endo, truth.endo));
    EXPECT_LT(pathologies::peaks_of(after.epi, truth.epi), 0.7 * pathologies::peaks_of(before.epi, truth.epi));
    EXPECT_LT(pathologies::mean_distance_mm(truth.endo, after.endo->mesh), 3);
    EXPECT_LT(pathologies::mean_distance_mm(truth.epi, after.epi->mesh), 6);
  }
}

TEST(Pathologies, AreReadBetterInsideByTheirBloodPool) {
  // Figure 6.18: where perfusion shows no inner border, ventriculography does.
  const auto inner_of = [](synthetic::Disease disease) {
    synthetic::Pathology made;
    made.disease = disease;
    const synthetic::Phantom phantom = synthetic::make_phantom(made);
    const ventricle::Result result = ventricle::reconstruct(phantom.study, ventricle::preset("edges"));
    const synthetic::TrueGate& truth = phantom.truth.front();
    return std::pair(pathologies::f1_of(result, truth.endo, ventricle::Labels::endo_bit),
                     std::abs(result.gates.front().edge_surfaces.endo->volume_ml / truth.endo_ml - 1));
  };
  const auto pool = inner_of(synthetic::Disease::muga);
  EXPECT_GT(pool.first, 0.93);
  for (const synthetic::Disease disease :
       {synthetic::Disease::inferior, synthetic::Disease::lateral, synthetic::Disease::anteroapical}) {
    const auto perfusion = inner_of(disease);
    EXPECT_GT(pool.first, perfusion.first) << word_of(disease);
    EXPECT_LT(pool.second, perfusion.second) << word_of(disease);
  }
}

TEST(Pathologies, HaveTheirCavityWithinTheFitsInterval) {
  for (const synthetic::Disease disease : {synthetic::Disease::inferior, synthetic::Disease::anteroapical}) {
    synthetic::Pathology made;
    made.disease = disease;
    const synthetic::Phantom phantom = synthetic::make_phantom(made);
    const ventricle::Result result = pathologies::reconstructed(phantom);
    ASSERT_TRUE(result.readings.psf_corrected) << word_of(disease);
    const heart::Estimate& endo = result.readings.psf_corrected->gates.front().endo_ml;
    EXPECT_LT(endo.low(), phantom.truth.front().endo_ml) << word_of(disease);
    EXPECT_GT(endo.high(), phantom.truth.front().endo_ml) << word_of(disease);
  }
}

}  // namespace
}  // namespace dynasurf::experiments
