#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include "dynasurf/core/error.hpp"
#include "dynasurf/dynamics/contour/contours.hpp"

namespace dynasurf::dynamics {
namespace {

constexpr float strong_gradient = 0.5F;  // of the largest

/// What the nodes see, per pixel, all from 0 to 1 but for the distance.
struct Scene {
  Image object;    // mean over the window: 1 inside of objects
  Image gradient;  // of the smoothed plane
  Image distance;  // px to the nearest strong gradient
  bool flat = false;
};

struct Box {
  double x0, y0, x1, y1;
};

Image window_mean(const Image& plane, int window) {
  const int before = (window - 1) / 2, after = window / 2;
  Image out(plane.grid);
  for (int j = 0; j < plane.grid.dims[1]; ++j)
    for (int i = 0; i < plane.grid.dims[0]; ++i) {
      float sum = 0;
      for (int b = -before; b <= after; ++b)
        for (int a = -before; a <= after; ++a) sum += plane.clamped(i + a, j + b, 0);
      out(i, j, 0) = sum / (window * window);
    }
  return out;
}

Image distance_to_strong(const Image& gradient) {
  std::vector<Vec2> strong;
  const auto& n = gradient.grid.dims;
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i)
      if (gradient(i, j, 0) >= strong_gradient) strong.push_back(Vec2(i, j));
  Image out(gradient.grid);
  for (int j = 0; j < n[1]; ++j)
    for (int i = 0; i < n[0]; ++i) {
      double least = std::numeric_limits<double>::max();
      for (const Vec2& p : strong) least = std::min(least, (p - Vec2(i, j)).squaredNorm());
      out(i, j, 0) = std::sqrt(least);
    }
  return out;
}

Scene look_at(const Image& plane, const ActiveNet& o) {
  Scene scene;
  const auto [low, high] = std::minmax_element(plane.values.begin(), plane.values.end());
  const float bottom = *low, range = *high - *low;
  scene.flat = !(range > 0);
  if (scene.flat) return scene;
  Image normal = plane;
  for (float& v : normal.values) {
    v = (v - bottom) / range;
    if (o.dark_objects) v = 1 - v;
  }
  scene.object = window_mean(normal, o.window);
  scene.gradient = image_potential(normal, {PotentialSource::gradient, o.sigma_px});
  for (float& v : scene.gradient.values) v = -v;
  scene.distance = distance_to_strong(scene.gradient);
  return scene;
}

/// The net while it moves: a lattice of nodes with the squares that are left.
class Lattice {
 public:
  Lattice(const Box& box, int rows, int columns, const Scene& scene, const ActiveNet& options)
      : rows_(rows), columns_(columns), scene_(scene), o_(options), quads_((rows - 1) * (columns - 1), 1) {
    for (int r = 0; r < rows; ++r)
      for (int c = 0; c < columns; ++c)
        nodes_.push_back(Vec2(std::round(box.x0 + (box.x1 - box.x0) * c / (columns - 1)),
                              std::round(box.y0 + (box.y1 - box.y0) * r / (rows - 1))));
    spacing_ = std::max(1.0, ((box.x1 - box.x0) / (columns - 1) + (box.y1 - box.y0) / (rows - 1)) / 2);
  }

  void relax() {
    for (int sweep = 0; sweep < o_.max_sweeps; ++sweep) {
      ++sweeps_;
      bool moved = false;
      for (int r = 0; r < rows_; ++r)
        for (int c = 0; c < columns_; ++c)
          if (quads_around(r, c) > 0) moved = improve(r, c) || moved;
      if (!moved) return;
    }
  }

  /// Breaks the worst link of the rim; false when there is none.
  bool break_worst_link() {
    double worst = 0;
    int worst_quad = -1;
    for (int r = 0; r + 1 < rows_; ++r)
      for (int c = 0; c + 1 < columns_; ++c) {
        if (!quad(r, c)) continue;
        const auto consider = [&](bool free, int r0, int c0, int r1, int c1) {
          if (!free) return;
          if (const double b = badness(node(r0, c0), node(r1, c1)); b > worst)
            worst = b, worst_quad = r * (columns_ - 1) + c;
        };
        consider(!quad(r - 1, c), r, c, r, c + 1);
        consider(!quad(r + 1, c), r + 1, c, r + 1, c + 1);
        consider(!quad(r, c - 1), r, c, r + 1, c);
        consider(!quad(r, c + 1), r, c + 1, r + 1, c + 1);
      }
    if (worst_quad < 0) return false;
    quads_[worst_quad] = 0;
    ++broken_;
    return true;
  }

  /// Opens the net at the internal node that lies deepest in the background; false when there is none.
  bool open_worst_hole() {
    double worst = o_.hole_level;
    int worst_r = -1, worst_c = -1;
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c)
        if (quads_around(r, c) == 4)
          if (const double b = 1 - value(scene_.object, node(r, c)); b > worst) worst = b, worst_r = r, worst_c = c;
    if (worst_r < 0) return false;
    for (int a = -1; a <= 0; ++a)
      for (int b = -1; b <= 0; ++b) quads_[quad_index(worst_r + a, worst_c + b)] = 0;
    broken_ += 4;
    return true;
  }

  Net result() const {
    Net net;
    net.sweeps = sweeps_;
    net.broken_links = broken_;
    std::vector<std::uint32_t> number(nodes_.size());
    for (int r = 0; r < rows_; ++r)
      for (int c = 0; c < columns_; ++c)
        if (const int around = quads_around(r, c); around > 0) {
          number[index(r, c)] = net.nodes.size();
          net.nodes.push_back(node(r, c));
          net.external.push_back(around < 4);
        }
    for (int r = 0; r + 1 < rows_; ++r)
      for (int c = 0; c + 1 < columns_; ++c)
        if (quad(r, c))
          net.quads.push_back(
              {number[index(r, c)], number[index(r, c + 1)], number[index(r + 1, c + 1)], number[index(r + 1, c)]});
    return net;
  }

 private:
  std::size_t index(int r, int c) const { return r * columns_ + c; }
  std::size_t quad_index(int r, int c) const { return r * (columns_ - 1) + c; }
  const Vec2& node(int r, int c) const { return nodes_[index(r, c)]; }
  bool quad(int r, int c) const {
    return r >= 0 && c >= 0 && r + 1 < rows_ && c + 1 < columns_ && quads_[quad_index(r, c)] != 0;
  }
  int quads_around(int r, int c) const { return quad(r - 1, c - 1) + quad(r - 1, c) + quad(r, c - 1) + quad(r, c); }
  /// A link lives as long as one of its two squares does.
  bool row_link(int r, int c) const { return quad(r - 1, c) || quad(r, c); }     // (r,c)-(r,c+1)
  bool column_link(int r, int c) const { return quad(r, c - 1) || quad(r, c); }  // (r,c)-(r+1,c)

  static double value(const Image& image, const Vec2& p) { return image.clamped(p.x(), p.y(), 0); }

  /// Sum of the distances from strong gradients at both ends and the middle of a link of the rim, where one of them
  /// lies in the background and too far from every border; else 0. The ends alone would not do: those of a link from
  /// one object to the next may both lie on borders.
  double badness(const Vec2& a, const Vec2& b) const {
    double sum = 0;
    bool bad = false;
    for (const Vec2& p : {a, Vec2((a + b) / 2), b}) {
      const double d = value(scene_.distance, p);
      bad = bad || (d > o_.bad_distance_px && value(scene_.object, p) < 0.5);
      sum += d;
    }
    return bad ? sum : 0;
  }

  double internal_energy(int r, int c, const Vec2& p) const {
    const bool left = row_link(r, c - 1), right = row_link(r, c), up = column_link(r - 1, c), down = column_link(r, c);
    double stretch = 0, bend = 0;
    const auto add = [&](bool linked, int a, int b) {
      if (linked) stretch += (node(a, b) - p).squaredNorm() / 2;
    };
    add(left, r, c - 1), add(right, r, c + 1), add(up, r - 1, c), add(down, r + 1, c);
    if (left && right) bend += (node(r, c - 1) - 2 * p + node(r, c + 1)).squaredNorm();
    if (up && down) bend += (node(r - 1, c) - 2 * p + node(r + 1, c)).squaredNorm();
    for (int a = -1; a <= 1; a += 2)
      for (int b = -1; b <= 1; b += 2)  // twist |v_rs|^2, the mean over the squares around
        if (quad(a < 0 ? r - 1 : r, b < 0 ? c - 1 : c))
          bend += (node(r + a, c + b) - node(r + a, c) - node(r, c + b) + p).squaredNorm() / 2;
    return (o_.alpha * stretch + o_.beta * bend) / (spacing_ * spacing_);
  }

  double energy(int r, int c, const Vec2& p) const {
    const double e = internal_energy(r, c, p), object = value(scene_.object, p);
    if (quads_around(r, c) == 4) return e + 1 - object;
    const double far = o_.reach * value(scene_.distance, p);
    return e + object + o_.xi * (1 - value(scene_.gradient, p)) + far;
  }

  bool improve(int r, int c) {
    const Vec2 here = node(r, c);
    const auto& n = scene_.object.grid.dims;
    Vec2 best = here;
    double least = energy(r, c, here) - 1e-9;
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx) {
        const Vec2 p = here + Vec2(dx, dy);
        if (p.x() < 0 || p.y() < 0 || p.x() > n[0] - 1 || p.y() > n[1] - 1) continue;
        if (const double e = energy(r, c, p); e < least) least = e, best = p;
      }
    nodes_[index(r, c)] = best;
    return best != here;
  }

  int rows_, columns_;
  const Scene& scene_;
  const ActiveNet& o_;
  double spacing_ = 1;
  std::vector<Vec2> nodes_;
  std::vector<std::uint8_t> quads_;
  int sweeps_ = 0, broken_ = 0;
};

/// Part of each node, from 0; nodes that share a square belong together.
std::vector<int> parts_of(const Net& net, int& count) {
  std::vector<std::uint32_t> parent(net.nodes.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& q : net.quads)
    for (std::size_t i = 1; i < 4; ++i) parent[root(q[i])] = root(q[0]);
  std::map<std::uint32_t, int> number;
  std::vector<int> part;
  for (std::uint32_t v = 0; v < parent.size(); ++v)
    part.push_back(number.emplace(root(v), number.size()).first->second);
  count = number.size();
  return part;
}

/// The topological steps, one link or node at a time, each followed by a new minimum.
Net settle(Lattice lattice) {
  lattice.relax();
  for (bool changed = true; changed;) {
    changed = lattice.break_worst_link() || lattice.open_worst_hole();
    if (changed) lattice.relax();
  }
  return lattice.result();
}

Net only_part(const Net& net, const std::vector<int>& part, int wanted) {
  Net out;
  out.sweeps = net.sweeps;
  out.broken_links = net.broken_links;
  std::vector<std::uint32_t> number(net.nodes.size());
  for (std::size_t v = 0; v < net.nodes.size(); ++v)
    if (part[v] == wanted) {
      number[v] = out.nodes.size();
      out.nodes.push_back(net.nodes[v]);
      out.external.push_back(net.external[v]);
    }
  for (const auto& q : net.quads)
    if (part[q[0]] == wanted) out.quads.push_back({number[q[0]], number[q[1]], number[q[2]], number[q[3]]});
  return out;
}

std::optional<Net> largest_part(const Net& net) {
  int count = 0;
  const std::vector<int> part = parts_of(net, count);
  if (count == 0) return std::nullopt;
  std::vector<int> size(count, 0);
  for (const int p : part) ++size[p];
  return only_part(net, part, std::max_element(size.begin(), size.end()) - size.begin());
}

Box box_around(const Net& net, const std::vector<int>& part, int wanted, double margin, const Grid& grid) {
  Box box{1e9, 1e9, -1e9, -1e9};
  for (std::size_t v = 0; v < net.nodes.size(); ++v) {
    if (part[v] != wanted) continue;
    const Vec2& p = net.nodes[v];
    box = {std::min(box.x0, p.x()), std::min(box.y0, p.y()), std::max(box.x1, p.x()), std::max(box.y1, p.y())};
  }
  return {std::max(0.0, box.x0 - margin), std::max(0.0, box.y0 - margin), std::min(grid.dims[0] - 1.0, box.x1 + margin),
          std::min(grid.dims[1] - 1.0, box.y1 + margin)};
}

Box whole(const Grid& grid) { return {0, 0, grid.dims[0] - 1.0, grid.dims[1] - 1.0}; }

void check_plane(const Image& plane) {
  if (plane.grid.dims[0] < 8 || plane.grid.dims[1] < 8 || plane.grid.dims[2] != 1)
    throw InputError("a net needs a plane of 8 x 8 px or more; this one has " + std::to_string(plane.grid.dims[0]) +
                     " x " + std::to_string(plane.grid.dims[1]) + " x " + std::to_string(plane.grid.dims[2]));
  for (const float v : plane.values)
    if (!std::isfinite(v)) throw InputError("a net needs a plane whose values are finite");
}

}  // namespace

NetShape shape_of(const Net& net) {
  NetShape shape;
  parts_of(net, shape.parts);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> links;
  for (const auto& q : net.quads)
    for (std::size_t i = 0; i < 4; ++i) ++links[std::minmax(q[i], q[(i + 1) % 4])];
  const Index euler = std::ssize(net.nodes) - std::ssize(links) + std::ssize(net.quads);
  shape.holes = shape.parts - euler;
  return shape;
}

Net fit_net(const Image& plane, const ActiveNet& requested) {
  ActiveNet o = requested;
  check_options(o, "net");
  check_plane(plane);
  const Scene scene = look_at(plane, o);
  if (scene.flat) return {};
  Lattice lattice(whole(plane.grid), o.rows, o.columns, scene, o);
  lattice.relax();
  return lattice.result();
}

std::vector<Net> fit_topological_nets(const Image& plane, const ActiveNet& requested) {
  ActiveNet o = requested;
  check_options(o, "net");
  check_plane(plane);
  const Scene scene = look_at(plane, o);
  if (scene.flat) return {};
  const Net sparse = settle(Lattice(whole(plane.grid), o.sparse, o.sparse, scene, o));
  int count = 0;
  const std::vector<int> part = parts_of(sparse, count);
  std::vector<Net> nets;
  for (int p = 0; p < count; ++p) {
    const Box box = box_around(sparse, part, p, 3, plane.grid);
    if (auto net = largest_part(settle(Lattice(box, o.rows, o.columns, scene, o)))) nets.push_back(std::move(*net));
  }
  return nets;
}

}  // namespace dynasurf::dynamics
