#include "dynasurf/show/detail/scene.hpp"

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
double brightness_of(const Vec3& normal) {
  const double length = normal.norm();
  if (length <= 0) return 1;
  static const Vec3 light = Vec3(-0.35, 0.5, -0.8).normalized();
  const Vec3 facing = normal[2] > 0 ? Vec3(-normal / length) : Vec3(normal / length);
  return 0.45 + 0.55 * std::max(0.0, facing.dot(light));
}

/// A bar of 1, 2 or 5 times a power of ten mm: the longest within 22 % of the width.
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
  if (look == Look::smooth) {
    std::vector<Vec3> normals(mesh.vertices.size(), Vec3::Zero());
    for (const auto& t : mesh.triangles) {
      const Vec3 normal = (mesh.vertices[t[1]] - mesh.vertices[t[0]]).cross(mesh.vertices[t[2]] - mesh.vertices[t[0]]);
      // Cross products are not normalised: each triangle counts by its area.
      for (const std::uint32_t v : t) normals[v] += normal;
    }
    for (const auto& t : mesh.triangles) {
      Piece piece{{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, colour};
      piece.normals = {normals[t[0]], normals[t[1]], normals[t[2]]};
      pieces_.push_back(std::move(piece));
    }
    return;
  }
  for (const auto& t : mesh.triangles)
    pieces_.push_back({{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]},
                       colour,
                       opacity,
                       0,
                       true,
                       look != Look::shaded,
                       look != Look::wires,
                       {}});
}

void Scene3d::add(const TriMesh& mesh, std::span<const io::Colour> colours) {
  for (std::size_t n = 0; n < mesh.triangles.size(); ++n) {
    const auto& t = mesh.triangles[n];
    pieces_.push_back(
        {{mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]}, colours[n], 1, 0, false, true, true, {}});
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
            next[axis] += side;
            // A face between two drawn voxels is inside: it would show through translucent ones.
            if (g.contains(next[0], next[1], next[2]) && colour(image(next[0], next[1], next[2]))) continue;
            Piece face{{}, *own, opacity, 0, true, true, true, {}};
            const int u = (axis + 1) % 3, v = (axis + 2) % 3;
            // The corners run the other way around on the far side, which does no harm: both sides of a face are lit
            // alike.
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

Scene3d::Extent Scene3d::extent_in(const Mat3& axes) const {
  Extent e{Vec3::Constant(1e300), Vec3::Constant(-1e300)};
  const auto hold = [&](const Vec3& p) { e.low = e.low.cwiseMin(axes * p), e.high = e.high.cwiseMax(axes * p); };
  for (const Piece& piece : pieces_)
    for (const Vec3& p : piece.points) hold(p);
  // Two opposite corners of a box do not bound it once it is turned: all eight count.
  for (std::size_t n = 0; n + 1 < room_.size(); n += 2)
    for (int corner = 0; corner < 8; ++corner) {
      Vec3 p = room_[n];
      for (int axis = 0; axis < 3; ++axis)
        if (corner >> axis & 1) p[axis] = room_[n + 1][axis];
      hold(p);
    }
  if (pieces_.empty() && room_.empty()) e = {Vec3::Zero(), Vec3::Ones()};
  return e;
}

double Scene3d::fitting_scale(const Panel& box, const Outlook& outlook) const {
  const Extent e = extent_in(axes_of(outlook));
  const double room = 0.92;
  return std::max({(e.high[0] - e.low[0]) / (room * box.width), (e.high[1] - e.low[1]) / (room * box.height), 1e-9});
}

void Scene3d::shade(Canvas& canvas, const Panel& box, const Mat3& axes, const Vec3& middle, double scale,
                    std::span<const std::size_t> order) const {
  std::vector<Canvas::Shaded> triangles;
  for (const std::size_t n : order) {
    const Piece& piece = pieces_[n];
    Canvas::Shaded triangle;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 p = (axes * piece.points[c] - middle) / scale;
      triangle.corners[c] = {box.x + box.width / 2 + p[0], box.y + box.height / 2 - p[1]};
      triangle.colours[c] = lit(piece.colour, brightness_of(axes * piece.normals[c]));
    }
    triangles.push_back(triangle);
  }
  canvas.shade(triangles);
}

double Scene3d::draw(Canvas& canvas, const Panel& box, const Outlook& outlook, double mm_per_point,
                     bool with_length) const {
  if (pieces_.empty()) return 0;
  const Mat3 axes = axes_of(outlook);
  const double scale = mm_per_point > 0 ? mm_per_point : fitting_scale(box, outlook);
  const Extent extent = extent_in(axes);
  const Vec3 middle = 0.5 * (extent.low + extent.high);
  // The painter's algorithm: pieces go from far to near by the depth of their middles. Pieces of one depth keep their
  // order with any standard library.
  std::vector<double> depth(pieces_.size());
  for (std::size_t n = 0; n < pieces_.size(); ++n)
    for (const Vec3& p : pieces_[n].points) depth[n] += axes.row(2).dot(p) / pieces_[n].points.size();
  std::vector<std::size_t> order(pieces_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return depth[a] > depth[b]; });

  canvas.clip(box);
  for (std::size_t from = 0; from < order.size();) {
    std::size_t to = from;
    while (to < order.size() && !pieces_[order[to]].normals.empty()) ++to;
    if (to > from) {  // what is smooth in one go: seams would show between triangles
      shade(canvas, box, axes, middle, scale, std::span(order).subspan(from, to - from));
      from = to;
      continue;
    }
    const Piece& piece = pieces_[order[from++]];
    std::vector<Vec3> seen;
    std::vector<Vec2> flat;
    for (const Vec3& p : piece.points) {
      seen.push_back(axes * p);
      flat.emplace_back(box.x + box.width / 2 + (seen.back()[0] - middle[0]) / scale,
                        box.y + box.height / 2 - (seen.back()[1] - middle[1]) / scale);
    }
    draw_piece(canvas, piece, seen, flat);
  }
  canvas.unclip();
  if (with_length) draw_length(canvas, box, scale);
  return scale;
}

void Scene3d::draw_piece(Canvas& canvas, const Piece& piece, std::span<const Vec3> seen, std::vector<Vec2>& flat) {
  if (flat.size() == 1) {
    canvas.disc(flat[0], piece.size, piece.colour);
    return;
  }
  if (flat.size() == 2) {
    canvas.line(flat, {piece.colour, piece.size});
    return;
  }
  const Vec3 normal = (seen[1] - seen[0]).cross(seen[2] - seen[0]);
  const io::Colour shade = piece.shaded ? lit(piece.colour, brightness_of(normal)) : piece.colour;
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

}  // namespace dynasurf::show
