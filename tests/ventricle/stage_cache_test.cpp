#include "dynasurf/ventricle/stage_cache.hpp"

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/core/option_tree.hpp"
#include "dynasurf/synthetic/phantoms.hpp"
#include "dynasurf/ventricle/reconstruct.hpp"

#include "support/option_changes.hpp"

namespace dynasurf::ventricle {
namespace {

/// Two gates of a small heart; `change`: of an option of its phantom.
Study small_study(const char* change = "edv_ml=110") {
  synthetic::VirtualPatient patient;
  for (const char* setting : {"gates=2", "lattice.nx=24", "lattice.ny=24", "lattice.nz=14", "lattice.dx_mm=6",
                              "lattice.dy_mm=6", "lattice.dz_mm=8.5", change})
    set_option(patient, setting);
  return synthetic::make_phantom(synthetic::PhantomOptions{patient}).study;
}

/// Bytes that are the same where everything that was added is.
struct Bytes {
  std::string text;

  void add(double v) { text.append(reinterpret_cast<const char*>(&v), sizeof v); }
  void add(const std::string& words) { text += words + '\n'; }
  void add(const heart::Estimate& e) { add(e.value), add(e.sd); }
  void add(const TriMesh& mesh) {
    for (const Vec3& p : mesh.vertices)
      for (const double x : p) add(x);
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t vertex : triangle) add(vertex);
  }
  void add(const Surface& surface) { add(surface.mesh); }
  void add(const LeadingSurface& surface) { add(surface.volume_ml), add(surface.mesh); }
  template <class T>
  void add(const std::optional<T>& value) {
    add(value ? 1.0 : 0.0);
    if (value) add(*value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    for (const auto& value : values) add(value);
  }
};

/// What a result tells, apart from times.
std::string bytes_of(const Result& result) {
  Bytes all;
  for (const Image& gate : result.study.gates) all.add(gate.values);
  for (const Gate& gate : result.gates) {
    for (const Border wall : {Border::endo, Border::epi})
      all.add(gate.surfaces.of(wall)), all.add(gate.edge_surfaces.of(wall));
    all.add(gate.base_slice), all.add(gate.labels.borders.values), all.add(gate.edges.values);
  }
  all.add(result.leading.edv_ml), all.add(result.leading.ef_percent);
  if (const auto& profile = result.readings.gaussian_profile) all.add(profile->cavity_ml);
  if (const auto& measures = result.measures) {
    all.add(static_cast<double>(measures->segments.size())), all.add(measures->ed_gate);
    all.add(measures->maps.perfusion_percent), all.add(measures->maps.thickness_ed_mm), all.add(measures->area_mm2);
  }
  for (const QualityFlag& flag : result.flags) all.add(flag.code);
  for (const Note& note : result.notes) all.add(note.code + note.message), all.add(note.gate);
  return all.text;
}

/// The result, or the words that it was refused with.
std::string outcome(const Study& study, const Options& options, StageCache* cache) {
  try {
    return bytes_of(reconstruct(study, options, {}, {.cache = cache}));
  } catch (const OptionError& error) {
    return error.what();
  } catch (const InputError& error) {
    return error.what();
  }
}

/// One change after the other, each of the same options.
void expect_the_same(const Study& study, const Options& options, const std::vector<std::string>& changes) {
  StageCache cache;
  for (const std::string& change : changes) {
    Options changed = options;
    set_option(changed, change);
    outcome(study, options, &cache);
    EXPECT_TRUE(outcome(study, changed, &cache) == outcome(study, changed, nullptr)) << change;
  }
}

TEST(StageCache, EveryOptionHasItsEffect) {
  const Study study = small_study();
  Options options = preset("edges");
  // Where the heart lies takes most of the time, unless it is known; and where particles rest, some.
  const heart::LvShell cup = reconstruct(study, options).heart->cup;
  options.manual.center_mm = {cup.middle()[0], cup.middle()[1], cup.middle()[2]};
  options.manual.axis = {cup.axis[0], cup.axis[1], cup.axis[2]};
  options.mesh_level = 1;
  options.evolution.end.max_steps = 100;
  const std::vector<std::string> changes = test::a_change_of_every_option(options);
  EXPECT_GT(changes.size(), 100U);
  expect_the_same(study, options, changes);
}

TEST(StageCache, ChangesAfterTheSurfacesHaveTheirEffectOnTheFit) {
  Options options;
  options.fit.most_steps = 3;
  expect_the_same(small_study(), options,
                  {"fit.thickness_mm=8", "measures.waves=2", "fit.fwhm_mm=11", "manual.endo_points=1,2,2,0",
                   "manual.decision=rejected", "measures.segments=segments20", "fit.run=false"});
}

TEST(StageCache, DoesAgainWhatAChangeTouches) {
  const Study study = small_study();
  StageCache cache;
  const auto stages_with = [&](const std::string& change) {
    Options options;
    if (!change.empty()) set_option(options, change);
    std::vector<std::string> stages;
    for (const auto& [stage, seconds] : reconstruct(study, options, {}, {.cache = &cache}).seconds)
      stages.push_back(stage);
    return stages;
  };
  const std::vector<std::string> all = stages_with(""), of_reader{"measures"}, of_fit{"readings", "fit", "measures"};
  EXPECT_EQ(stages_with(""), of_reader);
  EXPECT_EQ(stages_with("manual.decision=accepted"), of_reader);
  EXPECT_EQ(stages_with("fit.thickness_mm=9"), of_fit);
  const auto has = [](const std::vector<std::string>& stages, std::string_view stage) {
    return std::find(stages.begin(), stages.end(), stage) != stages.end();
  };
  const std::vector<std::string> of_surfaces = stages_with("evolution.force.strength=3"),
                                 of_borders = stages_with("edges.sigma_px=1.5"),
                                 of_place = stages_with("manual.radius_mm=30");
  EXPECT_TRUE(has(all, "locate") && has(all, "labels") && has(all, "surfaces") && has(all, "fit"));
  EXPECT_FALSE(has(of_surfaces, "labels"));
  EXPECT_TRUE(has(of_surfaces, "surfaces") && has(of_surfaces, "fit"));
  EXPECT_TRUE(has(of_borders, "labels") && has(of_borders, "surfaces") && has(of_borders, "fit"));
  EXPECT_TRUE(has(of_place, "locate") && has(of_place, "labels"));
}

TEST(StageCache, ForgetsAnotherStudyMaskOrStart) {
  const Study first = small_study(), second = small_study("edv_ml=80");
  const Options options = preset("edges");
  Image mask(first.grid(), 1);
  std::fill(mask.values.begin(), mask.values.begin() + static_cast<std::ptrdiff_t>(mask.values.size() / 3), 0.0F);
  StageCache cache;
  const auto run = [&](const Study& study, const Image* region, StageCache* kept) {
    return bytes_of(reconstruct(study, options, {}, {.mask = region, .cache = kept}));
  };
  for (const Study* study : {&first, &second, &first})
    for (const Image* region : {static_cast<const Image*>(nullptr), static_cast<const Image*>(&mask)})
      EXPECT_TRUE(run(*study, region, &cache) == run(*study, region, nullptr));
  Options from_file = options;
  from_file.placement.shape = mesh::StartShape::file;
  const TriMesh starts[]{mesh::icosphere(2), mesh::icosphere(3)};
  for (const TriMesh& start : starts)
    EXPECT_TRUE(bytes_of(reconstruct(first, from_file, {}, {.start = &start, .cache = &cache})) ==
                bytes_of(reconstruct(first, from_file, {}, {.start = &start})));
}

TEST(StageCache, IsUsableAfterARefusalAndAStop) {
  const Study study = small_study();
  StageCache cache;
  Options bad;
  bad.manual.endo_points = {9, 0, 0, 0};
  EXPECT_THROW(reconstruct(study, bad, {}, {.cache = &cache}), OptionError);
  bad = {};
  bad.measures.waves = 99;
  reconstruct(study, {}, {}, {.cache = &cache});
  EXPECT_THROW(reconstruct(study, bad, {}, {.cache = &cache}), OptionError);
  std::stop_source source;
  source.request_stop();
  Options other;
  other.edges = image::SobelEdges{};
  EXPECT_THROW(reconstruct(study, other, {{}, source.get_token()}, {.cache = &cache}), Cancelled);
  EXPECT_TRUE(outcome(study, other, &cache) == outcome(study, other, nullptr));
}

}  // namespace
}  // namespace dynasurf::ventricle
