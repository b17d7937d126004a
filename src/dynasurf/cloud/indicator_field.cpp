#include "dynasurf/cloud/detail/indicator_field.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "dynasurf/cloud/detail/by_cell.hpp"
#include "dynasurf/cloud/detail/lattice_equations.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr float outside = -0.5f;

using Values = std::vector<float>;

/// Rows are cut in pieces that the processor can work on at once; a run is made of whole ones.
class Pieces {
 public:
  explicit Pieces(const Lattice& l, std::uint8_t marked)
      : l_(l),
        per_row_((l.dims[0] + length - 3) / length),
        per_slab_(per_row_ * l.dims[1]),
        marks_(per_slab_ * l.dims[2], marked) {}

  /// Those within `reach` nodes of node (i, j, k) along its row; rows may be marked at the same time.
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
  parallel_for(l.dims[2] - 1, 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin + 1; k <= end; ++k)
      for (int j = 1; j < l.dims[1]; ++j)
        for (std::size_t i = 1; i < row; ++i) {
          const std::size_t at = k * slab + j * row + i;
          const bool is_inside = start[at] > 0;
          if (is_inside != (start[at - 1] > 0) || is_inside != (start[at - row] > 0) ||
              is_inside != (start[at - slab] > 0))
            pieces.mark(i, j, k, reach);
        }
  });
  pieces.spread(reach);
  return pieces.runs();
}

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

double value_at(const IndicatorField& field, const Vec3& place) {
  const Lattice l{field.value.grid.dims, field.side, field.origin};
  Corner c;
  if (!corner_of(l, place, Vec3::Zero(), c)) return outside;
  const std::array<std::size_t, 8> steps = steps_of(l);
  double sum = 0;
  for (std::size_t n = 0; n < 8; ++n) sum += c.weight[n] * double{field.value.values[c.at + steps[n]]};
  return sum;
}

Vec3 outwards(const IndicatorField& field, const Vec3& place) {
  Vec3 down;
  for (int a = 0; a < 3; ++a) {
    const Vec3 step = field.side * Vec3::Unit(a);
    down[a] = value_at(field, place - step) - value_at(field, place + step);
  }
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
  std::vector<std::optional<LatticeEquations>> equations(lattices.size());
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
