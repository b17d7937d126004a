#include "dynasurf/cloud/detail/orient.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <queue>
#include <span>
#include <unordered_map>

#include "dynasurf/cloud/detail/by_cell.hpp"
#include "dynasurf/cloud/detail/kd_tree.hpp"
#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/symmetric_axes.hpp"
#include "dynasurf/core/detail/trace.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::cloud {
namespace {

constexpr std::size_t links = 8;  // neighbours that pass the direction on
constexpr std::size_t orient_grain = 1024;
constexpr std::uint32_t none = 0xffffffff;

using Ring = std::array<std::uint32_t, links>;

struct Plane {
  Vec3 middle = Vec3::Zero(), normal = Vec3::UnitZ();
};

/// The farther a neighbour lies, the less it counts: along a tear the last of them may belong to the other side of a
/// wall. Neighbours come nearest first.
double weight_of(const KdTree::Found& f, std::span<const KdTree::Found> all) {
  return 1.1 * all.back().distance2 - f.distance2;
}

Plane plane_of(const std::vector<Vec3>& points, std::span<const KdTree::Found> found) {
  Plane plane;
  double weights = 0;
  for (const auto& f : found) {
    weights += weight_of(f, found);
    plane.middle += weight_of(f, found) * points[f.index];
  }
  if (!(weights > 0)) return {points[found.front().index]};
  plane.middle /= weights;
  Mat3 spread = Mat3::Zero();
  for (const auto& f : found) {
    const Vec3 off = points[f.index] - plane.middle;
    spread += weight_of(f, found) * off * off.transpose();
  }
  const double scale = spread.trace();
  if (!(scale > 0)) return plane;
  const Vec3 n = symmetric_axes(spread / scale).directions.col(0);
  if (n.allFinite() && n.squaredNorm() > 0.5) plane.normal = n.normalized();
  return plane;
}

/// Sets that are joined, each member knowing whether it is turned against the first of its set.
class Turns {
 public:
  explicit Turns(std::size_t count) : parent_(count), turned_(count, 0) {
    std::iota(parent_.begin(), parent_.end(), 0u);
  }
  std::uint32_t find(std::uint32_t i, std::uint8_t& turned) {
    std::uint32_t root = i;
    turned = 0;
    for (; parent_[root] != root; root = parent_[root]) turned ^= turned_[root];
    std::uint8_t rest = turned;
    for (std::uint32_t next; parent_[i] != root && i != root; i = next) {
      next = parent_[i];
      const std::uint8_t own = turned_[i];
      parent_[i] = root;
      turned_[i] = rest;
      rest ^= own;
    }
    return root;
  }
  void join(std::uint32_t a, std::uint32_t b, bool against) {
    std::uint8_t of_a = 0, of_b = 0;
    std::uint32_t root_a = find(a, of_a), root_b = find(b, of_b);
    if (root_a == root_b) return;
    if (root_b < root_a) std::swap(root_a, root_b);
    parent_[root_b] = root_a;
    turned_[root_b] = of_a ^ of_b ^ (against ? 1 : 0);
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> turned_;
};

struct Link {
  std::uint32_t a, b;
  float clarity;  // 1 where it leaves no doubt, 0 where it says nothing
  bool against;
};

/// Links of all neighbours in steps of falling clarity. They are many, so each is told when it is asked for.
class LinksByClarity {
 public:
  LinksByClarity(const OrientedPoints& o, const std::vector<Ring>& around)
      : around_(around), step_(around.size() * links, steps), against_(step_.size(), 0) {
    parallel_for(around.size(), orient_grain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        for (std::size_t k = 0; k < links && around[i][k] != none; ++k) {
          const std::uint32_t j = around[i][k];
          const Vec3 d = (o.points[j] - o.points[i]).normalized();
          const double across_i = o.normals[i].dot(d), across_j = o.normals[j].dot(d);
          // The normal that j would have were it i's mirror image half way between them: the same on a circle.
          const double agreement = o.normals[i].dot(o.normals[j]) - 2 * across_i * across_j;
          const double cost = 1 - std::abs(agreement) + 0.5 * std::abs(across_i * across_j);
          step_[i * links + k] = std::clamp(cost, 0.0, 1.0) * (steps - 1);
          against_[i * links + k] = agreement < 0;
        }
    });
    std::vector<std::uint32_t> first(steps + 2, 0);
    for (const std::uint16_t s : step_) ++first[s + 1u];
    std::partial_sum(first.begin(), first.end(), first.begin());
    sorted_.resize(first[steps]);
    for (std::uint32_t e = 0; e < step_.size(); ++e)
      if (step_[e] < steps) sorted_[first[step_[e]]++] = e;
  }

  std::size_t size() const { return sorted_.size(); }
  Link operator[](std::size_t n) const {
    const std::uint32_t e = sorted_[n];
    const float doubt = step_[e];
    return {e / std::uint32_t{links}, around_[e / links][e % links], 1 - doubt / (steps - 1), against_[e] != 0};
  }

 private:
  static constexpr std::size_t steps = 1024;

  const std::vector<Ring>& around_;
  std::vector<std::uint16_t> step_;
  std::vector<std::uint8_t> against_;
  std::vector<std::uint32_t> sorted_;
};

/// Joins sets by what all links between them say in sum, the clearest sum first (greedy additive contraction, Keuper et
/// al. 2015): around the rim of a noisy wall no single link can be trusted, but most of them are right. Looks at the
/// links `from` on.
void join_by_sums(const LinksByClarity& all, std::size_t from, Turns& turns) {
  struct Pair {
    float sum;  // below 0: against each other
    std::uint32_t a, b;
    bool operator<(const Pair& o) const {  // the queue gives the largest first
      const float x = std::abs(sum), y = std::abs(o.sum);
      return x != y ? x < y : std::pair(a, b) > std::pair(o.a, o.b);
    }
  };
  std::unordered_map<std::uint32_t, std::unordered_map<std::uint32_t, float>> between;
  for (; from < all.size(); ++from) {
    const Link l = all[from];
    std::uint8_t of_a = 0, of_b = 0;
    const std::uint32_t a = turns.find(l.a, of_a), b = turns.find(l.b, of_b);
    if (a == b) continue;
    const bool against = l.against != (of_a != of_b);
    between[a][b] += against ? -l.clarity : l.clarity;
    between[b][a] = between[a][b];
  }
  std::priority_queue<Pair> clearest;
  for (const auto& [a, others] : between)
    for (const auto& [b, sum] : others)
      if (a < b) clearest.push({sum, a, b});
  while (!clearest.empty()) {
    auto [sum, a, b] = clearest.top();
    clearest.pop();
    const auto still = between.find(a);
    if (still == between.end() || !still->second.contains(b) || still->second.at(b) != sum) continue;
    turns.join(a, b, sum < 0);
    if (between[a].size() < between[b].size()) std::swap(a, b);
    for (const auto& [c, more] : between[b]) {
      between[c].erase(b);
      if (c == a) continue;
      const float total = between[a][c] += sum < 0 ? -more : more;
      between[c][a] = total;
      clearest.push({total, std::min(a, c), std::max(a, c)});
    }
    between.erase(b);
  }
}

void turn_together(OrientedPoints& o, const std::vector<Ring>& around, const std::vector<std::uint8_t>& known) {
  Turns turns(o.points.size());
  std::uint32_t first_known = none;
  for (std::uint32_t i = 0; i < known.size(); ++i)
    if (known[i]) {
      if (first_known != none) turns.join(first_known, i, false);
      first_known = std::min(first_known, i);
    }
  constexpr float clear = 0.98f;
  const LinksByClarity all(o, around);
  std::size_t n = 0;
  for (; n < all.size() && all[n].clarity >= clear; ++n) turns.join(all[n].a, all[n].b, all[n].against);
  join_by_sums(all, n, turns);
  std::vector<std::uint32_t> sheet_of(o.points.size(), none);
  o.sheet.resize(o.points.size());
  for (std::uint32_t i = 0; i < o.points.size(); ++i) {
    std::uint8_t turned = 0;
    const std::uint32_t root = turns.find(i, turned);
    if (turned) o.normals[i] = -o.normals[i];
    if (sheet_of[root] == none) sheet_of[root] = o.sheets++;
    o.sheet[i] = sheet_of[root];
  }
}

constexpr int directions = 26;

std::array<Vec3, directions> all_directions() {
  std::array<Vec3, directions> axes;
  std::size_t n = 0;
  for (int z = -1; z <= 1; ++z)
    for (int y = -1; y <= 1; ++y)
      for (int x = -1; x <= 1; ++x)
        if (x != 0 || y != 0 || z != 0) axes[n++] = Vec3(x, y, z).normalized();
  return axes;
}

struct Sheet {
  std::vector<std::uint32_t> points;
  double extent = 0;
  double vote = 0;  // positive when it faces outwards: by area, or of the outermost points in many directions
  bool is_known = false;
};

/// What the sheet encloses as it is turned, by the theorem of Gauss, over what its area could: 1 for a ball, near 0 for
/// an open sheet.
double enclosing_share(const OrientedPoints& o, const std::vector<std::uint32_t>& sheet) {
  Vec3 middle = Vec3::Zero();
  double area = 0;
  for (const std::uint32_t i : sheet) {
    middle += o.areas[i] * o.points[i];
    area += o.areas[i];
  }
  if (!(area > 0)) return 0;
  middle /= area;
  double through = 0, most = 0;
  for (const std::uint32_t i : sheet) {
    const Vec3 off = o.points[i] - middle;
    through += o.areas[i] * o.normals[i].dot(off);
    most += o.areas[i] * off.norm();
  }
  return most > 0 ? through / most : 0;
}

std::vector<Sheet> sheets_of(const OrientedPoints& o, const std::vector<std::uint8_t>& known) {
  struct Far {
    double reach = -std::numeric_limits<double>::infinity();
    double along = 0;
  };
  const std::array<Vec3, directions> axes = all_directions();
  std::vector<std::array<Far, directions>> far(o.sheets);
  std::vector<Eigen::AlignedBox3d> box(o.sheets);
  std::vector<Sheet> sheets(o.sheets);
  for (std::uint32_t i = 0; i < o.points.size(); ++i) {
    const std::uint32_t s = o.sheet[i];
    sheets[s].points.push_back(i);
    sheets[s].is_known |= known[i] != 0;
    box[s].extend(o.points[i]);
    for (std::size_t a = 0; a < directions; ++a) {
      const double reach = o.points[i].dot(axes[a]);
      if (reach > far[s][a].reach) far[s][a] = {reach, o.normals[i].dot(axes[a])};
    }
  }
  for (std::size_t s = 0; s < sheets.size(); ++s) {
    sheets[s].extent = box[s].diagonal().norm();
    for (const Far& f : far[s]) sheets[s].vote += f.along;
    // A closed sheet encloses something. A single outermost point may be a stray one, all of its area is not.
    constexpr double clear = 0.1;
    if (const double share = enclosing_share(o, sheets[s].points); std::abs(share) > clear) sheets[s].vote = share;
  }
  return sheets;
}

/// How much of all directions `sheet` fills, seen from a place behind it: 1 inside a closed one, 0 outside.
double share_of_view(const OrientedPoints& o, const Sheet& sheet, const Vec3& place) {
  constexpr std::size_t most = 4000;
  const std::size_t step = (sheet.points.size() + most - 1) / most;
  double sum = 0;
  for (std::size_t k = 0; k < sheet.points.size(); k += step) {
    const std::uint32_t i = sheet.points[k];
    const Vec3 d = o.points[i] - place;
    const double area = step * o.areas[i];
    // Nearer than its own size a point is no longer one.
    sum += area * o.normals[i].dot(d) / own::pow(std::max(d.squaredNorm(), area), 1.5);
  }
  return sum / (4 * std::numbers::pi);
}

/// How the points that are seen clearly face the places they were scanned from, by area: 1 all straight, -1 all
/// straight away, 0 where they contradict each other or are too few. A point that is seen at a grazing angle, as at an
/// edge or where noise tilts its plane, says little.
double facing_scanners(const OrientedPoints& o, const std::vector<std::uint32_t>& sheet, const PointCloud& cloud) {
  constexpr double grazing = 0.2, fewest = 0.1, clear = 0.5;
  double sum = 0, most = 0, all = 0;
  for (const std::uint32_t i : sheet) {
    all += o.areas[i];
    const Vec3 to = cloud.scanners[cloud.scans.empty() ? 0 : cloud.scans[i]] - o.points[i];
    const double along = o.normals[i].dot(to) / to.norm();
    if (!(std::abs(along) > grazing)) continue;  // nor where the place is not known
    sum += o.areas[i] * along;
    most += o.areas[i] * std::abs(along);
  }
  return most > fewest * grazing * all && std::abs(sum) > clear * most ? sum / most : 0;
}

/// The outermost points of each sheet, the widest one first, face outwards; but inwards where it lies within those
/// before it: the inner side of a wall whose rim was not scanned. Where it was scanned from is better, if it is known.
void turn_outwards(OrientedPoints& o, const std::vector<std::uint8_t>& known, const PointCloud& cloud) {
  constexpr std::size_t asked = 32, fewest = 100;  // smaller sheets enclose nothing
  double seen = 0, all = 0;
  std::vector<Sheet> sheets = sheets_of(o, known);
  std::stable_sort(sheets.begin(), sheets.end(), [](const Sheet& a, const Sheet& b) { return a.extent > b.extent; });
  for (auto s = sheets.begin(); s != sheets.end(); ++s) {
    if (s->is_known) continue;
    if (!cloud.scanners.empty()) {
      double area = 0;
      for (const std::uint32_t i : s->points) area += o.areas[i];
      all += area;
      if (const double facing = facing_scanners(o, s->points, cloud); facing != 0) {
        seen += area;
        if (facing < 0)
          for (const std::uint32_t i : s->points) o.normals[i] = -o.normals[i];
        continue;
      }
    }
    const std::size_t step = (s->points.size() + asked - 1) / asked;
    double within = 0, places = 0;
    for (std::size_t k = 0; k < s->points.size(); k += step, ++places)
      for (auto other = sheets.begin(); other != s; ++other)
        if (other->points.size() >= fewest) within += share_of_view(o, *other, o.points[s->points[k]]);
    if (within > 0.5 * places ? s->vote > 0 : s->vote < 0)
      for (const std::uint32_t i : s->points) o.normals[i] = -o.normals[i];
  }
  o.is_seen = seen > 0.5 * all;
}

/// Directions that came with the cloud and point into what they enclose are all turned: some programs write them so.
void turn_given(OrientedPoints& o, const std::vector<std::uint8_t>& known) {
  constexpr double clear = 0.1;
  if (std::find(known.begin(), known.end(), 1) == known.end()) return;
  std::vector<std::uint32_t> all(o.points.size());
  std::iota(all.begin(), all.end(), 0u);
  if (enclosing_share(o, all) > -clear) return;
  for (Vec3& n : o.normals) n = -n;
}

}  // namespace

void append(OrientedPoints& to, const OrientedPoints& more) {
  to.points.insert(to.points.end(), more.points.begin(), more.points.end());
  to.normals.insert(to.normals.end(), more.normals.begin(), more.normals.end());
  to.areas.insert(to.areas.end(), more.areas.begin(), more.areas.end());
}

OrientedPoints first_of(OrientedPoints points, std::size_t count) {
  points.points.resize(count);
  points.normals.resize(count);
  points.areas.resize(count);
  return points;
}

PointCloud voxel_downsample(const PointCloud& cloud, double cell) {
  const bool is_seen = !cloud.scanners.empty(), has_scans = is_seen && !cloud.scans.empty();
  if (!(cell > 0))
    return {cloud.points, cloud.normals, {}, has_scans ? cloud.scans : std::vector<std::uint32_t>{}, cloud.scanners};
  Eigen::AlignedBox3d box;
  for (const Vec3& p : cloud.points) box.extend(p);
  const std::vector<InCell> order = by_cell(cloud.points, box.min(), cell);
  PointCloud thin;
  thin.scanners = cloud.scanners;
  for (std::size_t i = 0, last = 0; i < order.size(); i = last) {
    Vec3 sum = Vec3::Zero(), normal = Vec3::Zero();
    for (last = i; last < order.size() && order[last].cell == order[i].cell; ++last) {
      sum += cloud.points[order[last].index];
      if (!cloud.normals.empty()) normal += cloud.normals[order[last].index];
    }
    thin.points.push_back(sum / (1.0 * (last - i)));
    if (!cloud.normals.empty()) thin.normals.push_back(normal);
    if (has_scans) thin.scans.push_back(cloud.scans[order[i].index]);
  }
  return thin;
}

void project_to_local_planes(PointCloud& cloud, const std::vector<Vec3>& scan, const KdTree& of_scan,
                             std::size_t ring) {
  parallel_for(cloud.points.size(), orient_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<KdTree::Found> found(ring);
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t count = of_scan.nearest(cloud.points[i], found);
      const Plane plane = plane_of(scan, std::span(found).first(count));
      cloud.points[i] -= plane.normal.dot(cloud.points[i] - plane.middle) * plane.normal;
    }
  });
}

void smooth_normals(OrientedPoints& o, std::size_t ring) {
  const KdTree neighbours(o.points);
  std::vector<Vec3> even(o.points.size());
  parallel_for(even.size(), orient_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<KdTree::Found> found(ring);
    for (std::size_t i = begin; i < end; ++i) {
      const auto around = std::span(found).first(neighbours.nearest(o.points[i], found));
      Vec3 sum = Vec3::Zero();
      for (const auto& f : around) sum += weight_of(f, around) * o.normals[f.index];
      even[i] = sum.norm() > 0 ? Vec3(sum.normalized()) : o.normals[i];
    }
  });
  o.normals = std::move(even);
}

OrientedPoints orient(const PointCloud& cloud, bool use_normals, std::size_t ring) {
  const TraceStage noted("inside: directions");
  OrientedPoints o;
  o.points = cloud.points;
  const std::size_t n = o.points.size();
  o.normals.resize(n);
  o.areas.resize(n);
  const bool given = use_normals && !cloud.normals.empty();
  std::vector<std::uint8_t> known(n, 0);
  std::vector<Ring> around(n);
  const KdTree neighbours(o.points);
  parallel_for(n, orient_grain, [&](std::size_t begin, std::size_t end) {
    std::vector<KdTree::Found> found(ring + 1);
    for (std::size_t place = begin; place < end; ++place) {  // near ones together
      const std::size_t i = neighbours.number(place);
      const std::size_t count = neighbours.nearest(o.points[i], found);
      around[i].fill(none);
      for (std::size_t k = 1; k < std::min(count, links + 1); ++k) around[i][k - 1] = found[k].index;
      o.areas[i] = std::numbers::pi * found[count - 1].distance2 / (count - 1);
      known[i] = given && cloud.normals[i].allFinite() && cloud.normals[i].norm() > 1e-6;
      o.normals[i] =
          known[i] ? Vec3(cloud.normals[i].normalized()) : plane_of(o.points, std::span(found).first(count)).normal;
    }
  });
  turn_together(o, around, known);
  turn_outwards(o, known, cloud);
  turn_given(o, known);
  return o;
}

}  // namespace dynasurf::cloud
