#include "dynasurf/field/steady.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/field/detail/gradient.hpp"
#include "dynasurf/field/multigrid/detail/hierarchy.hpp"

namespace dynasurf::field {

using multigrid::Hierarchy;
using multigrid::Level;
using multigrid::Stage;

struct SteadyWorkspace::Levels {
  std::vector<Level> levels;
};

namespace {

// Errors are largest and roughest beside the data, where further sweeps are cheap. Black cells come last before a
// restriction, which expects them to have no residual.
constexpr Stage finish[] = {Stage::correct_black, Stage::red_measured,    Stage::black,
                            Stage::red_near_data, Stage::black_near_data, Stage::copy_out};
constexpr Stage copy[] = {Stage::copy_out};
constexpr Stage finish_and_resume[] = {Stage::correct_black, Stage::red_measured,     Stage::black,
                                       Stage::red_near_data, Stage::black_near_data,  Stage::red,
                                       Stage::black,         Stage::restrict_residual};

/// How much the last cycle changed the field, relative to it. Red cells are not corrected but follow their corrected
/// neighbours, so the change of the first red sweep is that of the whole cycle.
double relative_change(const Level& finest) {
  double change = 0, size = 0;
  for (double c : finest.change) change += c;
  for (double s : finest.size) size += s;
  return size > 0 ? std::sqrt(change / size) : 0;
}

/// Turns changes into errors. A cycle leaves a share of what it changed, and that share depends on little: on the
/// strength of the data and on how many cycles there were, since what is left shrinks more slowly at last than at
/// first.
struct Estimate {
  bool strong = false, small = false;
  double rounding = 0;  // relative error that single precision leaves
  double change = 0, rate = 0;
  int cycle = 0;
  bool begun_in_box = false;

  Estimate(const Level& finest, const multigrid::DataStrength& data) {
    double diffusion = 0;
    for (const multigrid::Axis& a : finest.axis)
      if (a.count > 1) diffusion += 2 / (a.nominal * a.nominal);
    // A mode of the whole field is held by the mean data term alone, against the rounding of every voxel's diffusion;
    // as measured, a little less than chance makes of it.
    rounding = 5e-7 + 4e-8 * diffusion / (data.mean * std::sqrt(static_cast<double>(finest.cells())));
    strong = data.largest > 2 * diffusion;
    small = finest.cells() < 20000;
  }

  /// A first cycle, in a box around the data alone, changed it by so much.
  void start_after(double box_change) {
    change = box_change;
    cycle = 1;
    begun_in_box = true;
  }

  /// What is left after a cycle that changed the field by `now`. The shares are a tenth or more above the largest seen
  /// on random maps of all kinds; half of the errors are a fifth of what is reported or less. A change below a fortieth
  /// of the one before was small by chance; where cycles shrink the error slowly, the rate decides.
  double error_after(double now) {
    constexpr std::array<double, 4> weak_shares{0.3, 0.19, 0.46, 0.46}, strong_shares{0.45, 0.38, 0.5, 0.65};
    const double before = std::exchange(change, now), rate_before = rate;
    const std::size_t at = std::min(cycle++, 3);
    double share = strong ? strong_shares[at] : weak_shares[at];
    if (begun_in_box && at == 1) share = strong ? 0.55 : 0.31;
    if (small) share *= 2;
    if (before > 0) {
      rate = now / before;
      const double slower = std::min(std::max(rate, rate_before), 0.9);
      share = std::max(share, 1.3 * slower / (1 - slower));
    }
    return std::max(now, (begun_in_box ? 0.02 : 0.025) * before) * share + rounding;
  }
};

/// The correction of the voxels is stretched a little: the averaged data term of the coarser level holds it back. On
/// every level it would add up, and a field that is smooth on all of them would swing for ever. Careful: where strong
/// data close in a few long voxels, coarse levels overshoot by more than they gain.
void set_stretch(std::vector<Level>& levels, bool careful) {
  for (Level& l : levels) l.stretch = careful ? (l.finest ? 1.0f : 0.75f) : (l.finest ? 1.05f : 1.0f);
}

/// Cycles until the estimated error is below the tolerance or rounding ends the progress (near 1e-6). False, and no
/// result, where cycles take the field away from its place or swing about it; careful ones do not.
bool iterate(Hierarchy& h, Estimate estimate, double tolerance, int most_cycles, bool careful, FlowResult& r,
             const Progress& progress) {
  r.iterations = 0;
  const bool one_done = h.start_voxels();
  if (one_done) estimate.start_after(relative_change(h.levels[0]));
  double error = one_done ? 0.05 : 1;  // no more than a guess
  for (int stalled = 0;;) {
    progress.check();
    h.correct(0, 0);
    ++r.iterations;
    const bool certainly_more = 0.01 * error > tolerance && r.iterations < most_cycles;
    h.run(0, certainly_more ? std::span<const Stage>(finish_and_resume) : std::span<const Stage>(finish));
    error = estimate.error_after(relative_change(h.levels[0]));
    if (!careful && r.iterations > 2 && estimate.change > 0.1 && estimate.rate > 0.7) return false;
    stalled = estimate.rate > (careful ? 0.95 : 0.7) ? stalled + 1 : 0;
    if (!careful && stalled == 3 && error > std::max(tolerance, 100 * estimate.rounding)) return false;
    progress("field", r.iterations, most_cycles);
    if (error < tolerance || r.iterations == most_cycles || stalled == 3) {
      if (certainly_more) h.run(0, copy);
      break;
    }
    if (!certainly_more) h.run(0, multigrid::resume);
  }
  r.error = error;
  if (error < tolerance) return true;
  TextOutput text;
  text << "the steady field was left at an estimated relative error of " << error << " after " << r.iterations
       << " cycles; asked for was " << tolerance;
  r.notes.push_back({Severity::warning, "steady.tolerance_missed", text.str()});
  return true;
}

void prepare(const Image& map, FlowResult& r) {
  detail::check_grid(map);
  const bool fits =
      r.field.x.size() == map.grid.size() && r.field.y.size() == map.grid.size() && r.field.z.size() == map.grid.size();
  VectorField field = fits ? std::move(r.field) : VectorField(map.grid);
  field.grid = map.grid;
  r = FlowResult{};
  r.field = std::move(field);
}

void set_zero(VectorField& f) {
  for (auto* c : {&f.x, &f.y, &f.z}) std::fill(c->begin(), c->end(), 0.0f);
}

void solve(const Image& map, const Vec3& rates, const multigrid::DataTerm& term, double tolerance, int most_cycles,
           SteadyWorkspace& w, FlowResult& r, const Progress& progress) {
  std::vector<Level>& levels = w.levels->levels;
  const multigrid::DataStrength data = multigrid::build(levels, map, rates, term);
  if (data.largest == 0) {
    set_zero(r.field);
    r.error = 0;
    return;
  }
  Hierarchy h{levels, {r.field.x.data(), r.field.y.data(), r.field.z.data()}};
  for (const bool careful : {false, true}) {
    if (careful) multigrid::build(levels, map, rates, term);  // cycles leave residuals where its right-hand sides were
    set_stretch(levels, careful);
    h.stretch_of_start = careful ? 1.0f : multigrid::joins_all_axes(levels[0]) ? 1.08f : 1.05f;
    h.solve_coarse();
    if (iterate(h, Estimate(levels[0], data), tolerance, most_cycles, careful, r, progress)) return;
  }
}

}  // namespace

SteadyWorkspace::SteadyWorkspace() : levels(std::make_unique<Levels>()) {}
SteadyWorkspace::~SteadyWorkspace() = default;
SteadyWorkspace::SteadyWorkspace(SteadyWorkspace&&) noexcept = default;
SteadyWorkspace& SteadyWorkspace::operator=(SteadyWorkspace&&) noexcept = default;

std::size_t SteadyWorkspace::bytes() const {
  std::size_t floats = 0, others = 0;
  for (const Level& l : levels->levels) {
    for (const auto* b : {&l.u, &l.rhs, &l.b, &l.d, &l.lane_values, &l.blocks, &l.empty_d}) floats += b->size();
    others += l.block_of.size() * sizeof(std::int32_t) + (l.change.size() + l.size.size()) * sizeof(double);
  }
  return floats * sizeof(float) + others;
}

void flow_field(const Image& edge_map, const SteadyGvf& options, SteadyWorkspace& workspace, FlowResult& result,
                const Progress& progress) {
  SteadyGvf o = options;
  check_options(o, "steady");
  prepare(edge_map, result);
  const Grid& g = edge_map.grid;
  double cell = 1;
  for (int a = 0; a < 3; ++a)
    if (g.dims[a] > 1) cell *= g.spacing[a];
  Vec3 rates;
  for (int a = 0; a < 3; ++a) rates[a] = o.mu / (o.scheme == GvfScheme::thesis ? cell : g.spacing[a] * g.spacing[a]);
  solve(edge_map, rates, {}, o.tolerance, o.most_cycles, workspace, result, progress);
}

void flow_field(const Image& edge_map, const SteadyGgvf& options, SteadyWorkspace& workspace, FlowResult& result,
                const Progress& progress) {
  SteadyGgvf o = options;
  check_options(o, "steady_ggvf");
  detail::check_edge_map(edge_map);
  prepare(edge_map, result);
  const double steepest = std::sqrt(detail::largest_gradient_squared(edge_map));
  const multigrid::DataTerm term{steepest > 0 ? 1 / (o.k * steepest) : 1};
  solve(edge_map, edge_map.grid.spacing.cwiseAbs2().cwiseInverse(), term, o.tolerance, o.most_cycles, workspace, result,
        progress);
}

namespace {

/// With the workspace of the thread's last small field. It is taken away while in use: a thread that waits for others
/// may begin another field.
template <class Options>
FlowResult flow_field_in_kept_memory(const Image& edge_map, const Options& options, const Progress& progress) {
  constexpr std::size_t worth_keeping = 16 << 20;
  static thread_local std::optional<SteadyWorkspace> kept;
  SteadyWorkspace workspace = kept ? *std::exchange(kept, std::nullopt) : SteadyWorkspace();
  FlowResult result;
  flow_field(edge_map, options, workspace, result, progress);
  if (workspace.bytes() <= worth_keeping) kept = std::move(workspace);
  return result;
}

}  // namespace

FlowResult flow_field(const Image& edge_map, const SteadyGvf& options, const Progress& progress) {
  return flow_field_in_kept_memory(edge_map, options, progress);
}

FlowResult flow_field(const Image& edge_map, const SteadyGgvf& options, const Progress& progress) {
  return flow_field_in_kept_memory(edge_map, options, progress);
}

}  // namespace dynasurf::field
