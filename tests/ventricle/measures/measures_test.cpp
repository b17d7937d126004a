#include "dynasurf/ventricle/measures/measures.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "dynasurf/synthetic/phantoms.hpp"

namespace dynasurf::ventricle {
namespace {

/// A virtual patient without noise on coarse voxels: quick to draw, oblique as in a scanner.
synthetic::VirtualPatient quick_patient() {
  synthetic::VirtualPatient patient;
  patient.noise = {};
  patient.fwhm_mm = 8;
  patient.lattice = {32, 32, 26, 5, 5, 5};
  patient.pose.tilt_deg = 6;
  patient.pose.tilt_towards_deg = 30;
  return patient;
}

Vec3 axis_of(const synthetic::Phantom& phantom) {
  // Truth has the valve's lid on top: its normal is the axis. The vertex farthest from the lid is the apex.
  const TriMesh& epi = phantom.truth.front().epi;
  const Vec3 k = phantom.study.grid().direction.col(2);
  Vec3 normal = Vec3::Zero();
  for (const auto& t : epi.triangles) {
    const Vec3 n = (epi.vertices[t[1]] - epi.vertices[t[0]]).cross(epi.vertices[t[2]] - epi.vertices[t[0]]);
    if (n.normalized().dot(k) > 0.95 && n.norm() > 0) normal += n;
  }
  return normal.normalized();
}

/// Measures on the true surfaces, so that what is tested is the measuring.
Measures measure_truth(const synthetic::Phantom& phantom, const MeasureOptions& options = {}) {
  MeasureInput input;
  input.axis = axis_of(phantom);
  input.cycle_ms = phantom.study.cycle_ms;
  input.from_edges = false;
  for (std::size_t g = 0; g < phantom.truth.size(); ++g)
    input.gates.push_back({{&phantom.truth[g].endo}, {&phantom.truth[g].epi}, &phantom.study.gates[g], std::nullopt});
  return measure_walls(input, options);
}

Measures measure_truth_with_uptake(const synthetic::Phantom& phantom) {
  MeasureInput input;
  input.axis = phantom.axis.value();
  input.from_edges = false;
  for (std::size_t g = 0; g < phantom.truth.size(); ++g) {
    const synthetic::TrueGate& gate = phantom.truth[g];
    input.gates.push_back(
        {{&gate.endo, &gate.endo_uptake}, {&gate.epi, &gate.epi_uptake}, &phantom.study.gates[g], std::nullopt});
  }
  return measure_walls(input, {});
}

/// The numbers of the segments whose perfusion is lowest.
std::set<int> coldest(const Measures& m, std::size_t count) {
  std::vector<std::pair<double, int>> order;
  for (const SegmentMeasures& s : m.segments) order.emplace_back(s.perfusion_percent.value(), s.segment.number);
  std::sort(order.begin(), order.end());
  std::set<int> numbers;
  for (std::size_t n = 0; n < count; ++n) numbers.insert(order[n].second);
  return numbers;
}

TEST(Measures, FindAPlantedDefectInItsSegments) {
  const std::map<synthetic::Defect, std::set<int>> expected{{synthetic::Defect::inferior, {4, 10}},
                                                            {synthetic::Defect::lateral, {5, 6, 11, 12}},
                                                            {synthetic::Defect::septal, {2, 3, 8, 9}}};
  for (const auto& [defect, numbers] : expected) {
    synthetic::VirtualPatient patient = quick_patient();
    patient.gates = 1;
    patient.defect = defect;
    patient.defect_extent_deg = 60.0 * static_cast<double>(numbers.size()) / 2;
    const Measures m = measure_truth(synthetic::make_phantom(synthetic::PhantomOptions{patient}));
    ASSERT_EQ(m.segments.size(), 17u);
    EXPECT_EQ(m.anterior.rule, AnteriorRule::patient);
    EXPECT_EQ(coldest(m, numbers.size()), numbers) << static_cast<int>(defect);
    for (const int number : numbers) EXPECT_LT(*m.segments[static_cast<std::size_t>(number - 1)].perfusion_percent, 60);
  }
}

TEST(Measures, FindAnApicalDefectInTheApex) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.gates = 1;
  patient.defect = synthetic::Defect::apical;
  const Measures m = measure_truth(synthetic::make_phantom(synthetic::PhantomOptions{patient}));
  EXPECT_EQ(coldest(m, 1), std::set<int>{17});
}

TEST(Measures, FindTheDefectInAStackWhoseRowsAreUpsideDown) {
  // The same voxels in files whose rows run from inferior to anterior and whose slices run from base to apex: the
  // place in the world decides.
  synthetic::VirtualPatient patient = quick_patient();
  patient.gates = 1;
  patient.defect = synthetic::Defect::inferior;
  patient.defect_extent_deg = 60;
  synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  Image& image = phantom.study.gates.front();
  const Image original = image;
  const Vec3 axis = axis_of(phantom);
  image.grid.origin = to_world(original.grid, centre_of(original.grid, {0, original.grid.dims[1] - 1, 0}));
  image.grid.direction.col(1) *= -1;
  for (int k = 0; k < image.grid.dims[2]; ++k)
    for (int j = 0; j < image.grid.dims[1]; ++j)
      for (int i = 0; i < image.grid.dims[0]; ++i) image(i, j, k) = original(i, image.grid.dims[1] - 1 - j, k);
  MeasureInput input;
  input.axis = axis;
  input.gates.push_back({{&phantom.truth[0].endo}, {&phantom.truth[0].epi}, &image, std::nullopt});
  EXPECT_EQ(coldest(measure_walls(input, {}), 2), (std::set<int>{4, 10}));
  // Whoever asks for the rows gets what they show: the anterior wall.
  EXPECT_EQ(coldest(measure_walls(input, {.anterior = AnteriorRule::rows}), 2), (std::set<int>{1, 7}));
}

TEST(Measures, OfAHealthyBeatAreThoseOfItsShapes) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.pose = {};
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  const Measures m = measure_truth(phantom);
  ASSERT_TRUE(m.function && m.muscle_ml);
  EXPECT_NEAR(*m.muscle_ml, 120, 0.3);  // facets
  EXPECT_NEAR(*m.muscle_g, 1.05 * *m.muscle_ml, 1e-9);
  std::vector<double> cavity;
  for (const synthetic::TrueGate& gate : phantom.truth) cavity.push_back(gate.endo_ml);
  EXPECT_NEAR(m.function->ef_percent.value(), fit_volume_curve(cavity)->ef_percent.value(), 0.1);  // facets
  // The wall between true surfaces thickens, and every segment moves inwards.
  double shares = 0;
  for (const SegmentMeasures& s : m.segments) {
    SCOPED_TRACE(s.segment.number);
    shares += s.wall_share_percent;
    ASSERT_TRUE(s.thickness_ed_mm && s.thickening_percent && s.motion_mm && s.phase_motion_deg);
    EXPECT_GT(*s.thickness_ed_mm, 5);
    EXPECT_LT(*s.thickness_ed_mm, 13);
    EXPECT_GT(*s.thickening_percent, 15);
    EXPECT_GT(*s.count_thickening_percent, 3);
    if (s.segment.number != 17) {
      EXPECT_GT(*s.motion_mm, 2);
    }
  }
  EXPECT_NEAR(shares, 100, 1e-9);
  // All walls of this heart contract together.
  ASSERT_TRUE(m.phase_motion && m.phase_counts);
  EXPECT_LT(m.phase_motion->sd_deg, 6);
  EXPECT_LT(m.phase_counts->sd_deg, 15);
}

TEST(Measures, TellWhereEveryVertexWentAndHowItsAreaChanged) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.pose = {};
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  // All shrinks to four fifths about a point on the axis and back: areas to 16/25, lengths by a fifth.
  const TriMesh &endo = phantom.truth[0].endo, &epi = phantom.truth[0].epi;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : endo.vertices) middle += p / static_cast<double>(endo.vertices.size());
  std::vector<TriMesh> endos, epis;
  for (const double scale : {1.0, 0.9, 0.8, 0.9})
    for (auto [from, to] : {std::pair(&endo, &endos), std::pair(&epi, &epis)}) {
      to->push_back(*from);
      for (Vec3& p : to->back().vertices) p = middle + scale * (p - middle);
    }
  MeasureInput input;
  input.axis = axis_of(phantom);
  input.from_edges = false;
  for (std::size_t g = 0; g < 4; ++g)
    input.gates.push_back({{&endos[g]}, {&epis[g]}, &phantom.study.gates[0], std::nullopt});
  const Measures m = measure_walls(input, {});
  ASSERT_EQ(m.ed_gate, 0);
  ASSERT_EQ(m.es_gate, 2);
  ASSERT_TRUE(m.gates[2].endo_motion && m.gates[1].epi_motion);
  for (std::size_t v = 0; v < endo.vertices.size(); ++v) {
    EXPECT_NEAR(m.gates[2].endo_motion->displacement_mm[v], 0.2 * (endo.vertices[v] - middle).norm(), 1e-9);
    EXPECT_NEAR(m.gates[2].endo_motion->area_strain_percent[v], -36, 1e-6);
  }
  EXPECT_NEAR(m.gates[1].epi_motion->area_strain_percent[0], -19, 1e-6);
  for (const SegmentMeasures& s : m.segments) {
    EXPECT_NEAR(s.area_strain_percent.value(), -36, 1e-6) << s.segment.number;
    EXPECT_GT(s.displacement_mm.value(), 2) << s.segment.number;
    EXPECT_LT(s.displacement_mm.value(), 12) << s.segment.number;
  }
  // Other triangles tell nothing of where the muscle went.
  std::rotate(endos[2].triangles.begin(), endos[2].triangles.begin() + 1, endos[2].triangles.end());
  const Measures other = measure_walls(input, {});
  EXPECT_FALSE(other.gates[2].endo_motion);
  EXPECT_FALSE(other.segments[0].area_strain_percent);
}

TEST(Measures, TakePerfusionFromTheUptakeWhereItIsKnown) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.gates = 1;
  patient.fwhm_mm = 14;
  patient.defect = synthetic::Defect::lateral;
  patient.defect_severity = 0.7;
  patient.defect_extent_deg = 130;
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  EXPECT_NEAR(phantom.axis.value().dot(axis_of(phantom)), 1, 1e-9);
  const Measures known = measure_truth_with_uptake(phantom), seen = measure_truth(phantom);
  EXPECT_EQ(known.perfusion_is, Perfusion::uptake);
  EXPECT_EQ(seen.perfusion_is, Perfusion::counts);
  // Segments 11 and 12 lie within the defect by 5 degrees, 8 and 9 opposite; the blur lends the defect activity.
  for (const std::size_t s : {11u, 12u}) {
    EXPECT_NEAR(known.segments[s - 1].perfusion_percent.value(), 30, 2) << s;
    EXPECT_GT(seen.segments[s - 1].perfusion_percent.value(), 35) << s;
  }
  for (const std::size_t s : {8u, 9u}) EXPECT_NEAR(known.segments[s - 1].perfusion_percent.value(), 100, 1e-6) << s;
}

TEST(Measures, TellNoOnsetWhereTheWallIsNotSeen) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.defect = synthetic::Defect::lateral;
  patient.defect_severity = 0.9;
  patient.defect_extent_deg = 130;
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  const Measures known = measure_truth_with_uptake(phantom), edges = measure_truth(phantom);
  ASSERT_TRUE(known.phase_motion && edges.phase_motion);
  EXPECT_LT(known.phase_motion->wall_share, 0.9 * edges.phase_motion->wall_share);
  for (const auto phase : {&SegmentMeasures::phase_motion_deg, &SegmentMeasures::phase_thickness_deg})
    for (const std::size_t s : {11u, 12u, 8u, 9u}) {
      EXPECT_EQ((known.segments[s - 1].*phase).has_value(), s < 10) << s;  // 11 and 12 lie within the defect
      EXPECT_TRUE((edges.segments[s - 1].*phase).has_value()) << s;
    }
}

TEST(Measures, KeepCountsFreeOfTheMovingValvePlane) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.fwhm_mm = 12;
  const Measures m = measure_truth(synthetic::make_phantom(synthetic::PhantomOptions{patient}));
  // All contract together. Counts next to the plane, which comes and goes, would spread to 20 degrees and more.
  EXPECT_LT(m.phase_counts.value().sd_deg, 6);
  for (const SegmentMeasures& s : m.segments)
    if (s.segment.number <= 6) {
      EXPECT_GT(s.count_thickening_percent.value(), 10) << s.segment.number;
    }
}

TEST(Measures, SeeAWallThatContractsLate) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.pose = {};
  patient.late_wall = synthetic::Defect::lateral;
  patient.late_extent_deg = 120;
  patient.delay_percent = 15;
  const Measures m = measure_truth(synthetic::make_phantom(synthetic::PhantomOptions{patient}));
  ASSERT_TRUE(m.phase_motion && m.phase_counts);
  const auto later = [&](auto phase, int late, int early) {
    return std::remainder((m.segments[static_cast<std::size_t>(late - 1)].*phase).value() -
                              (m.segments[static_cast<std::size_t>(early - 1)].*phase).value(),
                          360.0);
  };
  // 15 % of the beat are 54 degrees. Motion is geometry; counts are mixed across the sector's border by the blur.
  for (const auto& [late, early] : {std::pair(5, 2), {6, 3}, {11, 8}, {12, 9}}) {
    EXPECT_NEAR(later(&SegmentMeasures::phase_motion_deg, late, early), 54, 8) << late;
    EXPECT_NEAR(later(&SegmentMeasures::phase_counts_deg, late, early), 54, 14) << late;
  }
  EXPECT_GT(m.phase_motion->sd_deg, 18);
  EXPECT_GT(m.phase_motion->bandwidth_deg, 50);
}

TEST(Measures, TellOfABloodPoolWhatItsCavityTells) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.pose = {};
  patient.late_wall = synthetic::Defect::lateral;
  patient.late_extent_deg = 120;
  patient.delay_percent = 15;
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  MeasureInput input;
  input.axis = axis_of(phantom);
  input.cycle_ms = phantom.study.cycle_ms;
  for (std::size_t g = 0; g < phantom.truth.size(); ++g)
    input.gates.push_back({{&phantom.truth[g].endo}, {}, &phantom.study.gates[g], std::nullopt});
  const Measures pool = measure_walls(input, {}), both = measure_truth(phantom);
  EXPECT_TRUE(pool.cavity_alone);
  EXPECT_FALSE(both.cavity_alone);
  ASSERT_TRUE(pool.function && pool.phase_motion);
  EXPECT_EQ(pool.function->ef_percent, both.function->ef_percent);
  EXPECT_NEAR(pool.phase_motion->sd_deg, both.phase_motion->sd_deg, 2);
  for (std::size_t s = 0; s < 17; ++s) {
    SCOPED_TRACE(s + 1);
    // The frame begins half a wall lower where there is one, so the samples lie a little apart.
    EXPECT_NEAR(pool.segments[s].motion_mm.value(), both.segments[s].motion_mm.value(), 1);
    EXPECT_NEAR(std::remainder(*pool.segments[s].phase_motion_deg - *both.segments[s].phase_motion_deg, 360.0), 0, 8);
    EXPECT_FALSE(pool.segments[s].perfusion_percent || pool.segments[s].thickness_ed_mm ||
                 pool.segments[s].thickening_percent || pool.segments[s].count_thickening_percent ||
                 pool.segments[s].phase_counts_deg || pool.segments[s].phase_thickness_deg);
  }
  EXPECT_EQ(pool.perfusion_is, Perfusion::none);
  EXPECT_FALSE(pool.muscle_ml || pool.phase_counts || pool.phase_thickness);
  EXPECT_TRUE(pool.maps.perfusion_percent.empty() && pool.maps.thickness_ed_mm.empty());
  EXPECT_FALSE(pool.maps.motion_mm.empty());
  // At rest a cavity has nothing to map.
  input.gates.resize(1);
  EXPECT_TRUE(measure_walls(input, {}).segments.empty());
}

TEST(Measures, DoWithOneGateAndWithMissingSurfaces) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.gates = 1;
  const synthetic::Phantom phantom = synthetic::make_phantom(synthetic::PhantomOptions{patient});
  const Measures m = measure_truth(phantom);
  EXPECT_FALSE(m.function);
  EXPECT_FALSE(m.phase_counts);
  ASSERT_EQ(m.segments.size(), 17u);
  EXPECT_TRUE(m.segments[0].perfusion_percent && m.segments[0].thickness_ed_mm);
  EXPECT_FALSE(m.segments[0].motion_mm);

  MeasureInput input;
  input.gates.resize(2);
  input.gates[0] = {{}, {&phantom.truth[0].epi}, &phantom.study.gates[0], std::nullopt};
  const Measures none = measure_walls(input, {});
  EXPECT_TRUE(none.segments.empty());
  EXPECT_FALSE(none.muscle_ml);
}

TEST(Measures, AreTheSameForAnyNumberOfSegments) {
  synthetic::VirtualPatient patient = quick_patient();
  patient.gates = 1;
  const Measures m = measure_truth(synthetic::make_phantom(synthetic::PhantomOptions{patient}),
                                   {.segments = SegmentModel::segments20});
  ASSERT_EQ(m.segments.size(), 20u);
  for (const SegmentMeasures& s : m.segments) EXPECT_GT(s.perfusion_percent.value(), 40) << s.segment.number;
}

}  // namespace
}  // namespace dynasurf::ventricle
