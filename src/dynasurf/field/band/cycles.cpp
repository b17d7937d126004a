#include <algorithm>
#include <cmath>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/field/band/bricks.hpp"

namespace dynasurf::band {

namespace {

constexpr std::size_t grain = 16;  // bricks

template <class F>
void each_brick(std::size_t count, F body) {
  parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
    const detail::FlushDenormals flush;
    for (std::size_t n = begin; n < end; ++n) body(n);
  });
}

/// One component of a brick with one layer of neighbours around it; edges and corners of the layer are not filled.
/// Beyond a wall of the grid a cell meets itself, so that nothing flows there.
struct Padded {
  static constexpr int row = 16, slice = 10 * row, first = slice + row + 4;
  alignas(64) float v[10 * slice] = {};  // what is not filled is multiplied by 0, and must be finite
  DYNASURF_INLINE float* at(int i, int j, int k) { return v + first + i + row * j + slice * k; }
  DYNASURF_INLINE const float* at(int i, int j, int k) const { return v + first + i + row * j + slice * k; }
};

/// Which cells of the layer around a brick are filled: all, or those of one colour. A sweep reads the other colour
/// alone, while other threads write its own.
enum class Layer { red, black, all };

/// Copies the 8x8 cells of a layer whose first cell has the colour `colour`.
template <Layer which, std::ptrdiff_t to_a, std::ptrdiff_t to_b, std::ptrdiff_t from_a, std::ptrdiff_t from_b>
DYNASURF_INLINE void copy_layer(float* to, const float* from, int colour) {
  for (int q = 0; q < side; ++q) {
    const int begin = which == Layer::all ? 0 : (colour + q + (which == Layer::black)) & 1;
    for (int r = 0; r < side; r += which == Layer::all ? 1 : 2)
      to[(r + begin) * to_a + q * to_b] = from[(r + begin) * from_a + q * from_b];
  }
}

/// The layers before and after a brick along one axis.
template <Layer which, int axis>
DYNASURF_INLINE void fill_layers(const Level& l, std::size_t n, std::size_t c, Padded& p) {
  constexpr std::ptrdiff_t padded_step[3] = {1, Padded::row, Padded::slice}, cell_step[3] = {1, side, side * side};
  constexpr int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
  const Index3& place = l.place[n];
  const int count = std::min(side, l.dims[axis] - side * place[axis]);  // cells of the brick inside the grid
  for (const bool after : {false, true}) {
    const int across = after ? count : -1;
    float* to = p.v + Padded::first + across * padded_step[axis];
    Index3 beyond = place;
    beyond[axis] += after ? 1 : -1;
    const int neighbour = l.number(beyond);
    const std::int32_t ghost = l.ghost_at[n][2 * axis + after];
    if (ghost >= 0) {
      copy_layer<which, padded_step[a], padded_step[b], 1, side>(
          to, l.ghosts[static_cast<std::size_t>(ghost)][c].data(), across);
      continue;
    }
    const float* from =
        neighbour >= 0 ? l.u[static_cast<std::size_t>(neighbour)][c].data() + (after ? 0 : side - 1) * cell_step[axis]
                       : l.u[n][c].data() + (after ? count - 1 : 0) * cell_step[axis];
    copy_layer<which, padded_step[a], padded_step[b], cell_step[a], cell_step[b]>(to, from, across);
  }
}

template <Layer which>
DYNASURF_INLINE void fill_padded(const Level& l, std::size_t n, std::size_t c, Padded& p) {
  const float* own = l.u[n][c].data();
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j) std::copy_n(own + cell_at(0, j, k), side, p.at(0, j, k));
  fill_layers<which, 0>(l, n, c, p);
  fill_layers<which, 1>(l, n, c, p);
  fill_layers<which, 2>(l, n, c, p);
}

/// Diffusion towards the neighbours of a brick's cells.
struct Rates {
  const float *left[3], *right[3];
  Rates(const Level& l, std::size_t n) {
    for (std::size_t a = 0; a < 3; ++a) {
      const int first = side * l.place[n][a];
      left[a] = l.axis[a].left.data() + first;
      right[a] = l.axis[a].right.data() + first;
    }
  }
};

/// rhs - (b - lap) u on the row (j, k).
DYNASURF_INLINE Row residual_row(const Rates& rate, const Padded& p, Row rhs, Row b, int j, int k) {
  const float* at = p.at(0, j, k);
  const Row u = load(at);
  const auto from = [&](int offset) { return load(at + offset) - u; };
  const Row x = load(rate.left[0]) * from(-1) + load(rate.right[0]) * from(1);
  const Row y = rate.left[1][j] * from(-Padded::row) + rate.right[1][j] * from(Padded::row);
  const Row z = rate.left[2][k] * from(-Padded::slice) + rate.right[2][k] * from(Padded::slice);
  return (rhs - b * u) + (x + (y + z));
}

alignas(64) constexpr float every_other[2][side] = {{1, 0, 1, 0, 1, 0, 1, 0}, {0, 1, 0, 1, 0, 1, 0, 1}};

/// Gauss-Seidel on the cells of one colour of a brick.
DYNASURF_CLONES void sweep_brick(Level& l, std::size_t n, int colour) {
  Padded p;
  const Rates rates(l, n);
  for (std::size_t c = 0; c < 3; ++c) {
    colour == 0 ? fill_padded<Layer::black>(l, n, c, p) : fill_padded<Layer::red>(l, n, c, p);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j) {
        const std::size_t row = cell_at(0, j, k);
        float* u = l.u[n][c].data() + row;
        const Row r = residual_row(rates, p, load(l.rhs[n][c].data() + row), load(l.b[n].data() + row), j, k);
        store(u, load(u) + load(every_other[(colour + j + k) & 1]) * (load(l.d[n].data() + row) * r));
      }
  }
}

void sweep(Level& l, int colour) {
  each_brick(l.place.size(), [&](std::size_t n) { sweep_brick(l, n, colour); });
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
      brick[a][static_cast<std::size_t>(i + 1)] = at / side;
      cell[a][static_cast<std::size_t>(i + 1)] = at % side;
    }
  }
  const auto size = [&](std::size_t a) { return static_cast<std::size_t>(p.count[a] + 2); };
  for (std::size_t k = 0; k < size(2); ++k)
    for (std::size_t j = 0; j < size(1); ++j) {
      int held = -2, number = -1;
      for (std::size_t i = 0; i < size(0); ++i) {
        if (brick[0][i] != held) number = g.number({held = brick[0][i], brick[1][j], brick[2][k]});
        const std::size_t to = i + Parents::width * (j + Parents::width * k);
        const std::size_t from = cell_at(cell[0][i], cell[1][j], cell[2][k]);
        for (std::size_t c = 0; c < 3; ++c) {
          if (number < 0) {
            p.v[c][to] = 0;
            continue;
          }
          const auto m = static_cast<std::size_t>(number);
          p.v[c][to] = change ? g.u[m][c][from] - g.before[m][c][from] : g.u[m][c][from];
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
    const std::int32_t number = f.ghost_at[n][static_cast<std::size_t>(face)];
    if (number < 0) continue;
    const auto axis = static_cast<std::size_t>(face / 2);
    Index3 low{0, 0, 0}, high{side - 1, side - 1, side - 1};
    low[axis] = high[axis] = face % 2 == 0 ? -1 : side;
    auto& ghosts = f.ghosts[static_cast<std::size_t>(number)];
    interpolate_rows(f, p, low, high, [&](std::size_t c, int j, int k, const float* row) {
      float* to = ghosts[c].data();
      if (axis == 0)
        to[j + side * k] = row[low[0]];
      else
        std::copy_n(row, side, to + side * (axis == 1 ? k : j));
    });
  }
}

void fill_ghosts(Level& f, const Level& g) {
  if (f.ghosts.empty()) return;
  each_brick(f.place.size(), [&](std::size_t n) {
    if (has_ghosts(f, n)) fill_ghosts_of(f, g, n);
  });
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
  Padded p;
  const Rates rates(f, n);
  Index3 parent = f.place[n];
  for (std::size_t a = 0; a < 3; ++a)
    if (f.axis[a].halved) parent[a] /= 2;
  const auto m = static_cast<std::size_t>(g.number(parent));
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
    fill_padded<Layer::all>(f, n, c, p);
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
  Padded p;
  const Rates rates(g, m);
  for (std::size_t c = 0; c < 3; ++c) {
    fill_padded<Layer::all>(g, m, c, p);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j) {
        const std::size_t row = cell_at(0, j, k);
        float r[side];
        store(r, residual_row(rates, p, Row{}, load(g.b[m].data() + row), j, k));
        for (int i = 0; i < side; ++i) {
          const int eighth = i / 4 + 2 * (j / 4) + 4 * (k / 4);
          if (g.covered[m] >> eighth & 1 && g.d[m][row + static_cast<std::size_t>(i)] > 0)
            g.rhs[m][c][row + static_cast<std::size_t>(i)] -= r[i];
        }
      }
  }
}

double sum_of_squares(const Cells& u, const Cells* less) {
  float sum[side] = {};  // one per lane, so that the order is the same on every machine
  for (std::size_t row = 0; row < brick_cells; row += side)
    for (std::size_t i = 0; i < side; ++i) {
      const float v = less ? u[row + i] - (*less)[row + i] : u[row + i];
      sum[i] += v * v;
    }
  double total = 0;
  for (const float s : sum) total += static_cast<double>(s);
  return total;
}

/// The composite of all levels: what finer bricks cover follows them, the rest obeys its own equations.
struct Composite {
  std::vector<Level>& levels;

  void relax(std::size_t l) {
    if (l + 1 < levels.size()) fill_ghosts(levels[l], levels[l + 1]);
    sweep(levels[l], 0);
    sweep(levels[l], 1);
  }

  /// Two corrections from the next level while it is of some size (a W-cycle): the rate then does not fall with the
  /// number of levels.
  bool twice(std::size_t l) const {
    const Index3& n = levels[l].dims;
    return n[0] > side || n[1] > side || n[2] > side;
  }

  void correct(std::size_t l) {
    Level &f = levels[l], &g = levels[l + 1];
    fill_ghosts(f, g);
    if (l + 2 < levels.size()) fill_ghosts(g, levels[l + 2]);
    // Bricks that share a parent brick write different cells of it.
    each_brick(f.place.size(), [&](std::size_t n) { restrict_brick(f, g, n); });
    each_brick(g.place.size(), [&](std::size_t m) {
      if (g.covered[m] != 0) complete_rhs(g, m);
    });
    each_brick(g.place.size(), [&](std::size_t m) { g.before[m] = g.u[m]; });
    cycle(l + 1);
    if (twice(l + 1)) cycle(l + 1);
    each_brick(f.place.size(), [&](std::size_t n) { prolong_brick(f, g, n, false); });
  }

  void cycle(std::size_t l) {
    if (l + 1 == levels.size()) return relax(l);  // a single cell: exact
    relax(l);
    correct(l);
    relax(l);
  }

  /// Each level starts from the solution of the next coarser one.
  void start() {
    relax(levels.size() - 1);
    for (std::size_t l = levels.size() - 1; l-- > 0;) {
      each_brick(levels[l].place.size(), [&](std::size_t n) { prolong_brick(levels[l], levels[l + 1], n, true); });
      if (l > 0) cycle(l);
    }
  }

  /// A cycle on the voxels; how much it changed them, relative to their values.
  double measured_cycle() {
    Level& f = levels[0];
    const std::size_t count = f.place.size();
    each_brick(count, [&](std::size_t n) { f.before[n] = f.u[n]; });
    cycle(0);
    const auto sum = [&](bool change) {
      return parallel_sum(count, grain, [&](std::size_t begin, std::size_t end) {
        double total = 0;
        for (std::size_t n = begin; n < end; ++n)
          for (std::size_t c = 0; c < 3; ++c) total += sum_of_squares(f.u[n][c], change ? &f.before[n][c] : nullptr);
        return total;
      });
    };
    const double size = sum(false);
    return size > 0 ? std::sqrt(sum(true) / size) : 0;
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
  if (levels.size() > 1) fill_ghosts(levels[0], levels[1]);
  return out;
}

}  // namespace dynasurf::band
