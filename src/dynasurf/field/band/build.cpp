#include <algorithm>
#include <cmath>

#include "dynasurf/field/band/detail/bricks.hpp"

namespace dynasurf::field::band {

namespace {

Index3 bricks_of(const Index3& dims) {
  Index3 n;
  for (std::size_t a = 0; a < 3; ++a) n[a] = (dims[a] + side - 1) / side;
  return n;
}

/// Calls `body` with every place of the level's box within `reach` bricks of another.
template <class F>
void around(const Level& l, const Index3& p, int reach, F body) {
  Index3 low, high;
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = std::max(p[a] - reach, 0);
    high[a] = std::min(p[a] + reach, l.bricks[a] - 1);
  }
  for (int k = low[2]; k <= high[2]; ++k)
    for (int j = low[1]; j <= high[1]; ++j)
      for (int i = low[0]; i <= high[0]; ++i) body(Index3{i, j, k});
}

/// Makes the brick where there is none yet.
void add_brick(Level& l, const Index3& p) {
  std::int32_t& number = l.brick_at[index_in(l.bricks, p)];
  if (number >= 0) return;
  number = l.place.size();
  l.place.push_back(p);
}

/// Makes the bricks that hold a cell within `reach` of a cell with data, counted along each axis.
void add_bricks_near(Level& l, const BrickData& data, int reach) {
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) {
        if (data.b[cell_at(i, j, k)] == 0) continue;
        const Index3 v = cell_of(data.place, i, j, k);
        Index3 low, high;
        for (std::size_t a = 0; a < 3; ++a) {
          low[a] = std::max(v[a] - reach, 0) / side;
          high[a] = std::min(v[a] + reach, l.dims[a] - 1) / side;
        }
        for (int z = low[2]; z <= high[2]; ++z)
          for (int y = low[1]; y <= high[1]; ++y)
            for (int x = low[0]; x <= high[0]; ++x) add_brick(l, {x, y, z});
      }
}

/// Bricks in the order of their places, so that neighbours lie near each other and the order does not depend on how
/// they were found.
void number_bricks(Level& l) {
  std::sort(l.place.begin(), l.place.end(), [](const Index3& p, const Index3& q) {
    return std::array{p[2], p[1], p[0]} < std::array{q[2], q[1], q[0]};
  });
  for (std::size_t n = 0; n < l.place.size(); ++n) l.brick_at[index_in(l.bricks, l.place[n])] = n;
}

Axis axis_of(std::vector<double> width, double nominal) {
  Axis a;
  a.count = width.size();
  a.nominal = nominal;
  const std::size_t padded = (width.size() + side - 1) / side * side;
  a.left.assign(padded, 0);
  a.right.assign(padded, 0);
  a.share.assign(padded, 0);
  std::fill_n(a.share.begin(), width.size(), 1.0f);
  for (std::size_t i = 0; i + 1 < width.size(); ++i) {
    const double apart = (width[i] + width[i + 1]) / 2;
    a.right[i] = 1 / (width[i] * apart);
    a.left[i + 1] = 1 / (width[i + 1] * apart);
  }
  a.width = std::move(width);
  return a;
}

Level level_of(std::array<Axis, 3> axis) {
  Level l;
  for (std::size_t a = 0; a < 3; ++a) l.dims[a] = axis[a].count;
  l.axis = std::move(axis);
  l.bricks = bricks_of(l.dims);
  l.brick_at.assign(size_of(l.bricks), -1);
  return l;
}

/// Joins cells along the axes of strongest diffusion, as the dense solver does.
Level coarser(Level& fine) {
  double finest = INFINITY;
  for (const Axis& a : fine.axis)
    if (a.count > 1) finest = std::min(finest, a.nominal);
  std::array<Axis, 3> axis;
  for (std::size_t d = 0; d < 3; ++d) {
    Axis& a = fine.axis[d];
    a.halved = a.count > 1 && a.nominal <= 1.4143 * finest;
    if (!a.halved) {
      axis[d] = axis_of(a.width, a.nominal);
      continue;
    }
    std::vector<double> width;
    for (std::size_t i = 0; i < a.width.size(); i += 2)
      width.push_back(a.width[i] + (i + 1 < a.width.size() ? a.width[i + 1] : 0));
    for (std::size_t i = 0; i < a.width.size(); ++i) a.share[i] = a.width[i] / width[i / 2];
    axis[d] = axis_of(std::move(width), 2 * a.nominal);
  }
  return level_of(std::move(axis));
}

Index3 parent_of(const Level& fine, const Index3& brick) {
  Index3 p = brick;
  for (std::size_t a = 0; a < 3; ++a)
    if (fine.axis[a].halved) p[a] /= 2;
  return p;
}

/// 1 / diagonal of every cell, the walls of the grid counted.
void fill_d(Level& l) {
  l.d.resize(l.place.size());
  for (std::size_t n = 0; n < l.place.size(); ++n) {
    l.d[n].fill(0);
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          const Index3 v = cell_of(l.place[n], i, j, k);
          if (!is_inside(v, l.dims)) continue;
          float diagonal = l.b[n][cell_at(i, j, k)];
          for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t at = v[a];
            diagonal += l.axis[a].left[at] + l.axis[a].right[at];
          }
          l.d[n][cell_at(i, j, k)] = diagonal > 0 ? 1 / diagonal : 0;
        }
  }
}

/// Where b is 0 there are no data, and where d is the same in all cells of a brick there is no wall.
void find_plain(Level& l) {
  for (std::size_t n = 0; n < l.place.size(); ++n) {
    const Cells &b = l.b[n], &d = l.d[n];
    l.plain[n] = std::all_of(b.begin(), b.end(), [](float v) { return v == 0; }) &&
                 std::all_of(d.begin(), d.end(), [&](float v) { return v == d[0]; });
  }
}

void make_room(Level& l) {
  const std::size_t n = l.place.size();
  l.u.assign(n, {});
  l.rhs.assign(n, {});
  l.b.assign(n, {});
  l.before.assign(n, {});
  l.covered.assign(n, 0);
  l.plain.assign(n, 0);
  std::array<std::int32_t, faces> none;
  none.fill(-1);
  l.ghost_at.assign(n, none);
  std::int32_t ghosts = 0;
  for (std::size_t m = 0; m < n; ++m)
    for (int f = 0; f < faces; ++f) {
      const std::size_t axis = f / 2;
      Index3 beyond = l.place[m];
      beyond[axis] += f % 2 == 0 ? -1 : 1;
      const bool outside = beyond[axis] < 0 || beyond[axis] >= l.bricks[axis];
      if (!outside && l.number(beyond) < 0) l.ghost_at[m][f] = ghosts++;
    }
  l.ghosts.assign(ghosts, {});
}

/// s = D/(D+b) of a cell, the share that diffusion has in it; 1 outside the band.
float freedom(const Level& l, const Index3& v) {
  const std::int32_t n = l.number({v[0] / side, v[1] / side, v[2] / side});
  if (n < 0) return 1;
  const std::size_t at = cell_at(v[0] % side, v[1] % side, v[2] % side);
  return 1 - l.b[n][at] * l.d[n][at];
}

/// How much of its data term a voxel shows to the coarser level. Alone among free voxels it would follow them by s, and
/// show s b; voxels inside a thick or strong border are held by their neighbours too, and show less.
float shown(const Level& l, const Index3& v, float d, float s) {
  float flow = 0;
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t at = v[a];
    Index3 low = v, high = v;
    --low[a], ++high[a];
    if (l.axis[a].left[at] > 0) flow += l.axis[a].left[at] * freedom(l, low);
    if (l.axis[a].right[at] > 0) flow += l.axis[a].right[at] * freedom(l, high);
  }
  const float held = 0.3f + s;  // as measured on borders of all strengths
  return held * (d * flow) + (1 - held) * s;
}

/// Data of the coarser level: mean over the cells that a coarser cell joins, the data term as far as it shows, the rest
/// weighed with s. A thin strong shell would otherwise hold the whole coarse cell fast.
void coarsen_data(const Level& f, Level& g, bool voxels) {
  for (std::size_t n = 0; n < f.place.size(); ++n) {
    const Index3 parent = parent_of(f, f.place[n]);
    const std::size_t m = g.number(parent);
    int eighths = 0;  // of the parent brick that this brick fills
    for (int k = 0; k < side; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i) {
          const Index3 v = cell_of(f.place[n], i, j, k);
          if (!is_inside(v, f.dims)) continue;
          Index3 c = v;
          float share = 1;
          for (std::size_t a = 0; a < 3; ++a) {
            share *= f.axis[a].share[v[a]];
            if (f.axis[a].halved) c[a] /= 2;
          }
          const Index3 at{c[0] - side * parent[0], c[1] - side * parent[1], c[2] - side * parent[2]};
          eighths |= 1 << (at[0] / 4 + 2 * (at[1] / 4) + 4 * (at[2] / 4));
          const std::size_t from = cell_at(i, j, k), to = cell_at(at[0], at[1], at[2]);
          const float b = f.b[n][from], d = f.d[n][from], s = 1 - b * d;
          if (b == 0) continue;
          g.b[m][to] += share * b * (voxels ? shown(f, v, d, s) : s);
          for (std::size_t comp = 0; comp < 3; ++comp) g.rhs[m][comp][to] += share * s * f.rhs[n][comp][from];
        }
    g.covered[m] |= eighths;
  }
}

}  // namespace

std::vector<Level> build(const Grid& grid, const std::array<double, 3>& rates, const std::vector<BrickData>& data,
                         int reach) {
  std::vector<Level> levels;
  std::array<Axis, 3> axis;
  for (std::size_t a = 0; a < 3; ++a) {
    const double width = 1 / std::sqrt(rates[a]);
    axis[a] = axis_of(std::vector<double>(grid.dims[a], width), width);
  }
  levels.push_back(level_of(std::move(axis)));
  for (const BrickData& brick : data) add_bricks_near(levels[0], brick, reach);
  number_bricks(levels[0]);
  while (levels.back().dims != Index3{1, 1, 1}) {
    Level next = coarser(levels.back());
    const Level& fine = levels.back();
    for (const Index3& p : fine.place)
      around(fine, p, 1, [&](const Index3& q) { add_brick(next, parent_of(fine, q)); });
    number_bricks(next);
    levels.push_back(std::move(next));
  }
  for (Level& l : levels) make_room(l);
  for (const BrickData& brick : data) {
    const std::size_t n = levels[0].number(brick.place);
    levels[0].b[n] = brick.b;
    levels[0].rhs[n] = brick.pull;
  }
  for (std::size_t l = 0; l < levels.size(); ++l) {
    fill_d(levels[l]);
    if (l == 0) find_plain(levels[0]);
    if (l + 1 < levels.size()) coarsen_data(levels[l], levels[l + 1], l == 0);
  }
  return levels;
}

}  // namespace dynasurf::field::band
