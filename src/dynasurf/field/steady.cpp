#include "dynasurf/field/steady.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>
#include <sstream>
#include <thread>
#include <utility>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/gradient.hpp"
#include "dynasurf/field/multigrid/level.hpp"

namespace dynasurf {

using multigrid::Level;
using multigrid::Start;

struct SteadyWorkspace::Levels {
  std::vector<Level> levels;
};

namespace {

/// What can be done to all cells of a level, in the order of need: each reads what the one before wrote up to one slice
/// further.
enum class Stage {
  red_from_rhs,
  red,
  red_measured,
  black,
  red_near_data,
  black_near_data,
  start_black,
  correct_black,
  restrict_residual,
  copy_out
};

/// The solver works on levels [0, count): 0 holds the voxels, the last one a single cell.
struct Hierarchy {
  std::vector<Level>& levels;
  std::array<float*, 3> field;

  void run(std::size_t l, std::span<const Stage> stages);
  void cycles(std::size_t l, std::size_t top, int count);
  void correct(std::size_t l, std::size_t top);
  void solve_coarse();

 private:
  void apply(std::size_t l, Stage stage, int k0, int k1, int j0, int j1);
  void run_in_strips(std::size_t l, std::span<const Stage> stages);
};

/// The stage on the rows [j0, j1) of the slices [k0, k1). Where pairs are joined, the bounds are even or the end.
void Hierarchy::apply(std::size_t l, Stage stage, int k0, int k1, int j0, int j1) {
  Level& fine = levels[l];
  const auto coarse = [](const multigrid::Axis& a, int i) { return a.halved ? (i + 1) / 2 : i; };
  const auto sweep = [&](int colour, Start start) { multigrid::sweep(fine, k0, k1, j0, j1, colour, start); };
  switch (stage) {
    case Stage::red_from_rhs:
      return sweep(0, Start::from_rhs);
    case Stage::red:
      return sweep(0, Start::warm);
    case Stage::red_measured:
      return sweep(0, Start::measured);
    case Stage::red_near_data:
      return sweep(0, Start::near_data);
    case Stage::black:
      return sweep(1, Start::warm);
    case Stage::black_near_data:
      return sweep(1, Start::near_data);
    case Stage::start_black:
      return multigrid::start_black(fine, levels[l + 1], k0, k1, j0, j1);
    case Stage::correct_black:
      return multigrid::correct_black(fine, levels[l + 1], k0, k1, j0, j1);
    case Stage::copy_out:
      for (int k = k0; k < k1; ++k) multigrid::copy_out(fine, k, j0, j1, field);
      return;
    case Stage::restrict_residual:
      return multigrid::restrict_residual(fine, levels[l + 1], coarse(fine.axis[2], k0), coarse(fine.axis[2], k1),
                                          coarse(fine.axis[1], j0), coarse(fine.axis[1], j1));
  }
}

/// How far, in rows and in slices, each stage stays behind the first. A stage reads what the one before wrote up to one
/// row further; a restriction joins pairs of rows.
std::vector<int> lags_of(std::span<const Stage> stages) {
  std::vector<int> lag{0};
  for (std::size_t s = 1; s < stages.size(); ++s) {
    const int next = lag.back() + 1;
    lag.push_back(stages[s] == Stage::restrict_residual ? next + next % 2 : next);
  }
  return lag;
}

void wait_until(const std::atomic<int>& reached, int slice) {
  for (int tries = 0; reached.load(std::memory_order_acquire) < slice; ++tries)
    if (tries > 200) std::this_thread::yield();
}

int pieces(int count, int size) { return (count + size - 1) / size; }

/// All stages in one pass over memory. A strip of rows is walked through slice by slice, two at a time; every stage
/// follows the one before it closely enough to find its values in the cache, and `lag` rows and slices behind, so that
/// they are ready. A step needs the steps before it, in the strip and in the strip below: a thread that takes the next
/// strip follows the thread in the one below, which was taken earlier and so never waits for this one.
void Hierarchy::run_in_strips(std::size_t l, std::span<const Stage> stages) {
  constexpr int step = 2, cached_bytes = 2'000'000;  // of several sizes the best from 128³ on
  const Level& f = levels[l];
  const std::vector<int> lag = lags_of(stages);
  const int row_bytes = static_cast<int>(sizeof(float)) * f.slot * (f.finest ? 8 : 16);
  const int cached_rows = std::max(cached_bytes / ((lag.back() + 2 * step) * row_bytes), 4);
  const int pairs_of_strips = pieces(f.ny() + lag.back(), 2 * cached_rows);  // an even number for two threads
  const int rows = (pieces(f.ny() + lag.back(), 2 * pairs_of_strips) + 1) / 2 * 2;
  const int strips = pieces(f.ny() + lag.back(), rows), end = f.nz() + lag.back();
  std::vector<std::atomic<int>> reached(static_cast<std::size_t>(strips));  // slices begun by the next step
  std::atomic<int> next = 0;
  parallel_for(static_cast<std::size_t>(strips), 1, [&](std::size_t, std::size_t) {
    const int strip = next++;
    const detail::FlushDenormals flush;
    for (int k = 0; k < end; k += step) {
      if (strip > 0) wait_until(reached[static_cast<std::size_t>(strip - 1)], k + step);
      for (std::size_t s = 0; s < stages.size(); ++s) {
        const int k0 = std::max(k - lag[s], 0), k1 = std::min(k + step - lag[s], f.nz());
        const int j0 = std::max(strip * rows - lag[s], 0), j1 = std::min((strip + 1) * rows - lag[s], f.ny());
        if (k0 < k1 && j0 < j1) apply(l, stages[s], k0, k1, j0, j1);
      }
      reached[static_cast<std::size_t>(strip)].store(k + step, std::memory_order_release);
    }
  });
}

void Hierarchy::run(std::size_t l, std::span<const Stage> stages) {
  constexpr std::size_t worth_threads = 16384;
  if (levels[l].cells() >= worth_threads) return run_in_strips(l, stages);
  const detail::FlushDenormals flush;
  for (Stage stage : stages) apply(l, stage, 0, levels[l].nz(), 0, levels[l].ny());
}

/// Solves the residual equation on level l+1 roughly. Two corrections instead of one on the first two levels below the
/// voxels and on large ones (a W-cycle cut short) keep the rate from falling with the number of levels. On the way up
/// to the voxels one is nearly as good and cheaper, but for the first level below where all axes are joined.
void Hierarchy::correct(std::size_t l, std::size_t top) {
  constexpr std::size_t worth_two = 4096;
  const std::array<multigrid::Axis, 3>& axis = levels[l].axis;
  const bool all_joined =
      std::all_of(axis.begin(), axis.end(), [](const multigrid::Axis& a) { return a.halved || a.count == 1; });
  const bool twice = l >= top + 2 ? levels[l + 1].cells() >= worth_two : top == 0 || (l == top && all_joined);
  cycles(l + 1, top, twice ? 2 : 1);
}

constexpr Stage into[] = {Stage::red_from_rhs, Stage::black, Stage::restrict_residual};
constexpr Stage through[] = {Stage::correct_black, Stage::red,   Stage::black,
                             Stage::red,           Stage::black, Stage::restrict_residual};
constexpr Stage out_of[] = {Stage::correct_black, Stage::red, Stage::black};
constexpr Stage begin_full[] = {Stage::start_black, Stage::red, Stage::black, Stage::restrict_residual};

/// `count` cycles on level l from zero.
void Hierarchy::cycles(std::size_t l, std::size_t top, int count) {
  if (l + 1 == levels.size()) return run(l, {into, 1});  // a single cell: exact
  run(l, into);
  for (int n = 1; n < count; ++n) {
    correct(l, top);
    run(l, through);
  }
  correct(l, top);
  run(l, out_of);
}

/// Full multigrid on all levels but the voxels: each starts from the solution of the next coarser one.
void Hierarchy::solve_coarse() {
  for (std::size_t l = levels.size() - 1; l >= 1; --l) {
    if (l + 1 == levels.size()) {
      cycles(l, l, 1);
      continue;
    }
    run(l, begin_full);
    correct(l, l);
    run(l, out_of);
  }
}

// On the voxels. Errors are largest and roughest beside the data, where further sweeps are cheap. Black cells come last
// before a restriction, which expects them to have no residual.
constexpr Stage begin[] = {Stage::start_black,     Stage::red,           Stage::black, Stage::red_near_data,
                           Stage::black_near_data, Stage::red_near_data, Stage::black, Stage::restrict_residual};
constexpr Stage finish[] = {Stage::correct_black, Stage::red_measured,    Stage::black,
                            Stage::red_near_data, Stage::black_near_data, Stage::copy_out};
constexpr Stage copy[] = {Stage::copy_out};
constexpr Stage resume[] = {Stage::red, Stage::black, Stage::restrict_residual};
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

  /// What is left after a cycle that changed the field by `now`. The shares are a tenth or more above the largest seen
  /// on random maps of all kinds; half of the errors are a fifth of what is reported or less. A change below a fortieth
  /// of the one before was small by chance; where cycles shrink the error slowly, the rate decides.
  double error_after(double now) {
    constexpr std::array<double, 4> weak_shares{0.3, 0.19, 0.46, 0.46}, strong_shares{0.45, 0.38, 0.5, 0.65};
    const double before = std::exchange(change, now), rate_before = rate;
    const std::size_t at = static_cast<std::size_t>(std::min(cycle++, 3));
    double share = strong ? strong_shares[at] : weak_shares[at];
    if (small) share *= 2;
    if (before > 0) {
      rate = now / before;
      const double slower = std::min(std::max(rate, rate_before), 0.9);
      share = std::max(share, 1.3 * slower / (1 - slower));
    }
    return std::max(now, 0.025 * before) * share + rounding;
  }
};

/// The correction of the voxels is stretched a little: the averaged data term of the coarser level holds it back. On
/// every level it would add up, and a field that is smooth on all of them would swing for ever. Careful: where strong
/// data close in a few long voxels, coarse levels overshoot by more than they gain.
void set_stretch(std::vector<Level>& levels, bool careful) {
  for (Level& l : levels) l.stretch = careful ? (l.finest ? 1.0f : 0.5f) : (l.finest ? 1.05f : 1.0f);
}

/// Cycles until the estimated error is below the tolerance or rounding ends the progress (near 1e-6). False, and no
/// result, where cycles take the field away from its place or swing about it; careful ones do not.
bool iterate(Hierarchy& h, Estimate estimate, double tolerance, int most_cycles, bool careful, FlowResult& r,
             const Progress& progress) {
  r.iterations = 0;
  h.run(0, begin);
  double error = 1;
  for (int stalled = 0;;) {
    progress.check();
    h.correct(0, 0);
    ++r.iterations;
    const bool certainly_more = 0.01 * error > tolerance && r.iterations < most_cycles;
    h.run(0, certainly_more ? std::span<const Stage>(finish_and_resume) : std::span<const Stage>(finish));
    error = estimate.error_after(relative_change(h.levels[0]));
    if (!careful && estimate.change > 0.1 && estimate.rate > 0.7) return false;
    stalled = estimate.rate > (careful ? 0.95 : 0.7) ? stalled + 1 : 0;
    if (!careful && stalled == 3 && error > std::max(tolerance, 100 * estimate.rounding)) return false;
    progress("field", r.iterations, most_cycles);
    if (error < tolerance || r.iterations == most_cycles || stalled == 3) {
      if (certainly_more) h.run(0, copy);
      break;
    }
    if (!certainly_more) h.run(0, resume);
  }
  r.error = error;
  if (error < tolerance) return true;
  std::ostringstream text;
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

}  // namespace dynasurf
