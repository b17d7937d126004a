#include "dynasurf/field/multigrid/detail/hierarchy.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <thread>

#include "dynasurf/core/detail/simd.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::field::multigrid {

namespace {

/// Of the rows those with data and those beside them.
Rows rows_beside_data(const Level& l, Rows r) {
  int first = l.ny(), end = 0;
  for (int k = std::max(r.k0 - 1, 0); k < std::min(r.k1 + 1, l.nz()); ++k) {
    const auto [from, to] = l.data_rows[k];
    if (from == to) continue;
    first = std::min(first, from - 1);
    end = std::max(end, to + 1);
  }
  r.j0 = std::max(r.j0, first);
  r.j1 = std::min(r.j1, end);
  return r;
}

}  // namespace

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
    case Stage::black_beside_data:
      if (const Rows b = rows_beside_data(fine, r); b.j0 < b.j1)
        multigrid::sweep(fine, b.k0, b.k1, b.j0, b.j1, 1, Start::warm);
      return;
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

namespace {

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

}  // namespace

/// All stages in one pass over memory. A strip of rows is walked through slice by slice, two at a time; every stage
/// follows the one before it closely enough to find its values in the cache, and `lag` rows and slices behind, so that
/// they are ready. A step needs the steps before it, in the strip and in the strip below: a thread that takes the next
/// strip follows the thread in the one below, which was taken earlier and so never waits for this one.
void Hierarchy::run_in_strips(std::size_t l, std::span<const Stage> stages, const Rows& last) {
  // Of several sizes the best from 128³ on, for second caches of 0.5 to 2 MB. Not asked of the processor: what a
  // sweep changed is summed strip by strip, so other strips would give other last digits of the error.
  constexpr int step = 2, cached_bytes = 4'000'000;
  const Level& f = levels[l];
  const std::vector<int> lag = lags_of(stages), margin = margins_of(stages);
  const Rows first = grown(last, margin[0], f);
  const int k_begin = first.k0 / 2 * 2, j_begin = first.j0 / 2 * 2, height = first.j1 - j_begin + lag.back();
  const int row_bytes = sizeof(float) * f.slot * (f.finest ? 8 : 16);
  const int cached_rows = std::max(cached_bytes / ((lag.back() + 2 * step) * row_bytes), 4);
  const int pairs_of_strips = pieces(height, 2 * cached_rows);  // an even number for two threads
  const int rows = (pieces(height, 2 * pairs_of_strips) + 1) / 2 * 2;
  const int strips = pieces(height, rows), k_end = first.k1 + lag.back();
  std::vector<std::atomic<int>> reached(strips);  // slices begun by the next step
  std::atomic<int> next = 0;
  parallel_for(strips, 1, [&](std::size_t, std::size_t) {
    const int strip = next++;
    const detail::FlushDenormals flush;
    for (int k = k_begin; k < k_end; k += step) {
      if (strip > 0) wait_until(reached[strip - 1], k + step);
      for (std::size_t s = 0; s < stages.size(); ++s) {
        const Rows all = grown(last, margin[s], f);
        const int j = j_begin + strip * rows - lag[s];
        const Rows now{std::max(k - lag[s], all.k0), std::min(k + step - lag[s], all.k1), std::max(j, all.j0),
                       std::min(j + rows, all.j1)};
        if (now.k0 < now.k1 && now.j0 < now.j1) apply(l, stages[s], now);
      }
      reached[strip].store(k + step, std::memory_order_release);
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

/// Two corrections instead of one on the first two levels below the
/// voxels and on large ones (a W-cycle cut short) keep the rate from falling with the number of levels. On the way up
/// to the voxels one is nearly as good and cheaper, but for the first level below where all axes are joined.
void Hierarchy::correct(std::size_t l, std::size_t top) {
  constexpr std::size_t worth_two = 4096;
  const bool twice =
      l >= top + 2 ? levels[l + 1].cells() >= worth_two : top == 0 || (l == top && joins_all_axes(levels[l]));
  cycles(l + 1, top, twice ? 2 : 1);
}

namespace {

constexpr Stage into[] = {Stage::red_from_rhs, Stage::black, Stage::restrict_residual};
constexpr Stage through[] = {Stage::correct_black, Stage::red,   Stage::black,
                             Stage::red,           Stage::black, Stage::restrict_residual};
constexpr Stage out_of[] = {Stage::correct_black, Stage::red, Stage::black};
constexpr Stage begin_full[] = {Stage::start_black, Stage::red, Stage::black, Stage::restrict_residual};

}  // namespace

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

namespace {

// On the voxels. Errors are largest and roughest beside the data, where further sweeps are cheap. Black cells come last
// before a restriction, which expects them to have no residual.
constexpr Stage begin[] = {
    Stage::start_black,      Stage::red, Stage::black, Stage::red_near_data, Stage::black_beside_data,
    Stage::restrict_residual};
constexpr Stage begin_box[] = {Stage::start_black,     Stage::red, Stage::black, Stage::red_near_data,
                               Stage::black_near_data, Stage::red, Stage::black, Stage::restrict_residual,
                               Stage::take_back_black};
constexpr Stage begin_around_box[] = {Stage::continue_black,    Stage::continue_red,     Stage::black,
                                      Stage::red_near_data,     Stage::black_near_data,  Stage::red_near_data,
                                      Stage::black_beside_data, Stage::restrict_residual};

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

}  // namespace

/// Far from the data the field is so smooth that
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

}  // namespace dynasurf::field::multigrid
