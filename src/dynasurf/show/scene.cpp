#include "dynasurf/show/scene.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/show/detail/chart.hpp"
#include "dynasurf/show/detail/palette.hpp"

namespace dynasurf::show {
namespace {

/// Rows: to the right, upwards, away from the observer.
Mat3 axes_of(const Outlook& outlook) {
  const double a = outlook.turn * std::numbers::pi / 180, b = outlook.tip * std::numbers::pi / 180;
  const Vec3 right(own::cos(a), own::sin(a), 0), level(-own::sin(a), own::cos(a), 0), up(0, 0, 1);
  Mat3 axes;
  axes.row(0) = right;
  axes.row(1) = own::cos(b) * up + own::sin(b) * level;
  axes.row(2) = own::cos(b) * level - own::sin(b) * up;
  return axes;
}

/// Light from above the observer's left shoulder; a face seen from behind is lit as from the front.
double brightness_of(std::span<const Vec3> face) {
  const Vec3 normal = (face[1] - face[0]).cross(face[2] - face[0]);
  const double length = normal.norm();
  if (length <= 0) return 1;
  static const Vec3 light = Vec3(-0.35, 0.5, -0.8).normalized();
  const Vec3 facing = normal[2] > 0 ? Vec3(-normal / length) : Vec3(normal / length);
  return 0.45 + 0.55 * std::max(0.0, facing.dot(light));
}

void draw_length(Canvas& canvas, const Panel& box, double mm_per_point) {
  const double wanted = 0.22 * box.width * mm_per_point;
  const double power = own::pow(10, std::floor(own::log10(wanted)));
  const double mm = wanted >= 5 * power ? 5 * power : wanted >= 2 * power ? 2 * power : power;
  const double x = box.x + 8, y = box.bottom() - 8, length = mm / mm_per_point;
  canvas.rectangle({x, y - 2, length, 2}, ink_of::text);
  canvas.text({x, y - 6}, number_text(mm) + " mm", {9});
}

}  // namespace

void Scene3d::add(const TriMesh& mesh, const io::Colour& colour, double opacity, Look look) {
  for (const auto& t : mesh.triangles)
    pieces_.push_back({{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]},
                       colour,
                       opacity,
                       0,
                       true,
                       look != Look::shaded,
                       look != Look::wires});
}

void Scene3d::add(const TriMesh& mesh, std::span<const io::Colour> colours) {
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    pieces_.push_back(
        {{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, colours[n], 1, 0, false, true, true});
  }
}

void Scene3d::add_voxels(const Image& image, const std::function<std::optional<io::Colour>(float)>& colour,
                         double opacity, bool in_world) {
  const Grid& g = image.grid;
  for (int k = 0; k < g.dims[2]; ++k)
    for (int j = 0; j < g.dims[1]; ++j)
      for (int i = 0; i < g.dims[0]; ++i) {
        const auto own = colour(image(i, j, k));
        if (!own) continue;
        for (int axis = 0; axis < 3; ++axis)
          for (const int side : {-1, 1}) {
            Index3 next{i, j, k};
            next[static_cast<std::size_t>(axis)] += side;
            if (g.contains(next[0], next[1], next[2]) && colour(image(next[0], next[1], next[2]))) continue;
            Piece face{{}, *own, opacity, 0, true, true, true};
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            for (const auto& [a, b] : {std::pair{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}) {
              Vec3 p(i, j, k);
              p[axis] += 0.5 * side, p[u] += a, p[v] += b;
              p = p.cwiseProduct(g.spacing);
              face.points.push_back(in_world ? to_world(g, p) : p);
            }
            pieces_.push_back(std::move(face));
          }
      }
}

void Scene3d::add_line(std::span<const Vec3> points, const io::Colour& colour, double width) {
  for (std::size_t n = 1; n < points.size(); ++n) pieces_.push_back({{points[n - 1], points[n]}, colour, 1, width});
}

void Scene3d::add_point(const Vec3& at, const io::Colour& colour, double radius) {
  pieces_.push_back({{at}, colour, 1, radius});
}

double Scene3d::fitting_scale(const Panel& box, const Outlook& outlook) const {
  const Mat3 axes = axes_of(outlook);
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (const Piece& piece : pieces_)
    for (const Vec3& p : piece.points) low = low.cwiseMin(axes * p), high = high.cwiseMax(axes * p);
  const Vec3 size = pieces_.empty() ? Vec3(1, 1, 1) : Vec3(high - low);
  const double room = 0.92;
  return std::max({size[0] / (room * box.width), size[1] / (room * box.height), 1e-9});
}

double Scene3d::draw(Canvas& canvas, const Panel& box, const Outlook& outlook, double mm_per_point) const {
  if (pieces_.empty()) return 0;
  const Mat3 axes = axes_of(outlook);
  const double scale = mm_per_point > 0 ? mm_per_point : fitting_scale(box, outlook);
  std::vector<std::vector<Vec3>> seen(pieces_.size());
  std::vector<double> depth(pieces_.size());
  Vec3 low = Vec3::Constant(1e300), high = Vec3::Constant(-1e300);
  for (std::size_t n = 0; n < pieces_.size(); ++n) {
    for (const Vec3& p : pieces_[n].points) {
      seen[n].push_back(axes * p);
      low = low.cwiseMin(seen[n].back()), high = high.cwiseMax(seen[n].back());
      depth[n] += seen[n].back()[2] / static_cast<double>(pieces_[n].points.size());
    }
  }
  const Vec3 middle = 0.5 * (low + high);
  std::vector<std::size_t> order(pieces_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth[a] > depth[b]; });

  canvas.clip(box);
  for (const std::size_t n : order) {
    const Piece& piece = pieces_[n];
    std::vector<Vec2> flat;
    for (const Vec3& p : seen[n])
      flat.emplace_back(box.x + box.width / 2 + (p[0] - middle[0]) / scale,
                        box.y + box.height / 2 - (p[1] - middle[1]) / scale);
    if (flat.size() == 1) {
      canvas.disc(flat[0], piece.size, piece.colour);
      continue;
    }
    if (flat.size() == 2) {
      canvas.line(flat, {piece.colour, piece.size});
      continue;
    }
    const io::Colour shade = piece.shaded ? lit(piece.colour, brightness_of(seen[n])) : piece.colour;
    if (piece.filled) {
      canvas.polygon(flat, shade, piece.opacity);
      flat.push_back(flat.front());
      // A seam of the same colour hides what antialiasing leaves between neighbours.
      if (piece.opacity == 1) canvas.line(flat, {piece.outlined ? lit(shade, 0.6) : shade, 0.4});
    } else {
      flat.push_back(flat.front());
      canvas.line(flat, {piece.colour, 0.4, piece.opacity});
    }
  }
  canvas.unclip();
  draw_length(canvas, box, scale);
  return scale;
}

}  // namespace dynasurf::show
