#include "dynasurf/cloud/detail/indicator_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "dynasurf/cloud/detail/by_cell.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr float outside = -0.5f;

/// One lattice of the cascade. Node (i,j,k) lies at origin + side (i,j,k); the outermost nodes are held outside.
struct Lattice {
  Index3 dims;
  double side;
  Vec3 origin;
  std::size_t size() const { return size_of(dims); }
  std::size_t row() const { return dims[0]; }
  std::size_t slab() const { return size_of({dims[0], dims[1], 1}); }
};

/// The eight nodes around a place and their weights; false when it is not within the lattice.
struct Corner {
  std::size_t at = 0;
  std::array<float, 8> weight{};
};

bool corner_of(const Lattice& l, const Vec3& p, const Vec3& shift, Corner& c) {
  const Vec3 q = (p - l.origin) / l.side - shift;
  std::array<std::size_t, 3> base{};
  std::array<double, 3> part{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double whole = std::floor(q[a]);
    if (!(whole >= 0) || whole >= l.dims[a] - 1) return false;
    base[a] = whole;
    part[a] = q[a] - whole;
  }
  c.at = base[0] + l.row() * base[1] + l.slab() * base[2];
  for (std::size_t n = 0; n < 8; ++n)
    c.weight[n] = (n & 1 ? part[0] : 1 - part[0]) * (n & 2 ? part[1] : 1 - part[1]) * (n & 4 ? part[2] : 1 - part[2]);
  return true;
}

std::array<std::size_t, 8> steps_of(const Lattice& l) {
  std::array<std::size_t, 8> s{};
  for (std::size_t n = 0; n < 8; ++n) s[n] = (n & 1) + (n & 2 ? l.row() : 0) + (n & 4 ? l.slab() : 0);
  return s;
}

using Values = std::vector<float>;

/// The nodes that are solved for, as runs along the rows, slab after slab. The others keep the value of their start.
struct Runs {
  std::vector<std::pair<std::size_t, std::size_t>> nodes;  // first, and behind the last
  std::vector<std::size_t> first_of_slab;                  // of its runs, and the end
};

/// Rows are cut in pieces that the processor can work on at once; a run is made of whole ones.
class Pieces {
 public:
  explicit Pieces(const Lattice& l, std::uint8_t marked)
      : l_(l),
        per_row_((l.dims[0] + length - 3) / length),
        per_slab_(per_row_ * l.dims[1]),
        marks_(per_slab_ * l.dims[2], marked) {}

  /// Those within `reach` nodes of node (i, j, k) along its row.
  void mark(std::size_t i, std::size_t j, std::size_t k, std::size_t reach) {
    std::uint8_t* row = marks_.data() + j * per_row_ + k * per_slab_;
    const std::size_t last = std::min((i + reach) / length, per_row_ - 1);
    for (std::size_t n = (std::max(i, reach + 1) - reach - 1) / length; n <= last; ++n) row[n] = 1;
  }

  /// Marks spread as far from row to row and from slab to slab.
  void spread(std::size_t reach) {
    spread_along(per_row_, l_.dims[1], reach);
    spread_along(per_slab_, l_.dims[2], reach);
  }

  Runs runs() const {
    Runs r;
    r.first_of_slab.assign(2, 0);
    const std::size_t row = l_.row(), slab = l_.slab();
    for (int k = 1; k + 1 < l_.dims[2]; ++k) {
      for (int j = 1; j + 1 < l_.dims[1]; ++j) {
        const std::uint8_t* marks = marks_.data() + j * per_row_ + k * per_slab_;
        for (std::size_t n = 0; n < per_row_; ++n) {
          if (!marks[n]) continue;
          const std::size_t first = n;
          while (n + 1 < per_row_ && marks[n + 1]) ++n;
          const std::size_t base = k * slab + j * row;
          r.nodes.push_back({base + 1 + first * length, base + std::min(1 + (n + 1) * length, row - 1)});
        }
      }
      r.first_of_slab.push_back(r.nodes.size());
    }
    return r;
  }

 private:
  static constexpr std::size_t length = 8;

  /// Bytes `step` apart, `count` of them after each other.
  void spread_along(std::size_t step, std::size_t count, std::size_t reach) {
    const std::vector<std::uint8_t> before = marks_;
    for (std::size_t i = 0; i < marks_.size(); ++i) {
      if (!before[i]) continue;
      const std::size_t at = i / step % count;
      const std::size_t first = at - std::min(at, reach), last = std::min(at + reach, count - 1);
      for (std::size_t n = first; n <= last; ++n) marks_[i + n * step - at * step] = 1;
    }
  }

  const Lattice& l_;
  std::size_t per_row_, per_slab_;
  std::vector<std::uint8_t> marks_;
};

Runs all_nodes(const Lattice& l) { return Pieces(l, 1).runs(); }

/// Nodes near the points, and near the surface that the start already shows where there are none: what the next finer
/// lattice adds to the start is there, and far from both the start is as good.
Runs nodes_near_surface(const Lattice& l, const OrientedPoints& points, const Values& start) {
  constexpr std::size_t reach = 4;
  Pieces pieces(l, 0);
  const std::size_t row = l.row(), slab = l.slab();
  Corner c;
  for (const Vec3& p : points.points)
    if (corner_of(l, p, Vec3::Zero(), c)) pieces.mark(c.at % row, c.at % slab / row, c.at / slab, reach);
  for (int k = 1; k < l.dims[2]; ++k)
    for (int j = 1; j < l.dims[1]; ++j)
      for (std::size_t i = 1; i < row; ++i) {
        const std::size_t at = k * slab + j * row + i;
        const bool is_inside = start[at] > 0;
        if (is_inside != (start[at - 1] > 0) || is_inside != (start[at - row] > 0) ||
            is_inside != (start[at - slab] > 0))
          pieces.mark(i, j, k, reach);
      }
  pieces.spread(reach);
  return pieces.runs();
}

/// The equations on one lattice: the seven-point Laplacian plus, for each point, a pull of its value to 0.
class Equations {
 public:
  Equations(const Lattice& lattice, const OrientedPoints& points, double closeness)
      : lattice_(lattice), steps_(steps_of(lattice)) {
    parallel_for(4, 1, [&](std::size_t task, std::size_t) {
      if (task < 3)
        gather_slopes(points, task);
      else
        gather_points(points, closeness);
    });
  }

  /// At the nodes of `runs`, from the start in `x`, by conjugate gradients with the diagonal as preconditioner.
  void solve(Runs runs, Values& x, int iterations, const Progress& progress) {
    runs_ = std::move(runs);
    make_right_side();
    const std::size_t n = x.size();
    Values r(n, 0), p(n, 0), q(n, 0);
    apply(x, q);
    const double enough = 1e-10 * sum_nodes([&](std::size_t i) { return right_[i] * right_[i]; });
    double rz_before = 0, rz = sum_nodes([&](std::size_t i) {
                            r[i] = right_[i] - q[i];
                            return r[i] * r[i] * scale_[i];
                          });
    for (int k = 0; k < iterations && rz > enough; ++k) {
      progress.check();
      const float beta = k == 0 ? 0 : rz / rz_before;
      for_nodes([&](std::size_t i) { p[i] = r[i] * scale_[i] + beta * p[i]; });
      apply(p, q);
      const double pq = sum_nodes([&](std::size_t i) { return p[i] * q[i]; });
      if (!(pq > 0)) break;
      const float alpha = rz / pq;
      rz_before = rz;
      rz = sum_nodes([&](std::size_t i) {
        x[i] += alpha * p[i];
        r[i] -= alpha * q[i];
        return r[i] * r[i] * scale_[i];
      });
    }
  }

 private:
  /// The slope along an axis lives half way between nodes, where the difference of their values does.
  void gather_slopes(const OrientedPoints& points, int axis) {
    const double scale = 1 / (lattice_.side * lattice_.side);
    Values& slope = slopes_[axis];
    slope.assign(lattice_.size(), 0);
    const Vec3 shift = 0.5 * Vec3::Unit(axis);
    Corner c;
    for (std::size_t i = 0; i < points.points.size(); ++i) {
      if (!corner_of(lattice_, points.points[i], shift, c)) continue;
      const float v = -points.normals[i][axis] * points.areas[i] * scale;
      for (std::size_t n = 0; n < 8; ++n) slope[c.at + steps_[n]] += v * c.weight[n];
    }
  }

  void make_right_side() {
    right_.assign(lattice_.size(), 0);
    const std::array<std::size_t, 3> step{1, lattice_.row(), lattice_.slab()};
    for_nodes([&](std::size_t i) {
      float value = 0;
      for (std::size_t a = 0; a < 3; ++a) value -= slopes_[a][i] - slopes_[a][i - step[a]];
      right_[i] = value;
    });
    slopes_ = {};
  }

  void gather_points(const OrientedPoints& points, double closeness) {
    constexpr std::size_t grain = 1024;
    constexpr std::size_t nowhere = std::numeric_limits<std::size_t>::max();
    const double scale = closeness / (lattice_.side * lattice_.side);
    const std::size_t count = points.points.size();
    // Sorted by where they are, so that slabs of points can be worked on apart.
    std::vector<Corner> corners(count);
    std::vector<std::pair<std::size_t, std::uint32_t>> order(count);
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const bool is_here = corner_of(lattice_, points.points[i], Vec3::Zero(), corners[i]);
        order[i] = {is_here ? corners[i].at : nowhere, i};
      }
    });
    std::sort(order.begin(), order.end());
    while (!order.empty() && order.back().first == nowhere) order.pop_back();
    // Points of one cell add up to one symmetric form of its eight nodes.
    std::vector<std::size_t> first;
    for (std::size_t o = 0; o < order.size(); ++o)
      if (o == 0 || order[o].first != order[o - 1].first) first.push_back(o);
    cells_.resize(first.size());
    first.push_back(order.size());
    parallel_for(cells_.size(), grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        cells_[n] = {order[first[n]].first, {}};
        for (std::size_t o = first[n]; o < first[n + 1]; ++o) {
          const std::uint32_t i = order[o].second;
          const float pull = scale * points.areas[i];
          add_outer(pull, corners[i].weight, cells_[n].form);
        }
      }
    });
    find_slabs_of_cells();
    scale_.assign(lattice_.size(), 6);
    for (const Cell& cell : cells_)
      for (std::size_t m = 0, e = 0; m < 8; e += 8 - m, ++m) scale_[cell.at + steps_[m]] += cell.form[e];
    parallel_for(scale_.size(), 64 * grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) scale_[i] = 1 / scale_[i];
    });
  }

  static void add_outer(float factor, const std::array<float, 8>& w, std::array<float, 36>& form) {
    std::size_t e = 0;
    for (std::size_t m = 0; m < 8; ++m)
      for (std::size_t n = m; n < 8; ++n) form[e++] += factor * w[m] * w[n];
  }

  void find_slabs_of_cells() {
    const std::size_t slab = lattice_.slab();
    slab_of_cells_.assign(lattice_.dims[2] + 1, cells_.size());
    for (std::size_t n = cells_.size(); n > 0;) {
      --n;
      slab_of_cells_[cells_[n].at / slab] = n;
    }
    for (std::size_t k = slab_of_cells_.size() - 1; k > 0;) {
      --k;
      slab_of_cells_[k] = std::min(slab_of_cells_[k], slab_of_cells_[k + 1]);
    }
  }

  struct Cell {
    std::size_t at;
    std::array<float, 36> form;
  };

  void apply(const Values& x, Values& y) const {
    const Index row = lattice_.row(), slab = lattice_.slab();
    for_each_run([&](std::size_t first, std::size_t last) {
      const float* in = x.data() + first;
      float* out = y.data() + first;
      const Index length = last - first;
      for (Index i = 0; i < length; ++i)
        out[i] = 6 * in[i] - in[i - 1] - in[i + 1] - in[i - row] - in[i + row] - in[i - slab] - in[i + slab];
      return 0.0;
    });
    // Cells of one slab reach into the next, so every other slab of cells can be added at a time.
    for (const std::size_t odd : {0, 1})
      parallel_for(slab_of_cells_.size() / 2, 4, [&](std::size_t begin, std::size_t end) {
        for (std::size_t s = 2 * begin + odd; s < 2 * end + odd && s + 1 < slab_of_cells_.size(); s += 2)
          for (std::size_t c = slab_of_cells_[s]; c < slab_of_cells_[s + 1]; ++c) add_cell(cells_[c], x, y);
      });
  }

  void add_cell(const Cell& c, const Values& x, Values& y) const {
    std::array<float, 8> in{}, out{};
    for (std::size_t m = 0; m < 8; ++m) in[m] = x[c.at + steps_[m]];
    std::size_t e = 0;
    for (std::size_t m = 0; m < 8; ++m) {
      out[m] += c.form[e++] * in[m];
      for (std::size_t n = m + 1; n < 8; ++n, ++e) {
        out[m] += c.form[e] * in[n];
        out[n] += c.form[e] * in[m];
      }
    }
    for (std::size_t m = 0; m < 8; ++m) y[c.at + steps_[m]] += out[m];
  }

  /// Calls `body` with the first node of each run, and the one behind its last.
  template <class Body>
  double for_each_run(const Body& body) const {
    return parallel_sum(lattice_.dims[2] - 2, 4, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t r = runs_.first_of_slab[begin + 1]; r < runs_.first_of_slab[end + 1]; ++r)
        sum += body(runs_.nodes[r].first, runs_.nodes[r].second);
      return sum;
    });
  }

  template <class Body>
  void for_nodes(const Body& body) const {
    for_each_run([&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) body(i);
      return 0.0;
    });
  }

  /// Eight sums side by side in each run, so that the processor can work on them at once.
  template <class Body>
  double sum_nodes(const Body& body) const {
    return for_each_run([&](std::size_t first, std::size_t last) {
      std::array<float, 8> sums{};
      std::size_t i = first;
      for (; i + 8 <= last; i += 8)
        for (std::size_t lane = 0; lane < 8; ++lane) sums[lane] += body(i + lane);
      double sum = 0;
      for (; i < last; ++i) sum += body(i);
      for (const float s : sums) sum += s;
      return sum;
    });
  }

  const Lattice& lattice_;
  Runs runs_;
  std::array<std::size_t, 8> steps_;
  std::array<Values, 3> slopes_;
  Values right_, scale_;  // the right side, and one over the diagonal
  std::vector<Cell> cells_;
  std::vector<std::size_t> slab_of_cells_;  // where the cells of each slab begin, and the end
};

/// A coarse solution between its nodes. Node (i,j,k) of the coarse lattice is node (2i,2j,2k) of the fine one.
Values refined(const Lattice& coarse, const Values& x, const Lattice& fine) {
  Values y(fine.size());
  const std::size_t row = coarse.row(), slab = coarse.slab();
  parallel_for(fine.dims[2], 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (int j = 0; j < fine.dims[1]; ++j) {
        const std::size_t k0 = k / 2 * slab, k1 = (k + 1) / 2 * slab, j0 = j / 2 * row, j1 = (j + 1) / 2 * row;
        float* out = y.data() + (k * fine.dims[1] + j) * fine.dims[0];
        const auto mean = [&](std::size_t i) {
          return 0.25f * (x[k0 + j0 + i] + x[k0 + j1 + i] + x[k1 + j0 + i] + x[k1 + j1 + i]);
        };
        for (int i = 0; i < fine.dims[0]; ++i)
          out[i] = i % 2 == 0 ? mean(i / 2) : 0.5f * (mean(i / 2) + mean(i / 2 + 1));
      }
  });
  return y;
}

std::vector<Lattice> cascade(const OrientedPoints& points, const InsideOptions& options) {
  Eigen::AlignedBox3d box;
  for (const Vec3& p : points.points) box.extend(p);
  const double side = box.sizes().maxCoeff() / options.cells;
  int depth = 1;
  while ((options.cells >> depth) >= 12) ++depth;
  const int block = 1 << (depth - 1);
  const double margin = std::max(options.margin * box.sizes().maxCoeff(), 4 * side);
  Lattice fine{{}, side, {}};
  for (int a = 0; a < 3; ++a) {
    const int needed = ceil_int((box.sizes()[a] + 2 * margin) / side);
    fine.dims[a] = std::max(3, (needed + block - 1) / block) * block + 1;
    fine.origin[a] = box.center()[a] - 0.5 * (fine.dims[a] - 1) * side;
  }
  std::vector<Lattice> all{fine};
  for (int d = 1; d < depth; ++d) {
    Lattice next = all.back();
    next.side *= 2;
    for (int& n : next.dims) n = (n - 1) / 2 + 1;
    all.push_back(next);
  }
  return all;
}

/// Points merged in cells of half a step: what a coarse lattice sees of many points.
OrientedPoints merged(const OrientedPoints& all, double cell, const Vec3& origin) {
  const std::vector<InCell> order = by_cell(all.points, origin, cell);
  OrientedPoints few;
  for (std::size_t i = 0, last = 0; i < order.size(); i = last) {
    Vec3 place = Vec3::Zero(), normal = Vec3::Zero();
    double area = 0;
    for (last = i; last < order.size() && order[last].cell == order[i].cell; ++last) {
      const std::uint32_t k = order[last].index;
      place += all.areas[k] * all.points[k];
      normal += all.areas[k] * all.normals[k];
      area += all.areas[k];
    }
    if (!(area > 0)) continue;
    few.points.push_back(place / area);
    few.normals.push_back(normal / area);
    few.areas.push_back(area);
  }
  return few;
}

}  // namespace

Vec3 outwards(const IndicatorField& field, const Vec3& place) {
  const Lattice l{field.value.grid.dims, field.side, field.origin};
  const std::array<std::size_t, 8> steps = steps_of(l);
  const auto at = [&](const Vec3& p) -> double {
    Corner c;
    if (!corner_of(l, p, Vec3::Zero(), c)) return outside;
    double sum = 0;
    for (std::size_t n = 0; n < 8; ++n) sum += c.weight[n] * double{field.value.values[c.at + steps[n]]};
    return sum;
  };
  Vec3 down;
  for (int a = 0; a < 3; ++a) down[a] = at(place - field.side * Vec3::Unit(a)) - at(place + field.side * Vec3::Unit(a));
  const double length = down.norm();
  return length > 0 ? Vec3(down / length) : Vec3::Zero();
}

double share_turned(const OrientedPoints& points, const IndicatorField& field) {
  const double turned = parallel_sum(points.points.size(), 1024, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += points.normals[i].dot(outwards(field, points.points[i])) < 0;
    return sum;
  });
  return turned / points.points.size();
}

std::vector<IndicatorField> solve_indicator(const OrientedPoints& points, const InsideOptions& options,
                                            const Progress& progress) {
  progress("inside", 0, 1);
  const TraceStage noted("inside: field");
  const std::vector<Lattice> lattices = cascade(points, options);
  std::vector<OrientedPoints> seen(lattices.size());
  for (std::size_t l = 1; l < lattices.size(); ++l)
    seen[l] = merged(l == 1 ? points : seen[l - 1], 0.5 * lattices[l].side, lattices[l].origin);
  std::vector<std::optional<Equations>> equations(lattices.size());
  parallel_for(lattices.size(), 1, [&](std::size_t l, std::size_t) {
    equations[l].emplace(lattices[l], l == 0 ? points : seen[l], options.closeness);
  });
  std::vector<IndicatorField> fields;
  int iterations = 80;
  for (std::size_t l = lattices.size(); l > 0;) {
    --l;
    progress("inside", lattices.size() - l - 1, lattices.size());
    const Lattice& lattice = lattices[l];
    Values x = fields.empty() ? Values(lattice.size(), outside)
                              : refined(lattices[l + 1], fields.back().value.values, lattice);
    const OrientedPoints& here = l == 0 ? points : seen[l];
    Runs runs = fields.empty() ? all_nodes(lattice) : nodes_near_surface(lattice, here, x);
    equations[l]->solve(std::move(runs), x, iterations, progress);
    equations[l].reset();
    iterations = std::max(10, iterations * 2 / 3);
    IndicatorField field;
    field.value.grid = Grid{.dims = lattice.dims};
    field.value.values = std::move(x);
    field.side = lattice.side;
    field.origin = lattice.origin;
    fields.push_back(std::move(field));
  }
  progress("inside", lattices.size(), lattices.size());
  return fields;
}

}  // namespace dynasurf::cloud
