#include "dynasurf/field/steady.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <functional>
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
using multigrid::Rows;
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
  continue_black,
  continue_red,
  take_back_black,
  correct_black,
  restrict_residual,
  copy_out
};

/// The solver works on levels [0, count): 0 holds the voxels, the last one a single cell.
struct Hierarchy {
  std::vector<Level>& levels;
  std::array<float*, 3> field;
  Rows started = {};  // voxels that have values before the others
  float stretch_of_start = 1;

  void run(std::size_t l, std::span<const Stage> stages) { run(l, stages, all_of(levels[l])); }
  void run(std::size_t l, std::span<const Stage> stages, const Rows& last);
  void cycles(std::size_t l, std::size_t top, int count);
  void correct(std::size_t l, std::size_t top);
  void solve_coarse();
  bool start_voxels();

 private:
  static Rows all_of(const Level& l) { return {0, l.nz(), 0, l.ny()}; }
  void apply(std::size_t l, Stage stage, const Rows& rows);
  void in_and_around_started(const Rows& rows, const std::function<void(const Rows&)>& in,
                             const std::function<void(const Rows&)>& around) const;
  void run_in_strips(std::size_t l, std::span<const Stage> stages, const Rows& last);
};

/// Where pairs are joined, the bounds of the rows are even or the end.
void Hierarchy::apply(std::size_t l, Stage stage, const Rows& r) {
  Level& fine = levels[l];
  const auto coarse = [](const multigrid::Axis& a, int i) { return a.halved ? (i + 1) / 2 : i; };
  const auto sweep = [&](int colour, Start start) { multigrid::sweep(fine, r.k0, r.k1, r.j0, r.j1, colour, start); };
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
      return multigrid::start_black(fine, levels[l + 1], r.k0, r.k1, r.j0, r.j1);
    case Stage::continue_black:
      return in_and_around_started(
          r, [&](const Rows& in) { multigrid::correct_black(fine, levels[1], 1, in.k0, in.k1, in.j0, in.j1); },
          [&](const Rows& around) { apply(l, Stage::start_black, around); });
    case Stage::continue_red:
      return in_and_around_started(
          r, [&](const Rows& in) { apply(l, Stage::red_measured, in); },
          [&](const Rows& around) { apply(l, Stage::red, around); });
    case Stage::take_back_black:
      return multigrid::correct_black(fine, levels[l + 1], -1, r.k0, r.k1, r.j0, r.j1);
    case Stage::correct_black:
      return multigrid::correct_black(fine, levels[l + 1], fine.stretch, r.k0, r.k1, r.j0, r.j1);
    case Stage::copy_out:
      for (int k = r.k0; k < r.k1; ++k) multigrid::copy_out(fine, k, r.j0, r.j1, field);
      return;
    case Stage::restrict_residual:
      return multigrid::restrict_residual(fine, levels[l + 1], coarse(fine.axis[2], r.k0), coarse(fine.axis[2], r.k1),
                                          coarse(fine.axis[1], r.j0), coarse(fine.axis[1], r.j1));
  }
}

/// Splits rows into those of voxels that have values and the others.
void Hierarchy::in_and_around_started(const Rows& r, const std::function<void(const Rows&)>& in,
                                      const std::function<void(const Rows&)>& around) const {
  const auto each = [](const std::function<void(const Rows&)>& body, const Rows& rows) {
    if (rows.k0 < rows.k1 && rows.j0 < rows.j1) body(rows);
  };
  const int k0 = std::clamp(started.k0, r.k0, r.k1), k1 = std::clamp(started.k1, k0, r.k1);
  const int j0 = std::clamp(started.j0, r.j0, r.j1), j1 = std::clamp(started.j1, j0, r.j1);
  each(around, {r.k0, k0, r.j0, r.j1});
  each(around, {k0, k1, r.j0, j0});
  each(in, {k0, k1, j0, j1});
  each(around, {k0, k1, j1, r.j1});
  each(around, {k1, r.k1, r.j0, r.j1});
}

Rows grown(const Rows& r, int by, const Level& l) {
  return {std::max(r.k0 - by, 0), std::min(r.k1 + by, l.nz()), std::max(r.j0 - by, 0), std::min(r.j1 + by, l.ny())};
}

/// How many rows and slices more than the last stage each one must do: a stage reads one beyond its own. Those near
/// data do what they can.
std::vector<int> margins_of(std::span<const Stage> stages) {
  std::vector<int> margin(stages.size());
  for (std::size_t s = stages.size() - 1; s > 0; --s) {
    const bool near_data = stages[s] == Stage::red_near_data || stages[s] == Stage::black_near_data;
    margin[s - 1] = margin[s] + (near_data || stages[s] == Stage::take_back_black ? 0 : 1);
  }
  return margin;
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
void Hierarchy::run_in_strips(std::size_t l, std::span<const Stage> stages, const Rows& last) {
  constexpr int step = 2, cached_bytes = 2'000'000;  // of several sizes the best from 128³ on
  const Level& f = levels[l];
  const std::vector<int> lag = lags_of(stages), margin = margins_of(stages);
  const Rows first = grown(last, margin[0], f);
  const int k_begin = first.k0 / 2 * 2, j_begin = first.j0 / 2 * 2, height = first.j1 - j_begin + lag.back();
  const int row_bytes = static_cast<int>(sizeof(float)) * f.slot * (f.finest ? 8 : 16);
  const int cached_rows = std::max(cached_bytes / ((lag.back() + 2 * step) * row_bytes), 4);
  const int pairs_of_strips = pieces(height, 2 * cached_rows);  // an even number for two threads
  const int rows = (pieces(height, 2 * pairs_of_strips) + 1) / 2 * 2;
  const int strips = pieces(height, rows), k_end = first.k1 + lag.back();
  std::vector<std::atomic<int>> reached(static_cast<std::size_t>(strips));  // slices begun by the next step
  std::atomic<int> next = 0;
  parallel_for(static_cast<std::size_t>(strips), 1, [&](std::size_t, std::size_t) {
    const int strip = next++;
    const detail::FlushDenormals flush;
    for (int k = k_begin; k < k_end; k += step) {
      if (strip > 0) wait_until(reached[static_cast<std::size_t>(strip - 1)], k + step);
      for (std::size_t s = 0; s < stages.size(); ++s) {
        const Rows all = grown(last, margin[s], f);
        const int j = j_begin + strip * rows - lag[s];
        const Rows now{std::max(k - lag[s], all.k0), std::min(k + step - lag[s], all.k1), std::max(j, all.j0),
                       std::min(j + rows, all.j1)};
        if (now.k0 < now.k1 && now.j0 < now.j1) apply(l, stages[s], now);
      }
      reached[static_cast<std::size_t>(strip)].store(k + step, std::memory_order_release);
    }
  });
}

/// The last stage does the rows `last`, the others as many more as it takes.
void Hierarchy::run(std::size_t l, std::span<const Stage> stages, const Rows& last) {
  constexpr std::size_t worth_threads = 16384;
  if (levels[l].cells() >= worth_threads) return run_in_strips(l, stages, last);
  const detail::FlushDenormals flush;
  const std::vector<int> margin = margins_of(stages);
  for (std::size_t s = 0; s < stages.size(); ++s) apply(l, stages[s], grown(last, margin[s], levels[l]));
}

bool joins_all_axes(const Level& l) {
  return std::all_of(l.axis.begin(), l.axis.end(), [](const multigrid::Axis& a) { return a.halved || a.count == 1; });
}

/// Solves the residual equation on level l+1 roughly. Two corrections instead of one on the first two levels below the
/// voxels and on large ones (a W-cycle cut short) keep the rate from falling with the number of levels. On the way up
/// to the voxels one is nearly as good and cheaper, but for the first level below where all axes are joined.
void Hierarchy::correct(std::size_t l, std::size_t top) {
  constexpr std::size_t worth_two = 4096;
  const bool twice =
      l >= top + 2 ? levels[l + 1].cells() >= worth_two : top == 0 || (l == top && joins_all_axes(levels[l]));
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
constexpr Stage begin_box[] = {Stage::start_black,     Stage::red, Stage::black, Stage::red_near_data,
                               Stage::black_near_data, Stage::red, Stage::black, Stage::restrict_residual,
                               Stage::take_back_black};
constexpr Stage begin_around_box[] = {Stage::continue_black, Stage::continue_red,     Stage::black,
                                      Stage::red_near_data,  Stage::black_near_data,  Stage::red_near_data,
                                      Stage::black,          Stage::restrict_residual};
constexpr Stage finish[] = {Stage::correct_black, Stage::red_measured,    Stage::black,
                            Stage::red_near_data, Stage::black_near_data, Stage::copy_out};
constexpr Stage copy[] = {Stage::copy_out};
constexpr Stage resume[] = {Stage::red, Stage::black, Stage::restrict_residual};
constexpr Stage finish_and_resume[] = {Stage::correct_black, Stage::red_measured,     Stage::black,
                                       Stage::red_near_data, Stage::black_near_data,  Stage::red,
                                       Stage::black,         Stage::restrict_residual};

/// The rows near data, where they are less than half of all and the grid is so large that memory decides; else none.
Rows box_near_data(const Level& voxels) {
  constexpr std::size_t worth_a_box = 500'000;
  if (voxels.cells() < worth_a_box) return {};
  Rows box = grown(voxels.data, 4, voxels);
  const auto widen = [](const multigrid::Axis& a, int& from, int& to) {
    from = from / 2 * 2;
    to = std::min((to + 1) / 2 * 2, a.count);
  };
  widen(voxels.axis[1], box.j0, box.j1);
  widen(voxels.axis[2], box.k0, box.k1);
  const int rows = (box.k1 - box.k0) * (box.j1 - box.j0);
  return 2 * rows < voxels.ny() * voxels.nz() ? box : Rows{};
}

/// First values of the voxels; true where a cycle was spent on them. Far from the data the field is so smooth that
/// level 1 has it nearly right, if only the data act on it as they do on the voxels. So a box around the data is begun
/// first, and what its residual says becomes the right-hand side of level 1 there. The better solution then corrects
/// the voxels of the box and starts the others.
bool Hierarchy::start_voxels() {
  Level &voxels = levels[0], &coarse = levels[1];
  started = box_near_data(voxels);
  if (started.k1 == 0) {
    run(0, begin);
    return false;
  }
  run(0, begin_box, started);
  const auto joined = [](const multigrid::Axis& a, int i) { return a.halved ? (i + 1) / 2 : i; };
  multigrid::add_operator(coarse, stretch_of_start, joined(voxels.axis[2], started.k0),
                          joined(voxels.axis[2], started.k1), joined(voxels.axis[1], started.j0),
                          joined(voxels.axis[1], started.j1));
  run(1, resume);
  correct(1, 0);
  run(1, through);
  correct(1, 0);
  run(1, out_of);
  for (std::vector<double>* sums : {&voxels.change, &voxels.size}) std::fill(sums->begin(), sums->end(), 0.0);
  run(0, begin_around_box);
  return true;
}

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
    const std::size_t at = static_cast<std::size_t>(std::min(cycle++, 3));
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
  for (Level& l : levels) l.stretch = careful ? (l.finest ? 1.0f : 0.5f) : (l.finest ? 1.05f : 1.0f);
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
    if (!careful && r.iterations > 1 && estimate.change > 0.1 && estimate.rate > 0.7) return false;
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
    h.stretch_of_start = careful ? 1.0f : joins_all_axes(levels[0]) ? 1.08f : 1.05f;
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
