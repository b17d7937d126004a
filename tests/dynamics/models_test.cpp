#include "dynasurf/dynamics/detail/models.hpp"

#include <cmath>
#include <sstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/dynamics/contour/detail/surface_curvature.hpp"
#include "dynasurf/dynamics/detail/coupled_motion.hpp"
#include "dynasurf/dynamics/detail/field_force.hpp"
#include "dynasurf/dynamics/evolve.hpp"
#include "dynasurf/dynamics/forces/forces.hpp"
#include "dynasurf/field/gvf.hpp"
#include "dynasurf/mesh/measures.hpp"

#include "support/shapes.hpp"

namespace dynasurf::dynamics {
namespace {

using namespace test_shapes;

const Vec3 kBallCentre(60, 58, 55);

struct BallScene {
  Image solid, border;
  field::VectorField field;
  TriMesh start;
};

/// A ball of 25 mm in a grid of 3 x 3 x 5 mm, and a start 1.5 times as large.
const BallScene& ball() {
  static const BallScene scene = [] {
    Grid g;
    g.dims = {40, 40, 23};
    g.spacing = {3, 3, 5};
    BallScene s;
    s.solid = filled(g, [](const Vec3& p) { return (p - kBallCentre).norm() <= 25; });
    s.border = border_of(s.solid);
    s.field = field::flow_field(s.border, field::Gvf{}).field;
    s.start = mesh::place(mesh::icosphere(2), s.border, {});
    return s;
  }();
  return scene;
}

double within_one_voxel(const TriMesh& mesh) {
  const auto d = mesh::distances_to_border_voxels(mesh, ball().border);
  return static_cast<double>(std::count_if(d.begin(), d.end(), [](double x) { return x < 1; })) /
         static_cast<double>(d.size());
}

EvolutionResult run(const Evolution& o, const Additions& own = {}) {
  const BallScene& s = ball();
  return evolve(s.start, s.field, s.border, o, {}, own);
}

std::vector<Evolution> all_models() {
  return {free_model(), spring_model(), restricted_spring_model(), plain_model(), curvature_model()};
}
std::string_view name_of_model(const Evolution& o) {
  return std::visit([](const auto& m) { return m.name; }, o.model);
}

// --- models

TEST(Models, FindTheBall) {
  // The free model has all its particles there; the others hold some back (thesis table 4.1).
  for (Evolution o : all_models()) {
    o.end.max_steps = 3000;
    const EvolutionResult r = run(o);
    EXPECT_NE(r.reason, StopReason::diverged) << name_of_model(o);
    if (std::holds_alternative<RestrictedSpringModel>(o.model)) continue;  // creeps across the field, see the next test
    const double least = std::holds_alternative<FreeModel>(o.model) ? 0.97 : 0.7;
    EXPECT_GE(within_one_voxel(r.mesh), least) << name_of_model(o);
  }
}

TEST(Models, StayWhereNothingPulls) {
  // At rest in the start mesh, without a field: an equilibrium.
  const BallScene& s = ball();
  for (Evolution o : {spring_model(), restricted_spring_model(), plain_model()}) {
    std::visit(
        [](auto& m) {
          if constexpr (requires { m.rest_scale; }) m.rest_scale = 1;
        },
        o.model);
    o.end.max_steps = 50;
    o.smooth_after.sweeps = 0;
    const EvolutionResult r = evolve(s.start, field::VectorField(s.field.grid), Image(s.field.grid), o);
    for (std::size_t v = 0; v < r.mesh.vertices.size(); ++v)
      ASSERT_LT((r.mesh.vertices[v] - s.start.vertices[v]).norm(), 1e-9) << name_of_model(o);
  }
}

TEST(Models, RestAtTheShareOfTheStartThatTheyName) {
  const BallScene& s = ball();
  const field::VectorField nothing(s.field.grid);
  std::vector<Vec3> smaller = s.start.vertices;
  for (Vec3& p : smaller) p = kBallCentre + 0.67 * (p - kBallCentre);
  const std::vector<Vec3> still(smaller.size(), Vec3::Zero());
  const auto strongest = [&](const ModelOptions& model, std::span<const Vec3> places) {
    double most = 0;
    std::vector<Vec3> sum(places.size(), Vec3::Zero());
    for (const Force& f : internal_forces(model, s.start, nothing, field::Sampling::nearest))
      f.accumulate({places, still}, sum);
    for (const Vec3& f : sum) most = std::max(most, f.norm());
    return most;
  };
  for (const Evolution& o : {spring_model(), restricted_spring_model(), plain_model()}) {
    EXPECT_LT(strongest(o.model, smaller), 1e-9) << name_of_model(o);
    EXPECT_GT(strongest(o.model, s.start.vertices), 0.1) << name_of_model(o);
  }
}

TEST(Models, ComeToRestAsTheyAreChosenByName) {
  // What `--set evolution.model=NAME` does: everything else is as for the free model.
  for (const Evolution& model : all_models()) {
    Evolution o;
    o.model = model.model;
    const EvolutionResult r = run(o);
    EXPECT_TRUE(r.reason == StopReason::all_stopped || r.reason == StopReason::at_rest) << name_of_model(o);
    EXPECT_LT(r.steps, 1500) << name_of_model(o);
    EXPECT_GE(within_one_voxel(r.mesh), 0.8) << name_of_model(o);
  }
}

TEST(Models, TakeTheSolverThatSuitsThem) {
  for (Evolution o : all_models()) {
    o.end.max_steps = 20;
    const bool is_stiff = !std::holds_alternative<FreeModel>(o.model);
    const EvolutionResult chosen = run(o);
    o.solver = is_stiff ? SolverOptions(BackwardEuler{}) : SolverOptions(Rk4{});
    EXPECT_TRUE(same_bytes(chosen.mesh, run(o).mesh)) << name_of_model(o);
    EXPECT_EQ(solver_for(o.model, Euler{}).index(), SolverOptions(Euler{}).index());
  }
}

TEST(Models, SayWhatKeptThemFromRest) {
  const auto last_note = [](const Evolution& o) {
    const EvolutionResult r = run(o);
    EXPECT_EQ(r.reason, StopReason::max_steps);
    return r.notes.empty() ? Note{} : r.notes.back();
  };
  Evolution o = spring_model();
  o.end.max_steps = 30;
  o.solver = Rk4{};
  EXPECT_EQ(last_note(o).code, "evolve.max_steps");
  EXPECT_NE(last_note(o).message.find("stability bounds the step"), std::string::npos) << last_note(o).message;
  o.solver = BackwardEuler{};
  o.end.max_steps = 5;
  EXPECT_EQ(last_note(o).message.find("stability"), std::string::npos) << last_note(o).message;
  Evolution free = free_model();
  free.end.max_steps = 30;
  free.force.drag = 1;
  EXPECT_NE(last_note(free).message.find("stability bounds the step"), std::string::npos) << last_note(free).message;
  free.force.drag = 0.1;  // the speed of the particles bounds the step
  EXPECT_EQ(last_note(free).message.find("stability"), std::string::npos) << last_note(free).message;
  free.step_s = 0.001;  // the user does
  EXPECT_EQ(last_note(free).message.find("stability"), std::string::npos) << last_note(free).message;
  o.end.max_steps = 30;
  o.solver = Rkf45{.tolerance = 1e-10};  // cuts its steps into thousands
  EXPECT_LT(run(o).steps, 30);
  EXPECT_NE(last_note(o).message.find("the solver had to cut them into 6"), std::string::npos) << last_note(o).message;
}

TEST(Models, ExplainTheStepThatTheyEndedWith) {
  // Triangles that shrink stiffen: the step of the curvature model falls, and its explanation with it.
  Evolution o = curvature_model();
  o.solver = Euler{};
  o.end.max_steps = 1;
  const EvolutionResult begun = run(o);
  o.end.max_steps = 300;
  const EvolutionResult ended = run(o);
  EXPECT_LT(ended.step_s, 0.5 * begun.step_s);
  std::ostringstream limit;
  limit << "0.8 of the largest stable one, " << ended.step_s / 0.8 << " s";
  EXPECT_EQ(ended.step_explained.substr(0, limit.str().size()), limit.str()) << ended.step_explained;
}

TEST(Models, CurvatureIsTheContoursForceAddedToTheFreeOne) {
  Evolution free = free_model();
  free.smooth_every = 0;
  Evolution curved = curvature_model();
  curved.model = CurvatureModel{.strength = 3};
  curved.solver = Rk4{};
  free.end.max_steps = curved.end.max_steps = 40;
  Additions own;
  own.forces.push_back(surface_curvature_force(ball().start, 3));
  const TriMesh model = run(curved).mesh, added = run(free, own).mesh;
  for (std::size_t v = 0; v < model.vertices.size(); ++v)
    ASSERT_LT((model.vertices[v] - added.vertices[v]).norm(), 1e-6);  // summed in another order
  EXPECT_FALSE(same_bytes(model, run(free).mesh));
}

TEST(Models, GiveTheSameBytesForAnyNumberOfThreads) {
  for (Evolution o : all_models()) {
    o.end.max_steps = 40;
    o.damping = BorderDrag{};
    std::optional<EvolutionResult> first;
    for (const int threads : {1, 2, 4}) {
      const ThreadLimit limit(threads);
      const EvolutionResult r = run(o);
      if (!first) first = r;
      EXPECT_TRUE(same_bytes(r.mesh, first->mesh)) << name_of_model(o);
    }
  }
}

TEST(Models, AreAllTakenByAllSolvers) {
  for (Evolution o : all_models())
    for (const SolverOptions& solver :
         {SolverOptions(Euler{}), SolverOptions(Midpoint{}), SolverOptions(Rk4{}), SolverOptions(StepDoubling{}),
          SolverOptions(Rkf45{}), SolverOptions(BackwardEuler{})}) {
      o.solver = solver;
      o.end.max_steps = 3;  // those that cut their steps make hundreds out of one of stiff springs
      const EvolutionResult r = run(o);
      const auto name = std::visit([](const auto& m) { return m.name; }, solver);
      EXPECT_EQ(r.reason, StopReason::max_steps) << name_of_model(o) << " " << name;
      for (const Vec3& p : r.mesh.vertices) ASSERT_TRUE(p.allFinite());
    }
}

TEST(Models, DoWhatTheFreeRunDoesWhenTheyHoldNothing) {
  // Springs without stiffness and damping are a free model: the coupled way must agree with the packed one.
  Evolution free = free_model(), loose = spring_model();
  free.smooth_every = 0;
  loose.model = SpringModel{.stiffness = 0, .damping = 0};
  loose.solver = Rk4{};
  const EvolutionResult a = run(free), b = run(loose);
  EXPECT_EQ(a.steps, b.steps);
  EXPECT_EQ(a.stopped, b.stopped);
  for (std::size_t v = 0; v < a.mesh.vertices.size(); ++v)
    ASSERT_LT((a.mesh.vertices[v] - b.mesh.vertices[v]).norm(), 1e-9);
}

TEST(Models, RestrictedSpringsGoWithTheFieldFasterThanSprings) {
  // Springs at rest in the start resist shrinking; restricted ones leave that direction to the field.
  Evolution spring = spring_model(), restricted = restricted_spring_model();
  spring.model = SpringModel{.rest_scale = 1};
  restricted.model = RestrictedSpringModel{.rest_scale = 1};
  spring.end.max_steps = restricted.end.max_steps = 1500;
  EXPECT_LT(mesh::volume_mm3(run(restricted).mesh), 0.8 * mesh::volume_mm3(run(spring).mesh));
}

// --- the step

TEST(AutomaticStep, IsStableForEveryModelAndExplicitSolver) {
  // Twice the step that it explains blows up, or at least it is told that it might.
  for (Evolution o : all_models())
    for (const SolverOptions& solver : {SolverOptions(Euler{}), SolverOptions(Midpoint{}), SolverOptions(Rk4{})}) {
      o.solver = solver;
      o.end.max_steps = 300;
      o.step_s = 0;
      const EvolutionResult r = run(o);
      EXPECT_NE(r.reason, StopReason::diverged) << name_of_model(o);
      if (std::holds_alternative<FreeModel>(o.model)) continue;
      ASSERT_FALSE(r.notes.empty());
      EXPECT_EQ(r.notes[0].code, "evolve.step_chosen");
      o.step_s = 5 * r.step_s;
      const EvolutionResult worse = run(o);
      EXPECT_EQ(worse.notes[0].code, "evolve.step_above_limit") << name_of_model(o);
    }
}

TEST(AutomaticStep, BlowsUpWhenItIsFarExceededAndKeepsTheLastGoodMesh) {
  Evolution o = spring_model();
  o.solver = Rk4{};
  o.stop.enabled = false;
  o.step_s = 20 * run(o).step_s;
  const EvolutionResult r = run(o);
  EXPECT_EQ(r.reason, StopReason::diverged);
  EXPECT_EQ(r.notes.back().code, "evolve.diverged");
  for (const Vec3& p : r.mesh.vertices) EXPECT_TRUE(p.allFinite());
}

TEST(AutomaticStep, IsExplainedForEveryModelAndSolver) {
  for (Evolution o : all_models())
    for (const SolverOptions& solver : {SolverOptions(Euler{}), SolverOptions(Rk4{}), SolverOptions(BackwardEuler{})}) {
      o.solver = solver;
      o.end.max_steps = 1;
      const std::string why = run(o).step_explained;
      EXPECT_TRUE(why.find("largest stable one") != std::string::npos || why.find("the field moves") == 0) << why;
    }
  Evolution o;
  o.end.max_steps = 1;
  o.force.strength = 1e-3;  // the field is slow: the drag decides
  EXPECT_NE(run(o).step_explained.find("the drag of 0.1 kg/s on particles of 0.00617"), std::string::npos)
      << run(o).step_explained;
  o.step_s = 0.01;
  EXPECT_EQ(run(o).step_explained.find("given; stable are up to 0.17"), 0U) << run(o).step_explained;
}

TEST(AutomaticStep, IsRefusedWhereEveryStepGrows) {
  Evolution o = spring_model();
  o.model = SpringModel{.damping = 0};
  o.solver = Euler{};
  o.force.drag = 0;
  EXPECT_THROW(run(o), OptionError);
}

TEST(AutomaticStep, HoldsForSpringsByTrying) {
  // The limit that the forces' slopes give, against the step at which a shaken sphere really begins to swing up.
  const TriMesh m = mapped(mesh::icosphere(2), [](const Vec3& p) { return Vec3(30 * p); });
  for (const SolverOptions& solver : {SolverOptions(Midpoint{}), SolverOptions(Rk4{})})
    for (const auto& [stiffness, damping] : {std::pair{0.0, 1.0}, {100.0, 0.0}}) {
      const std::vector<Force> forces{spring_force(springs_of(m), {stiffness, damping}), drag_force(0.1)};
      const double limit = CoupledMotion(m, 1, forces, solver).limit(0.1).step_s;
      const auto swings_up = [&](double h) {
        ParticleSystem system = particles_at(m.vertices, 1);
        system.forces = forces;
        for (std::size_t p = 0; p < system.size(); ++p) system.velocities[p] = 1e-6 * Vec3(p % 2, p % 3, p % 5);
        ParticleSolver stepper(solver);
        for (int s = 0; s < 400; ++s) stepper.step(system, h);
        return !(kinetic_energy(system) < 1e-10);  // at the start: 4e-12
      };
      EXPECT_FALSE(swings_up(0.95 * limit)) << stiffness;
      EXPECT_TRUE(swings_up(1.5 * limit)) << stiffness;
    }
}

// --- drag maps

TEST(DragMaps, RaiseTheDragWhereTheySay) {
  const BallScene& s = ball();
  const Image by_field = drag_by_field(s.field, 0.1, 10), hard = drag_near_border(s.border, 0.1, 10, 1);
  EXPECT_NEAR(*std::max_element(by_field.values.begin(), by_field.values.end()), 1.1, 1e-6);
  Image grey(s.solid.grid);
  grey(3, 3, 3) = 2;
  grey(4, 4, 4) = 1;
  grey(5, 5, 5) = -7;
  const Image by_intensity = drag_by_intensity(grey, 0.1, 10);
  EXPECT_FLOAT_EQ(by_intensity(3, 3, 3), 1.1F);
  EXPECT_FLOAT_EQ(by_intensity(4, 4, 4), 0.6F);
  EXPECT_FLOAT_EQ(by_intensity(5, 5, 5), 0.1F);
  for (std::size_t v = 0; v < hard.values.size(); ++v) {
    if (s.border.values[v] != 0) {
      ASSERT_FLOAT_EQ(hard.values[v], 1.1F);
    }
  }
  const Index3 far{0, 0, 0};
  EXPECT_NEAR(hard(far[0], far[1], far[2]), 0.1, 1e-4);
  const Image from_one = drag_near_border(grey, 0.1, 10, 2);  // (3, 3, 3), (4, 4, 4) and (5, 5, 5)
  EXPECT_FLOAT_EQ(from_one(5, 5, 11), static_cast<float>(0.1 * (1 + 10 * std::exp(-3.0))));
  EXPECT_FALSE(drag_map(UniformDrag{}, s.field, s.border, 0.1));
  EXPECT_EQ(drag_map(IntensityDrag{}, s.field, s.border, 0.1, [&] { return grey; })->values, by_intensity.values);
  EXPECT_THROW(drag_map(IntensityDrag{}, s.field, s.border, 0.1), OptionError);
  EXPECT_EQ(drag_map(BorderDrag{}, s.field, s.border, 0.1)->values, hard.values);
}

TEST(DragMaps, SoftenTheOscillationAndOnlyTheStopEndsIt) {
  // A heavy particle swings about a plane at x = 60 mm (thesis fig. 6.10): the largest distance from it late in the
  // run.
  Grid g;
  g.dims = {60, 5, 5};
  g.spacing = {2, 2, 2};
  Image plane(g);
  for (int k = 0; k < 5; ++k)
    for (int j = 0; j < 5; ++j) plane(30, j, k) = 1;
  const field::VectorField field = field::flow_field(plane, field::Gvf{}).field;
  const auto late_amplitude = [&](const DampingOptions& damping, bool stops, const Additions& own) {
    Evolution o;
    o.force.drag = 0.02;
    o.damping = damping;
    o.stop.enabled = stops;
    o.step_s = 0.05;
    o.end = {.still_share = 1, .still_move = 0, .still_radius = 0, .max_steps = 0};
    double largest = 0;
    for (o.end.max_steps = 600; o.end.max_steps < 1000; o.end.max_steps += 10) {
      const EvolutionResult r = evolve({{{48, 4, 4}}, {}}, field, plane, o, {}, own);
      largest = std::max(largest, std::abs(r.mesh.vertices[0][0] - 60));
    }
    return largest;
  };
  Additions by_intensity;
  by_intensity.drag = drag_by_intensity(plane, 0.02);
  const double none = late_amplitude(UniformDrag{}, false, {});
  EXPECT_GT(none, 2);  // a voxel
  for (const double softened : {late_amplitude(FieldDrag{}, false, {}), late_amplitude(BorderDrag{}, false, {}),
                                late_amplitude(UniformDrag{}, false, by_intensity)}) {
    EXPECT_LT(softened, 0.7 * none);
    EXPECT_GT(softened, 1e-3);  // it still swings
  }
  EXPECT_NEAR(late_amplitude(UniformDrag{}, true, {}), 1, 1e-9);  // stands on the face of the voxel
}

TEST(DragMaps, BrakeFreeAndCoupledParticlesAlike) {
  const BallScene& s = ball();
  const Image map = drag_near_border(s.border, 0.1);
  const Derivative motion = free_motion(s.field, {.strength = 10, .drag = 0.1}, 0.5, &map);
  ParticleSystem system = particles_at(s.start.vertices, 0.5 * static_cast<double>(s.start.vertices.size()));
  system.forces = {field_pull(s.field, 10), drag_force(map)};
  for (Vec3& p : system.positions) p = kBallCentre + 0.7 * (p - kBallCentre);
  for (std::size_t p = 0; p < system.size(); ++p) system.velocities[p] = Vec3(1, 2, 3);
  std::vector<Vec3> force(system.size());
  total_force(system.forces, system.state(), force);
  for (std::size_t p = 0; p < system.size(); ++p) {
    const Vec3& x = system.positions[p];
    const std::vector<double> y{x[0], x[1], x[2], 1, 2, 3};
    std::vector<double> dydt(6);
    motion(y, dydt);
    EXPECT_LT((Vec3(dydt[3], dydt[4], dydt[5]) - force[p] / 0.5).norm(), 1e-12);
  }
}

// --- what callers add

TEST(OwnForce, ActsNextToTheModel) {
  const Force lift{"lift", [](const ParticleState&, std::span<Vec3> forces) {
                     for (Vec3& f : forces) f[2] += 2;
                   }};
  Additions own;
  own.forces.push_back(lift);
  for (Evolution o : all_models()) {
    o.end.max_steps = 60;
    o.step_s = 0.005;
    o.solver = BackwardEuler{};
    const auto height = [](const TriMesh& m) {
      double sum = 0;
      for (const Vec3& p : m.vertices) sum += p[2];
      return sum / static_cast<double>(m.vertices.size());
    };
    EXPECT_GT(height(run(o, own).mesh), height(run(o).mesh) + 1) << name_of_model(o);
  }
}

TEST(OwnStop, HoldsParticlesAtAPlaneOfTheCaller) {
  Additions own;
  own.stop = [](const Vec3& from, const Vec3& to) -> std::optional<Vec3> {
    if (to[2] >= 40 || from[2] < 40) return std::nullopt;  // falls through the plane z = 40 from above
    return Vec3(from + (from[2] - 40) / (from[2] - to[2]) * (to - from));
  };
  Grid g;
  g.dims = {20, 20, 60};
  field::VectorField down(g);
  std::fill(down.z.begin(), down.z.end(), -0.2F);
  Image border(g);
  border(5, 5, 45) = 1;  // the border comes first for a particle above it
  const TriMesh three{{{5, 5, 55}, {9, 9, 50}, {12, 3, 30}}, {}};
  const EvolutionResult r = evolve(three, down, border, {}, {}, own);
  EXPECT_NEAR(r.mesh.vertices[0][2], 45.5, 1e-9);
  EXPECT_NEAR(r.mesh.vertices[1][2], 40, 1e-9);
  EXPECT_LT(r.mesh.vertices[2][2], 0);
  EXPECT_EQ(r.stopped, (std::vector<std::uint8_t>{1, 1, 0}));
}

TEST(Additions, AreRefusedWhenTheyCannotBeUsed) {
  Additions empty, small, negative;
  empty.forces.push_back(Force{"empty"});
  Grid other;
  other.dims = {2, 2, 2};
  small.drag = Image(other);
  negative.drag = Image(ball().field.grid, -1.0F);
  EXPECT_THROW(run({}, empty), InputError);
  EXPECT_THROW(run({}, small), InputError);
  EXPECT_THROW(run({}, negative), InputError);
}

}  // namespace
}  // namespace dynasurf::dynamics
