#include <algorithm>
#include <cmath>
#include <functional>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/band/detail/bricks.hpp"

namespace dynasurf::field::band {

namespace {

constexpr std::size_t grain = 16;  // bricks

template <class F>
void each_brick(std::size_t first, std::size_t end, F body) {
  parallel_for(end - first, grain, [&](std::size_t from, std::size_t to) {
    const detail::FlushDenormals flush;
    for (std::size_t n = first + from; n < first + to; ++n) body(n);
  });
}

/// What is done to every brick. Where it writes what neighbours read, every other brick goes first, as on a chessboard,
/// then those between, so that neighbours rest meanwhile.
struct Stage {
  std::function<void(std::size_t)> body;
  bool chessboard = false;
};

/// All stages in one pass over memory: each stays one layer of bricks behind the one before it, whose results on both
/// sides it reads.
void run_in_layers(const Level& l, std::initializer_list<Stage> stages) {
  const int layers = l.bricks[2], last = layers + std::ssize(stages) - 1;
  const auto first_of = [&](int layer) -> std::size_t {
    const auto is_below = [](const Index3& place, int z) { return place[2] < z; };
    return std::lower_bound(l.place.begin(), l.place.end(), layer, is_below) - l.place.begin();
  };
  for (int step = 0; step < last; ++step) {
    int layer = step;
    for (const Stage& stage : stages) {
      if (layer >= 0 && layer < layers)
        for (int turn = 0; turn < (stage.chessboard ? 2 : 1); ++turn)
          each_brick(first_of(layer), first_of(layer + 1), [&](std::size_t n) {
            const Index3& p = l.place[n];
            if (!stage.chessboard || ((p[0] + p[1] + p[2]) & 1) == turn) stage.body(n);
          });
      --layer;
    }
  }
}

/// One component of a brick and the cells beyond its faces, where they lie: in the next brick, in ghosts, or, at a wall
/// of the grid, the brick's own, where any finite value will do because nothing flows there.
struct Around {
  const float* own;
  std::array<const float*, faces> beyond;  // first cell of the layer
  std::array<Index, faces> row, slice;     // steps from there along j and k; 0 along the face's own axis

  DYNASURF_INLINE Around(const Level& l, std::size_t n, const std::array<int, faces>& next, std::size_t c)
      : own(l.u[n][c].data()) {
    constexpr Index step[3] = {1, side, side * side};
    for (std::size_t f = 0; f < faces; ++f) {
      const std::size_t axis = f / 2;
      const bool after = f % 2 == 1;
      const std::int32_t ghost = l.ghost_at[n][f];
      const bool at_wall = ghost < 0 && next[f] < 0;
      if (ghost >= 0) {
        beyond[f] = l.ghosts[ghost][c].data();
      } else {
        const float* brick = at_wall ? own : l.u[next[f]][c].data();
        beyond[f] = brick + (after == at_wall ? side - 1 : 0) * step[axis];
      }
      row[f] = axis == 1 ? 0 : ghost >= 0 && axis == 0 ? 1 : side;
      slice[f] = axis == 2 ? 0 : ghost >= 0 ? side : side * side;
    }
  }
  DYNASURF_INLINE const float* layer(std::size_t face, int j, int k) const {
    return beyond[face] + row[face] * j + slice[face] * k;
  }
};

/// Numbers of the bricks beyond the faces; -1 where there are none.
std::array<int, faces> neighbours_of(const Level& l, std::size_t n) {
  std::array<int, faces> next{};
  for (std::size_t f = 0; f < faces; ++f) {
    Index3 place = l.place[n];
    place[f / 2] += f % 2 == 0 ? -1 : 1;
    next[f] = l.number(place);
  }
  return next;
}

/// Diffusion towards the neighbours of a brick's cells.
struct Rates {
  Row left_x, right_x;
  const float *left_y, *right_y, *left_z, *right_z;
  DYNASURF_INLINE Rates(const Level& l, std::size_t n) {
    const Index3& p = l.place[n];
    left_x = load(l.axis[0].left.data() + side * p[0]);
    right_x = load(l.axis[0].right.data() + side * p[0]);
    left_y = l.axis[1].left.data() + side * p[1];
    right_y = l.axis[1].right.data() + side * p[1];
    left_z = l.axis[2].left.data() + side * p[2];
    right_z = l.axis[2].right.data() + side * p[2];
  }
};

/// rhs - (b - lap) u on the row (j, k).
DYNASURF_INLINE Row residual_row(const Rates& rate, const Around& p, Row rhs, Row b, int j, int k) {
  const float* at = p.own + cell_at(0, j, k);
  const Row u = load(at), before_x = Row{*p.layer(0, j, k)}, after_x = Row{*p.layer(1, j, k)};
  const Row left = __builtin_shufflevector(before_x, u, 0, 8, 9, 10, 11, 12, 13, 14);
  const Row right = __builtin_shufflevector(u, after_x, 1, 2, 3, 4, 5, 6, 7, 8);
  const Row x = rate.left_x * (left - u) + rate.right_x * (right - u);
  const Row y = rate.left_y[j] * (load(j > 0 ? at - side : p.layer(2, 0, k)) - u) +
                rate.right_y[j] * (load(j + 1 < side ? at + side : p.layer(3, 0, k)) - u);
  const Row z = rate.left_z[k] * (load(k > 0 ? at - side * side : p.layer(4, j, 0)) - u) +
                rate.right_z[k] * (load(k + 1 < side ? at + side * side : p.layer(5, j, 0)) - u);
  return (rhs - b * u) + (x + (y + z));
}

alignas(64) constexpr float every_other[2][side] = {{1, 0, 1, 0, 1, 0, 1, 0}, {0, 1, 0, 1, 0, 1, 0, 1}};

/// Gauss-Seidel on the cells of one colour of a brick. A plain one has no data and no wall: its right-hand side and b
/// are 0 and d is the same everywhere, so that only the field itself comes from memory.
template <bool plain>
DYNASURF_INLINE void sweep_cells(Level& l, std::size_t n, int colour) {
  const Rates rates(l, n);
  const std::array<int, faces> next = neighbours_of(l, n);
  const float *b = l.b[n].data(), *d = l.d[n].data();
  const Row every_d = Row{} + d[0];
  for (std::size_t c = 0; c < 3; ++c) {
    const Around p(l, n, next, c);
    const float* rhs = l.rhs[n][c].data();
    float* u = l.u[n][c].data();
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j) {
        const std::size_t row = cell_at(0, j, k);
        const Row mask = load(every_other[(colour + j + k) & 1]);
        const Row r = residual_row(rates, p, plain ? Row{} : load(rhs + row), plain ? Row{} : load(b + row), j, k);
        store(u + row, load(u + row) + mask * ((plain ? every_d : load(d + row)) * r));
      }
  }
}

DYNASURF_CLONES void sweep_brick(Level& l, std::size_t n, int colour) {
  l.plain[n] ? sweep_cells<true>(l, n, colour) : sweep_cells<false>(l, n, colour);
}

/// What finer cells of a brick interpolate between: the coarser cells that hold them and one more on every side.
struct Parents {
  static constexpr int width = side + 2;
  std::array<int, 3> count{};  // without the layer
  alignas(64) float v[3][width * width * width];

  DYNASURF_INLINE const float* at(std::size_t c, int i, int j, int k) const {
    return v[c] + (i + 1) + width * ((j + 1) + width * (k + 1));
  }
};

/// The parents of brick `n` of `f`: the field of the coarser level, or what its last solution changed. Places outside
/// the grid repeat its border; so do bricks that do not exist, which no cell that is used needs.
DYNASURF_INLINE void fill_parents(const Level& f, const Level& g, std::size_t n, bool change, Parents& p) {
  std::array<std::array<int, Parents::width>, 3> brick{}, cell{};
  for (std::size_t a = 0; a < 3; ++a) {
    p.count[a] = f.axis[a].halved ? side / 2 : side;
    const int origin = p.count[a] * f.place[n][a];
    for (int i = -1; i <= p.count[a]; ++i) {
      const int at = std::clamp(origin + i, 0, g.dims[a] - 1);
      brick[a][i + 1] = at / side;
      cell[a][i + 1] = at % side;
    }
  }
  const auto size = [&](std::size_t a) -> std::size_t { return p.count[a] + 2; };
  for (std::size_t k = 0; k < size(2); ++k)
    for (std::size_t j = 0; j < size(1); ++j)
      for (std::size_t i = 0, end; i < size(0); i = end) {  // runs of cells of one brick
        for (end = i + 1; end < size(0) && brick[0][end] == brick[0][i];) ++end;
        const int number = g.number({brick[0][i], brick[1][j], brick[2][k]});
        const std::size_t m = std::max(number, 0);
        const std::size_t from = cell_at(0, cell[1][j], cell[2][k]), to = Parents::width * (j + Parents::width * k);
        for (std::size_t c = 0; c < 3; ++c) {
          const float *u = g.u[m][c].data() + from, *before = g.before[m][c].data() + from;
          float* v = p.v[c] + to;
          for (std::size_t q = i; q < end; ++q) {
            const std::size_t at = cell[0][q];
            v[q] = number < 0 ? 0 : change ? u[at] - before[at] : u[at];
          }
        }
      }
}

/// Where a cell's value comes from along one axis: 3/4 of the coarser cell that holds it and 1/4 of the nearer
/// neighbour.
struct Between {
  int own, next;
};
DYNASURF_INLINE Between between(bool halved, int i) {
  if (!halved) return {i, i};
  const int own = i >= 0 ? i / 2 : (i - 1) / 2;
  return {own, (i & 1) == 0 ? own - 1 : own + 1};
}

/// Calls `body(c, j, k, row)` for every row of the box [low, high] of a brick; row[i] is the value at i.
template <class F>
DYNASURF_INLINE void interpolate_rows(const Level& f, const Parents& p, const Index3& low, const Index3& high, F body) {
  constexpr int width = Parents::width;
  for (std::size_t c = 0; c < 3; ++c)
    for (int k = low[2]; k <= high[2]; ++k) {
      const Between z = between(f.axis[2].halved, k);
      const float *own = p.at(c, -1, -1, z.own), *next = p.at(c, -1, -1, z.next);
      float slice[width * width];
      for (int n = 0; n < width * width; ++n) slice[n] = 0.75f * own[n] + 0.25f * next[n];
      for (int j = low[1]; j <= high[1]; ++j) {
        const Between y = between(f.axis[1].halved, j);
        const float *q = slice + width * (y.own + 1), *r = slice + width * (y.next + 1);
        float coarse[width], fine[width];
        for (int n = 0; n < width; ++n) coarse[n] = 0.75f * q[n] + 0.25f * r[n];
        if (f.axis[0].halved) {
          for (int m = 0; m < width / 2; ++m) {
            fine[2 * m] = 0.75f * coarse[m] + 0.25f * coarse[m + 1];
            fine[2 * m + 1] = 0.75f * coarse[m + 1] + 0.25f * coarse[m];
          }
        } else {
          std::copy_n(coarse, width, fine);
        }
        body(c, j, k, fine + 1);
      }
    }
}

bool has_ghosts(const Level& f, std::size_t n) {
  return std::any_of(f.ghost_at[n].begin(), f.ghost_at[n].end(), [](std::int32_t g) { return g >= 0; });
}

DYNASURF_CLONES void fill_ghosts_of(Level& f, const Level& g, std::size_t n) {
  Parents p;
  fill_parents(f, g, n, false, p);
  for (int face = 0; face < faces; ++face) {
    const std::int32_t number = f.ghost_at[n][face];
    if (number < 0) continue;
    const std::size_t axis = face / 2;
    Index3 low{0, 0, 0}, high{side - 1, side - 1, side - 1};
    low[axis] = high[axis] = face % 2 == 0 ? -1 : side;
    auto& ghosts = f.ghosts[number];
    interpolate_rows(f, p, low, high, [&](std::size_t c, int j, int k, const float* row) {
      float* to = ghosts[c].data();
      if (axis == 0)
        to[j + side * k] = row[low[0]];
      else
        std::copy_n(row, side, to + side * (axis == 1 ? k : j));
    });
  }
}

/// u of the finer level from the coarser: its values (`start`) or the change of its last solution, weighed with
/// s = D/(D+b).
DYNASURF_CLONES void prolong_brick(Level& f, const Level& g, std::size_t n, bool start) {
  Parents p;
  fill_parents(f, g, n, !start, p);
  interpolate_rows(f, p, {0, 0, 0}, {side - 1, side - 1, side - 1}, [&](std::size_t c, int j, int k, const float* row) {
    const std::size_t at = cell_at(0, j, k);
    const float *b = f.b[n].data() + at, *d = f.d[n].data() + at, *rhs = f.rhs[n][c].data() + at;
    float* u = f.u[n][c].data() + at;
    for (int i = 0; i < side; ++i) {
      const float s = d[i] > 0 ? 1 - b[i] * d[i] : 0.0f;
      u[i] = start ? s * row[i] + d[i] * rhs[i] : u[i] + s * row[i];
    }
  });
}

/// Hands a brick's field and residual to the coarser cells that hold it: there the field becomes the mean, and `rhs`
/// the mean of s times the residual.
DYNASURF_CLONES void restrict_brick(const Level& f, Level& g, std::size_t n) {
  const Rates rates(f, n);
  const std::array<int, faces> next = neighbours_of(f, n);
  Index3 parent = f.place[n];
  for (std::size_t a = 0; a < 3; ++a)
    if (f.axis[a].halved) parent[a] /= 2;
  const std::size_t m = g.number(parent);
  Index3 count;  // cells of the brick inside the grid
  std::array<int, 3> origin{};
  for (std::size_t a = 0; a < 3; ++a) {
    count[a] = std::min(side, f.dims[a] - side * f.place[n][a]);
    origin[a] = f.axis[a].halved ? side / 2 * (f.place[n][a] % 2) : 0;
  }
  const float* share[3];  // of each cell in the coarser cell that holds it
  for (std::size_t a = 0; a < 3; ++a) share[a] = f.axis[a].share.data() + side * f.place[n][a];
  const int width = f.axis[0].halved ? side / 2 : side;
  for (std::size_t c = 0; c < 3; ++c) {
    const Around p(f, n, next, c);
    for (int k = 0; k < count[2]; ++k)
      for (int j = 0; j < count[1]; ++j) {
        const std::size_t row = cell_at(0, j, k);
        const float *b = f.b[n].data() + row, *d = f.d[n].data() + row, *u = f.u[n][c].data() + row;
        float mean[side], residual[side];
        const Row weight = (share[1][j] * share[2][k]) * load(share[0]);
        store(mean, weight * load(u));
        store(residual, (weight * (1.0f - load(b) * load(d))) *
                            residual_row(rates, p, load(f.rhs[n][c].data() + row), load(b), j, k));
        if (f.axis[0].halved)
          for (int i = 0; i < side / 2; ++i) {
            mean[i] = mean[2 * i] + mean[2 * i + 1];
            residual[i] = residual[2 * i] + residual[2 * i + 1];
          }
        const int y = origin[1] + (f.axis[1].halved ? j / 2 : j), z = origin[2] + (f.axis[2].halved ? k / 2 : k);
        const std::size_t to = cell_at(origin[0], y, z);
        const bool first = !(f.axis[1].halved && (j & 1)) && !(f.axis[2].halved && (k & 1));
        float *into_u = g.u[m][c].data() + to, *into_rhs = g.rhs[m][c].data() + to;
        for (int i = 0; i < width; ++i) {
          into_u[i] = (first ? 0.0f : into_u[i]) + mean[i];
          into_rhs[i] = (first ? 0.0f : into_rhs[i]) + residual[i];
        }
      }
  }
}

/// Restricted residuals become right-hand sides of the full field: the coarser operator applied to the mean is added.
DYNASURF_CLONES void complete_rhs(Level& g, std::size_t m) {
  const Rates rates(g, m);
  const std::array<int, faces> next = neighbours_of(g, m);
  for (std::size_t c = 0; c < 3; ++c) {
    const Around p(g, m, next, c);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j) {
        const std::size_t row = cell_at(0, j, k);
        float r[side];
        store(r, residual_row(rates, p, Row{}, load(g.b[m].data() + row), j, k));
        for (int i = 0; i < side; ++i) {
          const int eighth = i / 4 + 2 * (j / 4) + 4 * (k / 4);
          if (g.covered[m] >> eighth & 1 && g.d[m][row + i] > 0) g.rhs[m][c][row + i] -= r[i];
        }
      }
  }
}

/// Sums of squares of a field and of its change since.
struct Squares {
  double size = 0, change = 0;
};

Squares squares_of(const Cells3& u, const Cells3& before) {
  Row size{}, change{};  // lane by lane, so that the order is the same on every machine
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t row = 0; row < brick_cells; row += side) {
      const Row v = load(u[c].data() + row), w = v - load(before[c].data() + row);
      size += v * v;
      change += w * w;
    }
  Squares sum;
  for (int i = 0; i < side; ++i) {
    sum.size += size[i];
    sum.change += change[i];
  }
  return sum;
}

/// The composite of all levels: what finer bricks cover follows them, the rest obeys its own equations. Ghosts follow
/// the coarser level: they are filled again whenever it has changed.
struct Composite {
  std::vector<Level>& levels;

  Stage sweep(std::size_t l, int colour) {
    return {[this, l, colour](std::size_t n) { sweep_brick(levels[l], n, colour); }, true};
  }
  Stage prolong(std::size_t l, bool start) {
    return {[this, l, start](std::size_t n) {
      prolong_brick(levels[l], levels[l + 1], n, start);
      if (has_ghosts(levels[l], n)) fill_ghosts_of(levels[l], levels[l + 1], n);
    }};
  }

  /// Two corrections from the next level while it is of some size (a W-cycle): the rate then does not fall with the
  /// number of levels.
  bool twice(std::size_t l) const {
    const Index3& n = levels[l].dims;
    return n[0] > side || n[1] > side || n[2] > side;
  }

  void cycle(std::size_t l) {
    Level& f = levels[l];
    if (l + 1 == levels.size()) return run_in_layers(f, {sweep(l, 0)});  // a single cell: exact
    Level& g = levels[l + 1];
    // Bricks that share a parent brick write different cells of it.
    run_in_layers(f, {sweep(l, 0), sweep(l, 1), {[&](std::size_t n) { restrict_brick(f, g, n); }}});
    each_brick(0, g.place.size(), [&](std::size_t m) {
      if (g.covered[m] != 0) complete_rhs(g, m);
      g.before[m] = g.u[m];
    });
    cycle(l + 1);
    if (twice(l + 1)) cycle(l + 1);
    run_in_layers(f, {prolong(l, false), sweep(l, 0), sweep(l, 1)});
  }

  /// Each level starts from the solution of the next coarser one.
  void start() {
    cycle(levels.size() - 1);
    for (std::size_t l = levels.size() - 1; l > 0;) {
      --l;
      run_in_layers(levels[l], {prolong(l, true)});
      if (l > 0) cycle(l);
    }
  }

  /// A cycle on the voxels; how much it changed them, relative to their values.
  double measured_cycle() {
    Level& f = levels[0];
    const std::size_t count = f.place.size();
    each_brick(0, count, [&](std::size_t n) { f.before[n] = f.u[n]; });
    cycle(0);
    std::vector<Squares> squares(count);
    each_brick(0, count, [&](std::size_t n) { squares[n] = squares_of(f.u[n], f.before[n]); });
    Squares all;
    for (const Squares& q : squares) all = {all.size + q.size, all.change + q.change};
    return all.size > 0 ? std::sqrt(all.change / all.size) : 0;
  }
};

}  // namespace

Outcome solve(std::vector<Level>& levels, double tolerance, int most_cycles, const Progress& progress) {
  Composite all{levels};
  all.start();
  Outcome out;
  double before = 0;
  while (out.cycles < most_cycles) {
    progress.check();
    const double change = all.measured_cycle();
    ++out.cycles;
    // A cycle that shrinks the error by `rate` and changes the field by `change` leaves change rate / (1 - rate).
    const double rate = before > 0 ? std::clamp(change / before, 0.2, 0.9) : 0.3;
    out.error = 1.5 * change * rate / (1 - rate);
    const bool stalled = before > 0 && change > 0.7 * before && change < 1e-4;
    before = change;
    progress("field", out.cycles, most_cycles);
    if (out.error < tolerance || stalled) break;
  }
  return out;
}

}  // namespace dynasurf::field::band
