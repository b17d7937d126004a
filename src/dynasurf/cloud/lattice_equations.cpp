#include "dynasurf/cloud/detail/lattice_equations.hpp"

#include <algorithm>

#include "dynasurf/core/detail/lanes.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

using Eight = simd::Pack<float, 8, 4>;
using One = simd::Pack<float, 1, 1>;
template <class V>
V get(const std::vector<float>& values, std::size_t i) {
  return simd::load<V>(values.data() + i);
}
template <class V>
void set(std::vector<float>& values, std::size_t i, V to) {
  simd::store(values.data() + i, to);
}

/// Loops over the nodes that are solved for, in pieces that are the same for any number of threads.
struct NodeLoops {
  const Lattice& lattice;
  const Runs& runs;

  /// Calls `body` with the first node of each run, and the one behind its last.
  template <class Body>
  double for_each_run(const Body& body) const {
    return parallel_sum(lattice.dims[2] - 2, 4, [&](std::size_t begin, std::size_t end) {
      double sum = 0;
      for (std::size_t r = runs.first_of_slab[begin + 1]; r < runs.first_of_slab[end + 1]; ++r)
        sum += body(runs.nodes[r].first, runs.nodes[r].second);
      return sum;
    });
  }

  /// Calls `body` for the nodes, eight at a time where a run holds them.
  template <class Body>
  void for_nodes(const Body& body) const {
    for_each_run([&](std::size_t first, std::size_t last) {
      for (; first + 8 <= last; first += 8) body.template operator()<Eight>(first);
      for (; first < last; ++first) body.template operator()<One>(first);
      return 0.0;
    });
  }

  /// Adds up what `body` returns.
  template <class Body>
  double sum_nodes(const Body& body) const {
    return for_each_run([&](std::size_t first, std::size_t last) {
      Eight eight(0);
      for (; first + 8 <= last; first += 8) eight += body.template operator()<Eight>(first);
      std::array<float, 8> sums{};
      simd::store(sums.data(), eight);
      double sum = 0;
      for (; first < last; ++first) {
        float one = 0;
        simd::store(&one, body.template operator()<One>(first));
        sum += one;
      }
      for (const float s : sums) sum += s;
      return sum;
    });
  }
};

void add_outer(float factor, const std::array<float, 8>& w, std::array<float, 64>& form) {
  for (std::size_t m = 0; m < 8; ++m)
    for (std::size_t n = 0; n < 8; ++n) form[8 * m + n] += factor * (w[m] * w[n]);
}

}  // namespace

LatticeEquations::LatticeEquations(const Lattice& lattice, const OrientedPoints& points, double closeness)
    : lattice_(lattice), steps_(steps_of(lattice)) {
  gather_cells(points, closeness);
  right_.assign(lattice_.size(), 0);
  scale_.assign(lattice_.size(), 6);
  const std::size_t slabs = slab_of_cells_.size() - 1;
  // A slab of cells reaches into the nodes before it and two behind it, so every other group can be added at a time.
  constexpr std::size_t group = 4;
  for (const std::size_t odd : {0, 1})
    parallel_for((slabs + 2 * group - 1) / (2 * group), 1, [&](std::size_t n, std::size_t) {
      const std::size_t first = (2 * n + odd) * group;
      for (std::size_t c = slab_of_cells_[std::min(first, slabs)]; c < slab_of_cells_[std::min(first + group, slabs)];
           ++c) {
        for (std::size_t o = first_of_cell_[c]; o < first_of_cell_[c + 1]; ++o) add_slopes(points, order_[o].index);
        for (std::size_t m = 0; m < 8; ++m) scale_[cells_[c].at + steps_[m]] += cells_[c].form[9 * m];
      }
    });
  order_ = {}, first_of_cell_ = {};
}

/// The slope along an axis lives half way between nodes, where the difference of their values does; the right side is
/// what flows out of a node.
void LatticeEquations::add_slopes(const OrientedPoints& points, std::uint32_t i) {
  const double scale = 1 / (lattice_.side * lattice_.side);
  const std::array<std::size_t, 3> next{1, lattice_.row(), lattice_.slab()};
  Corner c;
  for (int axis = 0; axis < 3; ++axis) {
    if (!corner_of(lattice_, points.points[i], 0.5 * Vec3::Unit(axis), c)) continue;
    if (c.at + steps_[7] + next[axis] >= right_.size()) continue;  // beyond the nodes that are solved for
    const float v = -points.normals[i][axis] * points.areas[i] * scale;
    for (std::size_t n = 0; n < 8; ++n) {
      const float slope = v * c.weight[n];
      right_[c.at + steps_[n]] -= slope;
      right_[c.at + steps_[n] + next[axis]] += slope;
    }
  }
}

void LatticeEquations::gather_cells(const OrientedPoints& points, double closeness) {
  constexpr std::size_t grain = 1024;
  const double scale = closeness / (lattice_.side * lattice_.side);
  // Slabs of points can be worked on apart, and those of one cell add up to one symmetric form of its eight nodes.
  order_ = by_cell(points.points, lattice_.origin, lattice_.side);
  for (std::size_t o = 0; o < order_.size(); ++o)
    if (o == 0 || order_[o].cell != order_[o - 1].cell) first_of_cell_.push_back(o);
  cells_.resize(first_of_cell_.size());
  first_of_cell_.push_back(order_.size());
  parallel_for(cells_.size(), grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      Corner corner;
      cells_[n].form = {};
      for (std::size_t o = first_of_cell_[n]; o < first_of_cell_[n + 1]; ++o) {
        const std::uint32_t i = order_[o].index;
        if (!corner_of(lattice_, points.points[i], Vec3::Zero(), corner)) continue;
        const float pull = scale * points.areas[i];
        add_outer(pull, corner.weight, cells_[n].form);
      }
      cells_[n].at = corner.at;
    }
  });
  find_slabs_of_cells();
}

void LatticeEquations::find_slabs_of_cells() {
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

void LatticeEquations::solve(Runs runs, Values& x, int iterations, const Progress& progress) {
  runs_ = std::move(runs);
  const NodeLoops loops{lattice_, runs_};
  Values &r = right_, p(x.size(), 0), q(x.size(), 0);
  apply(x, q);
  const double enough = 1e-10 * loops.sum_nodes([&]<class V>(std::size_t i) { return get<V>(r, i) * get<V>(r, i); });
  double rz_before = 0, rz = loops.sum_nodes([&]<class V>(std::size_t i) {
    const V left = get<V>(r, i) - get<V>(q, i), scale = V(1) / get<V>(scale_, i);
    set(r, i, left);
    set(scale_, i, scale);
    return left * left * scale;
  });
  float alpha = 0;
  const auto follow = [&]<class V>(std::size_t i) { set(x, i, get<V>(x, i) + V(alpha) * get<V>(p, i)); };
  for (int k = 0; k < iterations && rz > enough; ++k) {
    progress.check();
    const float beta = k == 0 ? 0 : rz / rz_before;
    loops.for_nodes([&]<class V>(std::size_t i) {
      follow.template operator()<V>(i);  // a step behind, where p is at hand
      set(p, i, get<V>(r, i) * get<V>(scale_, i) + V(beta) * get<V>(p, i));
    });
    const double pq = apply(p, q);
    alpha = 0;
    if (!(pq > 0)) break;
    alpha = rz / pq;
    rz_before = rz;
    rz = loops.sum_nodes([&]<class V>(std::size_t i) {
      const V left = get<V>(r, i) - V(alpha) * get<V>(q, i);
      set(r, i, left);
      return left * left * get<V>(scale_, i);
    });
  }
  loops.for_nodes(follow);
}

/// y = Ax; returns the sum of xy.
double LatticeEquations::apply(const Values& x, Values& y) const {
  const NodeLoops loops{lattice_, runs_};
  const std::size_t row = lattice_.row(), slab = lattice_.slab();
  double sum = loops.sum_nodes([&]<class V>(std::size_t i) {
    const V here = get<V>(x, i), along = get<V>(x, i - 1) + get<V>(x, i + 1),
            across = get<V>(x, i - row) + get<V>(x, i + row) + get<V>(x, i - slab) + get<V>(x, i + slab);
    const V out = V(6) * here - along - across;
    set(y, i, out);
    return here * out;
  });
  // Cells of one slab reach into the next, so every other slab of cells can be added at a time.
  for (const std::size_t odd : {0, 1})
    sum += parallel_sum(slab_of_cells_.size() / 2, 4, [&](std::size_t begin, std::size_t end) {
      double of_cells = 0;
      for (std::size_t s = 2 * begin + odd; s < 2 * end + odd && s + 1 < slab_of_cells_.size(); s += 2)
        for (std::size_t c = slab_of_cells_[s]; c < slab_of_cells_[s + 1]; ++c) of_cells += add_cell(cells_[c], x, y);
      return of_cells;
    });
  return sum;
}

double LatticeEquations::add_cell(const Cell& c, const Values& x, Values& y) const {
  std::array<float, 8> in{}, out{};
  for (std::size_t m = 0; m < 8; ++m) in[m] = x[c.at + steps_[m]];
  Eight sum(0);
  for (std::size_t m = 0; m < 8; ++m) sum += Eight(in[m]) * simd::load<Eight>(c.form.data() + 8 * m);
  simd::store(out.data(), sum);
  float both = 0;
  for (std::size_t m = 0; m < 8; ++m) {
    y[c.at + steps_[m]] += out[m];
    both += in[m] * out[m];
  }
  return both;
}

}  // namespace dynasurf::cloud
