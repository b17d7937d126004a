#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "dynasurf/core/tri_mesh.hpp"
#include "dynasurf/core/volume.hpp"
#include "dynasurf/show/detail/canvas.hpp"

namespace dynasurf::show {

/// From where a scene is seen, parallel rays: turned about the upright axis and then tipped, in degrees. At 0, 0 the
/// observer looks along +y: x runs to the right, z upwards.
struct Outlook {
  double turn = 25, tip = 20;
};

/// Surfaces, voxels, lines and points in one frame, mm, drawn from far to near.
class Scene3d {
 public:
  /// smooth: Gouraud, without edges; for opaque surfaces.
  enum class Look { shaded, wires, both, smooth };

  void add(const TriMesh& mesh, const io::Colour& colour, double opacity = 1, Look look = Look::shaded);
  /// A colour for every triangle.
  void add(const TriMesh& mesh, std::span<const io::Colour> colours);
  /// The outer faces of the voxels that have a colour, placed in the world or in the grid frame.
  void add_voxels(const Image& image, const std::function<std::optional<io::Colour>(float)>& colour, double opacity = 1,
                  bool in_world = false);
  void add_line(std::span<const Vec3> points, const io::Colour& colour, double width = 1);
  void add_point(const Vec3& at, const io::Colour& colour, double radius = 2);

  /// Room for what else is to be seen at the same scale, in the same place: the box counts as if it were drawn.
  void make_room(const Vec3& low, const Vec3& high) { room_.push_back(low), room_.push_back(high); }

  bool empty() const { return pieces_.empty(); }
  /// Everything fitted into the box, with a scale of a round number of mm in its lower left corner. `mm_per_point`,
  /// when above 0, sets the size instead, so that several scenes compare. Returns the mm of a point.
  double draw(Canvas& canvas, const Panel& box, const Outlook& outlook = {}, double mm_per_point = 0,
              bool with_length = true) const;
  /// The mm of a point at which everything fits.
  double fitting_scale(const Panel& box, const Outlook& outlook = {}) const;

 private:
  struct Piece {
    std::vector<Vec3> points;  // 1: a point; 2: a line; else a face
    io::Colour colour;
    double opacity = 1, size = 0;  // size: width of a line or radius of a point
    bool shaded = false, outlined = false, filled = true;
    std::vector<Vec3> normals = {};  // of the corners, for smooth surfaces
  };
  void shade(Canvas& canvas, const Panel& box, const Mat3& axes, const Vec3& middle, double scale,
             std::span<const std::size_t> order) const;
  static void draw_piece(Canvas& canvas, const Piece& piece, std::span<const Vec3> seen, std::vector<Vec2>& flat);
  struct Extent {
    Vec3 low, high;
  };
  Extent extent_in(const Mat3& axes) const;
  std::vector<Piece> pieces_;
  std::vector<Vec3> room_;
};

}  // namespace dynasurf::show
