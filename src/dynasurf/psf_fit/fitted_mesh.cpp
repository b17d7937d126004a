#include "dynasurf/psf_fit/detail/fitted_mesh.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/statistics.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/mesh/measures.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"
#include "dynasurf/psf_fit/detail/papillary_share.hpp"
#include "dynasurf/psf_fit/detail/wall_posterior.hpp"

namespace dynasurf::psf_fit {
namespace {

constexpr int wall_rings = 24, lid_rings = 6, around = 48;

/// The walls of one gate as functions of the direction.
class Walls {
 public:
  Walls(const BeatProblem& problem, const Eigen::VectorXd& gate, double cavity_share, double wall_share)
      : layout_(problem.layout.gate),
        frame_(problem.cells.frame),
        gate_(gate),
        cavity_share_(cavity_share),
        wall_share_(wall_share),
        harmonics_(harmonics_up_to(std::max({layout_.endo_degree, layout_.wall_degree, layout_.uptake_degree}))) {}

  struct Ray {
    double endo = 0, epi = 0, uptake = 0;
  };
  Ray along(const Vec3& direction) {
    real_spherical_harmonics(direction, std::max({layout_.endo_degree, layout_.wall_degree, layout_.uptake_degree}),
                             harmonics_);
    Ray ray = walls_here();
    ray.uptake = own::exp(field(layout_.uptake, layout_.uptake_degree));
    return ray;
  }
  /// Without the uptake, which has finer harmonics.
  Ray walls_along(const Vec3& direction) {
    real_spherical_harmonics(direction, std::max(layout_.endo_degree, layout_.wall_degree), harmonics_);
    return walls_here();
  }
  Vec3 point(const Vec3& direction, double q) const { return (q * direction).cwiseProduct(frame_.scale); }
  double above_base(const Vec3& heart) const {
    return heart[2] - gate_[layout_.plane] - gate_[layout_.plane + 1] * heart[0] - gate_[layout_.plane + 2] * heart[1];
  }
  const HeartFrame& frame() const { return frame_; }

 private:
  Ray walls_here() const {
    const double cavity = own::exp(3 * field(layout_.endo, layout_.endo_degree));
    const double muscle = own::exp(field(layout_.wall, layout_.wall_degree));
    return {own::cbrt(reported_cavity(cavity, muscle, cavity_share_)), own::cbrt(cavity + wall_share_ * muscle), 0};
  }
  double field(int first, int degree) const {
    double sum = 0;
    for (int k = 0; k < harmonics_up_to(degree); ++k) sum += gate_[first + k] * harmonics_[k];
    return sum;
  }
  const GateLayout& layout_;
  const HeartFrame& frame_;
  const Eigen::VectorXd& gate_;
  double cavity_share_, wall_share_;  // of the muscle, within the inner and within the outer wall
  std::vector<double> harmonics_;
};

Vec3 direction_at(double from_apex, double angle) {
  return {own::sin(from_apex) * own::cos(angle), own::sin(from_apex) * own::sin(angle), -own::cos(from_apex)};
}

/// Angle from the apex at which a wall meets the base plane, going up along one meridian.
double rim_angle(Walls& walls, double angle, bool outer) {
  const auto above = [&](double from_apex) {
    const Vec3 d = direction_at(from_apex, angle);
    const Walls::Ray ray = walls.walls_along(d);
    return walls.above_base(walls.point(d, outer ? ray.epi : ray.endo));
  };
  constexpr double step = M_PI / 36;
  double low = M_PI / 4, high = low;
  while (high < 0.97 * M_PI && above(high) < 0) low = high, high += step;
  for (int n = 0; n < 40; ++n) {
    const double middle = (low + high) / 2;
    (above(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::vector<std::array<std::uint32_t, 3>> triangles() {
  std::vector<std::array<std::uint32_t, 3>> list;
  const auto vertex = [](int ring, int segment) -> std::uint32_t { return 1 + (ring - 1) * around + segment % around; };
  constexpr int last = wall_rings + lid_rings - 1;
  const std::uint32_t top = 1 + last * around;
  for (int s = 0; s < around; ++s) {
    list.push_back({0, vertex(1, s + 1), vertex(1, s)});
    for (int r = 1; r < last; ++r) {
      list.push_back({vertex(r, s), vertex(r, s + 1), vertex(r + 1, s)});
      list.push_back({vertex(r, s + 1), vertex(r + 1, s + 1), vertex(r + 1, s)});
    }
    list.push_back({vertex(last, s), vertex(last, s + 1), top});
  }
  return list;
}

/// One wall of one gate, world frame, and the uptake at its vertices.
TriMesh wall_mesh(Walls& walls, bool outer, const Grid& grid, std::vector<double>* uptake) {
  TriMesh mesh;
  const auto add = [&](const Vec3& heart, double activity) {
    mesh.vertices.push_back(to_world(grid, walls.frame().from_heart(heart)));
    if (uptake) uptake->push_back(activity);
  };
  std::vector<double> rims;
  rims.reserve(around);
  for (int s = 0; s < around; ++s) rims.push_back(rim_angle(walls, 2 * M_PI * s / around, outer));
  const Walls::Ray apex = walls.along({0, 0, -1});
  add(walls.point({0, 0, -1}, outer ? apex.epi : apex.endo), apex.uptake);
  std::vector<Vec3> rim_points;
  for (int r = 1; r <= wall_rings; ++r)
    for (int s = 0; s < around; ++s) {
      const Vec3 d = direction_at(rims[s] * r / wall_rings, 2 * M_PI * s / around);
      const Walls::Ray ray = uptake ? walls.along(d) : walls.walls_along(d);
      const Vec3 p = walls.point(d, outer ? ray.epi : ray.endo);
      add(p, ray.uptake);
      if (r == wall_rings) rim_points.push_back(p);
    }
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : rim_points) middle += p / around;
  for (int r = 1; r < lid_rings; ++r)
    for (int s = 0; s < around; ++s) add(rim_points[s] + (middle - rim_points[s]) * r / lid_rings, 0);
  add(middle, 0);
  mesh.triangles = triangles();
  if (grid.direction.determinant() * walls.frame().axes.determinant() < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

/// Area of a wall without its lid, mm2.
double open_area(const TriMesh& mesh) {
  TriMesh open = mesh;
  const std::uint32_t rim_end = 1 + wall_rings * around;
  std::erase_if(open.triangles, [rim_end](const auto& t) { return std::max({t[0], t[1], t[2]}) >= rim_end; });
  return mesh::area_mm2(open);
}

double spread_of(const Eigen::VectorXd& gradient, const Cholesky& factor) { return factor.half_norm(gradient); }

/// The normal matrix knows of noise, not of hearts and cameras that differ from the model. Its deviations times a
/// factor of 1.3, a part that no counting takes away, and papillary muscles of unknown size hold the truth in about
/// 90 % of the choosing patients of experiments/unbiased_200.
void allow_for_model(heart::Estimate& e, double factor, double least, double papillary = 0) {
  e.sd = own::hypot(factor * e.sd, least, papillary);
}

/// Of the vertices below the base.
std::vector<double> uptake_of_wall(const FittedBeat& beat) {
  return {beat.uptake.begin(), beat.uptake.begin() + 1 + wall_rings * around};
}

/// Area of the inner wall that is not seen, mm2: each triangle by what its activity lacks of the faintest healthy
/// muscle's.
double unseen_area(const FittedBeat& beat, const TriMesh& endo) {
  constexpr double healthy_share = 0.8;  // quantile: most of a wall may be missing
  constexpr double uneven = 0.75;        // what healthy walls have at least
  const std::vector<double> wall = uptake_of_wall(beat);
  const double healthy = quantile(wall, healthy_share);
  double area = 0;
  for (const auto& t : endo.triangles) {
    if (std::max({t[0], t[1], t[2]}) >= wall.size()) continue;
    const Vec3 across = (endo.vertices[t[1]] - endo.vertices[t[0]]).cross(endo.vertices[t[2]] - endo.vertices[t[0]]);
    const double seen = (beat.uptake[t[0]] + beat.uptake[t[1]] + beat.uptake[t[2]]) / (3 * uneven * healthy);
    area += 0.5 * across.norm() * std::max(0.0, 1 - seen);
  }
  return area;
}

/// The matrix takes the edge of a defect for as smooth as harmonics are, and so believes to know where the wall goes on
/// unseen. That wall is allowed to lie off by some millimetres, and half as much from gate to gate; chosen on the
/// defects among patients 0 to 144 and 198 to 249 of experiments/unbiased_200.
void allow_for_unseen_wall(FittedBeat& beat) {
  constexpr double off_mm = 2.75, beating_mm = off_mm / 2, ml_per_mm3 = 1e-3;
  const auto widen = [](heart::Estimate& e, double by) { e.sd = own::hypot(e.sd, by); };
  const auto unseen = [&](int g) { return ml_per_mm3 * unseen_area(beat, beat.gates[g].endo); };
  for (std::size_t g = 0; g < beat.gates.size(); ++g) {
    const double off_ml = off_mm * unseen(g);
    widen(beat.gates[g].endo_ml, off_ml), widen(beat.gates[g].epi_ml, off_ml);
  }
  const double relaxed = unseen(beat.ed_gate), contracted = unseen(beat.es_gate);
  widen(beat.edv_ml, off_mm * relaxed), widen(beat.esv_ml, off_mm * contracted);
  widen(beat.sv_ml, beating_mm * contracted);
  if (beat.ef_percent) widen(*beat.ef_percent, 100 * beating_mm * contracted / beat.edv_ml.value);
}

/// Papillary muscles keep their volume over the beat: they change both volumes alike, and not what is put out.
void allow_for_model(FittedBeat& beat, const Corrections& known, double papillary_ml) {
  const double factor = known.model_factor;
  const auto share = [factor](heart::Estimate& e, double of_value, double papillary) {
    allow_for_model(e, factor, of_value * std::abs(e.value), papillary);
  };
  constexpr double of_volume = 0.009, of_ef = 0.3;  // the last in points
  for (FittedGate& gate : beat.gates) share(gate.endo_ml, of_volume, papillary_ml), share(gate.epi_ml, of_volume, 0);
  share(beat.edv_ml, of_volume, papillary_ml), share(beat.esv_ml, of_volume, papillary_ml);
  share(beat.sv_ml, of_volume, 0);
  if (beat.ef_percent)
    allow_for_model(*beat.ef_percent, factor, of_ef, beat.ef_percent->value * papillary_ml / beat.edv_ml.value);
  share(beat.wall_ml, known.wall_error, papillary_ml), share(beat.thickness_mm, known.wall_error, 0);
}

/// Derivatives of the volumes of every gate, mL, by all unknowns.
struct VolumeGradients {
  std::vector<Eigen::VectorXd> cavity, wall;
};

/// Surfaces, valve plane and volumes of one gate.
void describe_gate(const BeatProblem& problem, const Solution& solution, const Grid& grid, const Cholesky& factor,
                   std::size_t g, VolumeGradients& by, FittedBeat& beat) {
  const BeatLayout& layout = problem.layout;
  const double cavity_share = problem.reported.cavity_share(g), wall_share = 1 - problem.reported.beyond;
  Eigen::VectorXd numbers = layout.at_gate(g, solution.unknowns);
  numbers[layout.gate.endo] += problem.reported.outwards[g];
  Walls walls(problem, numbers, cavity_share, wall_share);
  FittedGate& gate = beat.gates[g];
  gate.endo = wall_mesh(walls, false, grid, g == 0 ? &beat.uptake : nullptr);
  gate.epi = wall_mesh(walls, true, grid, nullptr);
  gate.endo_ml.value = mesh::volume_mm3(gate.endo) / 1000;
  gate.epi_ml.value = mesh::volume_mm3(gate.epi) / 1000;
  const HeartFrame& frame = walls.frame();
  const Vec3 normal = Vec3(-numbers[layout.gate.plane + 1], -numbers[layout.gate.plane + 2], 1).normalized();
  gate.base.point = to_world(grid, frame.from_heart({0, 0, numbers[layout.gate.plane]}));
  gate.base.normal = grid.direction * (frame.axes * normal);
  const Activity& activity = solution.objective.activity[g];
  const auto of_beat = [&](double cavity, double muscle) {
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(layout.unknowns);
    layout.add_gradient(g, backpropagate(problem.cells, layout.gate, numbers, activity, {}, cavity, muscle) / 1000,
                        gradient);
    return gradient;
  };
  by.cavity[g] = of_beat(1, cavity_share);
  by.wall[g] = of_beat(0, wall_share - cavity_share);
  gate.endo_ml.sd = spread_of(by.cavity[g], factor);
  gate.epi_ml.sd = spread_of(by.cavity[g] + by.wall[g], factor);
}

/// Volumes of the beat: of its largest and its smallest gate, and of the wall.
void describe_volumes(const VolumeGradients& by, const Cholesky& factor, FittedBeat& beat) {
  const std::size_t gates = beat.gates.size();
  std::vector<double> wall;
  for (const FittedGate& gate : beat.gates) wall.push_back(gate.epi_ml.value - gate.endo_ml.value);
  Eigen::VectorXd mean_wall = Eigen::VectorXd::Zero(by.wall[0].size());
  for (std::size_t g = 0; g < gates; ++g) {
    beat.wall_ml.value += wall[g] / gates;
    mean_wall += by.wall[g] / (1.0 * gates);
    if (beat.gates[g].endo_ml.value > beat.gates[beat.ed_gate].endo_ml.value) beat.ed_gate = g;
    if (beat.gates[g].endo_ml.value < beat.gates[beat.es_gate].endo_ml.value) beat.es_gate = g;
  }
  beat.wall_ml.sd = spread_of(mean_wall, factor);
  double variance = 0;
  for (const double w : wall) variance += own::pow(w - beat.wall_ml.value, 2) / gates;
  beat.wall_variation = std::sqrt(variance) / std::max(1e-9, beat.wall_ml.value);
  const std::size_t ed = beat.ed_gate, es = beat.es_gate;
  beat.edv_ml = beat.gates[ed].endo_ml, beat.esv_ml = beat.gates[es].endo_ml;
  beat.sv_ml = {beat.edv_ml.value - beat.esv_ml.value, spread_of(by.cavity[ed] - by.cavity[es], factor)};
  if (gates > 1 && beat.edv_ml.value > 0) {
    const double edv = beat.edv_ml.value, esv = beat.esv_ml.value;
    const Eigen::VectorXd by_ef = 100 * (esv / (edv * edv) * by.cavity[ed] - by.cavity[es] / edv);
    beat.ef_percent = heart::Estimate{100 * (edv - esv) / edv, spread_of(by_ef, factor)};
  }
}

/// Thickness of the wall, width of the point spread (of its log, until the width is known), levels of activity.
void describe_levels(const BeatProblem& problem, const Solution& solution, const Cholesky& factor, FittedBeat& beat) {
  const BeatLayout& layout = problem.layout;
  const FittedGate& relaxed = beat.gates[beat.ed_gate];
  const double area = 0.5 * (open_area(relaxed.endo) + open_area(relaxed.epi));
  beat.thickness_mm.value = 1000 * (relaxed.epi_ml.value - relaxed.endo_ml.value) / std::max(1.0, area);
  beat.thickness_mm.sd = beat.thickness_mm.value * beat.wall_ml.sd / std::max(1e-9, beat.wall_ml.value);
  Eigen::VectorXd by_width = Eigen::VectorXd::Zero(layout.unknowns);
  for (const BeatLayout::Term& t : layout.terms[0][layout.gate.width]) by_width[t.unknown] = t.factor;
  beat.fwhm_mm.sd = spread_of(by_width, factor);
  const Eigen::VectorXd first = layout.at_gate(0, solution.unknowns);
  // Activities are told in units of the mean of the healthy half of the wall.
  const double healthy = std::max(1e-9, upper_median(uptake_of_wall(beat)));
  for (double& u : beat.uptake) u /= healthy;
  beat.cavity = first[layout.gate.cavity] / healthy, beat.background = first[layout.gate.background] / healthy;
}

/// Of the muscle of each gate, what the volumes within the edges make of it; see ReportedWalls.
std::vector<double> edge_share(const std::vector<Activity>& gates, const ReportedWalls& reported,
                               const Corrections& known) {
  std::vector<double> cavity_ml, share;
  for (std::size_t g = 0; g < gates.size(); ++g)
    cavity_ml.push_back(
        (gates[g].cavity_mm3 * own::exp(3 * reported.outwards[g]) + reported.papillary_share * gates[g].wall_mm3) /
        1000);
  const std::vector<double> moved_ml = towards_edges(cavity_ml, known.edge_ml, known.edges);
  for (std::size_t g = 0; g < gates.size(); ++g)
    share.push_back(1000 * (moved_ml[g] - cavity_ml[g]) / std::max(1.0, gates[g].wall_mm3));
  return share;
}

}  // namespace

ReportedWalls reported_walls(const BeatProblem& problem, const Solution& solution, const Corrections& known) {
  const std::vector<Activity>& gates = solution.objective.activity;
  double largest = 0;
  for (const Activity& gate : gates) largest = std::max(largest, gate.cavity_mm3);
  ReportedWalls reported;
  reported.beyond = known.beyond;
  for (const Activity& gate : gates)
    reported.outwards.push_back(largest > 0 ? known.near_by_contraction * (1 - gate.cavity_mm3 / largest) : 0);
  const Cholesky of_steps(solution.matrix.whole(problem.noise));
  reported.papillary_share = papillary_share(problem, solution, of_steps, known.papillary_share);
  if (!known.edge_ml.empty()) reported.edge_share = edge_share(gates, reported, known);
  return reported;
}

void describe_beat(const BeatProblem& problem, const Solution& solution, const Corrections& known, const Grid& grid,
                   FittedBeat& beat) {
  const BeatLayout& layout = problem.layout;
  beat.rings = wall_rings, beat.segments = around;
  const Cholesky factor(solution.matrix.whole(known.noise));
  const std::size_t gates = layout.gates;
  VolumeGradients by{std::vector<Eigen::VectorXd>(gates), std::vector<Eigen::VectorXd>(gates)};
  beat.gates.resize(gates);
  parallel_for(gates, 1,
               [&](std::size_t g, std::size_t) { describe_gate(problem, solution, grid, factor, g, by, beat); });
  describe_volumes(by, factor, beat);
  describe_levels(problem, solution, factor, beat);
  // Standard deviation of the papillary muscles' volume over what is believed of it. Hearts differ in it by 2 % of the
  // muscle (1.8 to 2.6 %: Gommans et al., Neth Heart J 24:326, 2016).
  constexpr double papillary_doubt = 1.25;
  const double papillary = problem.reported.papillary_share;
  allow_for_model(beat, known, papillary_doubt * papillary / (1 - papillary) * beat.wall_ml.value);
  allow_for_unseen_wall(beat);
  tell_belief_from_data(problem, solution, factor, beat);
  beat.posterior = std::make_shared<const WallPosterior>(problem, solution.unknowns, grid, factor);
}

}  // namespace dynasurf::psf_fit
