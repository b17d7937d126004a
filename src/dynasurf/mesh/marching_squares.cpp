#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/marching.hpp"

namespace dynasurf::mesh {
namespace {

constexpr double kKeepAwayFromPixels = 1e-3;  // of vertices from pixel centres, share of an edge

/// The lines of one slice, as a successor for every edge of its lattice: edge 2 p runs from pixel p along x, edge
/// 2 p + 1 along y. Every crossed edge inside the slice has one predecessor and one successor.
class Squares {
 public:
  Squares(const Image& image, int k, double level, Saddle saddle)
      : image_(image), k_(k), level_(level), saddle_(saddle), width_(image.grid.dims[0]), height_(image.grid.dims[1]) {
    next_.assign(2 * image.grid.slice_size(), -1);
    is_reached_.assign(next_.size(), 0);
    for (int j = 0; j + 1 < height_; ++j)
      for (int i = 0; i + 1 < width_; ++i) visit(i, j);
  }

  std::vector<IsoLine> operator()() {
    std::vector<IsoLine> lines;
    for (const bool open : {true, false})  // lines that begin at the border first, or they would be cut in two
      for (std::size_t e = 0; e < next_.size(); ++e)
        if (next_[e] >= 0 && (!open || is_reached_[e] == 0)) lines.push_back(follow(e));
    return lines;
  }

 private:
  double above_level(int i, int j) const { return image_(i, j, k_) - level_; }
  int edge_x(int i, int j) const { return 2 * (i + width_ * j); }
  int edge_y(int i, int j) const { return 2 * (i + width_ * j) + 1; }

  void visit(int i, int j) {
    // Corners and sides counter-clockwise; side c runs from corner c to the next.
    const std::array<double, 4> value{above_level(i, j), above_level(i + 1, j), above_level(i + 1, j + 1),
                                      above_level(i, j + 1)};
    const std::array<int, 4> side{edge_x(i, j), edge_y(i + 1, j), edge_x(i, j + 1), edge_y(i, j)};
    const auto above = [&](std::size_t c) { return value[c % 4] >= 0; };
    std::array<int, 2> enter{}, leave{};
    std::size_t count = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      if (above(c) || !above(c + 1)) continue;
      std::size_t last = c + 1;
      while (above(last + 1)) ++last;
      enter[count] = side[c];
      leave[count++] = side[last % 4];
    }
    if (count == 2 && is_joined(value)) std::swap(leave[0], leave[1]);
    for (std::size_t s = 0; s < count; ++s) {
      next_[leave[s]] = enter[s];
      is_reached_[enter[s]] = 1;
    }
  }

  bool is_joined(const std::array<double, 4>& v) const {
    if (saddle_ != Saddle::asymptotic) return saddle_ == Saddle::joined;
    const double even = v[0] * v[2], odd = v[1] * v[3];
    return v[0] >= 0 ? even > odd : odd > even;
  }

  IsoLine follow(int edge) {
    IsoLine line{point_on(edge)};
    while (next_[edge] >= 0) {
      edge = std::exchange(next_[edge], -1);
      line.push_back(point_on(edge));
    }
    return line;
  }

  Eigen::Vector2d point_on(int edge) const {
    const int i = edge / 2 % width_, j = edge / 2 / width_, axis = edge % 2;
    const double a = above_level(i, j), b = above_level(i + (axis == 0 ? 1 : 0), j + axis);
    Eigen::Vector2d p(i, j);
    p[axis] += std::clamp(a / (a - b), kKeepAwayFromPixels, 1 - kKeepAwayFromPixels);
    return p.cwiseProduct(image_.grid.spacing.head<2>());
  }

  const Image& image_;
  const int k_;
  const double level_;
  const Saddle saddle_;
  const int width_, height_;
  std::vector<int> next_;
  std::vector<std::uint8_t> is_reached_;
};

}  // namespace

std::span<const std::string_view> names_of(Saddle) {
  static constexpr std::array<std::string_view, 3> names{"joined", "separated", "asymptotic"};
  return names;
}

std::vector<IsoLine> marching_squares(const Image& image, int k, double level, Saddle saddle) {
  const Grid& g = image.grid;
  if (!std::isfinite(level)) throw InputError("marching squares: the level is not finite");
  if (k < 0 || k >= g.dims[2])
    throw InputError("marching squares: slice " + std::to_string(k) + " of " + std::to_string(g.dims[2]));
  for (int j = 0; j < g.dims[1]; ++j)
    for (int i = 0; i < g.dims[0]; ++i)
      if (!std::isfinite(image(i, j, k))) throw InputError("marching squares: a value of the slice is not finite");
  return Squares(image, k, level, saddle)();
}

}  // namespace dynasurf::mesh
