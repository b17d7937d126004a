#include "dynasurf/mesh/contour_stack.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/mesh/measures.hpp"

namespace dynasurf::mesh {
namespace {

constexpr std::array<std::string_view, 2> strip_names{"even", "greedy"};

struct Ring {
  std::uint32_t first = 0, count = 0;
  std::uint32_t at(std::uint32_t i) const { return first + i % count; }
};

/// The mesh, and which of its triangles belong to which gap: gap g lies between rings g and g+1; the caps come before
/// and after.
struct Rings {
  TriMesh mesh;
  std::vector<Ring> rings;
  std::vector<std::size_t> first_triangle;  // of cap, gaps, cap, end
};

void check_stack(const ContourStack& stack) {
  if (stack.contours.size() < 2 || stack.z_mm.size() != stack.contours.size())
    throw InputError("a stack of " + std::to_string(stack.contours.size()) + " contours and " +
                     std::to_string(stack.z_mm.size()) + " heights; expected two or more of each");
  for (std::size_t k = 1; k < stack.z_mm.size(); ++k)
    if (!(stack.z_mm[k] > stack.z_mm[k - 1]))
      throw InputError("height " + std::to_string(k + 1) + " of the stack of contours is not above the one before");
}

std::vector<Contour> even_contours(const ContourStack& stack, const Tessellation& options) {
  Vec2 centre = Vec2::Zero();
  double longest = 0;
  for (const Contour& c : stack.contours) {
    if (c.size() < 3) throw InputError("a contour of fewer than 3 points in a stack; expected closed ones");
    centre += centroid_of(c) / (1.0 * stack.contours.size());
    longest = std::max(longest, length_of(c));
  }
  std::vector<Contour> even;
  for (const Contour& c : stack.contours) {
    const double share = options.strip == Strip::even ? 1 : length_of(c) / longest;
    even.push_back(spread_evenly(c, std::max(8, round_int(share * options.points)), centre));
  }
  return even;
}

/// One triangle at a time along both rings. Equal counts advance both in turn, along the shorter diagonal.
void add_strip(TriMesh& mesh, const Ring& low, const Ring& high, Strip strip) {
  const auto distance = [&](std::uint32_t a, std::uint32_t b) {
    return (mesh.vertices[low.at(a)] - mesh.vertices[high.at(b)]).squaredNorm();
  };
  std::uint32_t i = 0, j = 0;
  const auto advance_low = [&] { mesh.triangles.push_back({low.at(i), low.at(i + 1), high.at(j)}), ++i; };
  const auto advance_high = [&] { mesh.triangles.push_back({low.at(i), high.at(j + 1), high.at(j)}), ++j; };
  while (i < low.count || j < high.count) {
    const bool low_first = distance(i + 1, j) <= distance(i, j + 1);
    if (strip == Strip::even) {
      low_first ? advance_low() : advance_high();
      low_first ? advance_high() : advance_low();
    } else if (j == high.count || (i < low.count && low_first)) {
      advance_low();
    } else {
      advance_high();
    }
  }
}

void add_cap(TriMesh& mesh, const Ring& ring, const Vec3& middle, bool above) {
  const std::uint32_t centre = mesh.vertices.size();
  mesh.vertices.push_back(middle);
  for (std::uint32_t i = 0; i < ring.count; ++i)
    mesh.triangles.push_back(above ? std::array{ring.at(i), ring.at(i + 1), centre}
                                   : std::array{ring.at(i + 1), ring.at(i), centre});
}

Vec3 raised(const Vec2& p, double z) { return {p.x(), p.y(), z}; }

Rings join(const ContourStack& stack, const std::vector<Contour>& even, const Tessellation& options,
           const CapHeights& caps) {
  Rings r;
  for (std::size_t k = 0; k < even.size(); ++k) {
    const std::uint32_t first = r.mesh.vertices.size(), count = even[k].size();
    r.rings.push_back({first, count});
    for (const Vec2& p : even[k].points) r.mesh.vertices.push_back(raised(p, stack.z_mm[k]));
  }
  const auto begin_part = [&] { r.first_triangle.push_back(r.mesh.triangles.size()); };
  begin_part();
  add_cap(r.mesh, r.rings.front(), raised(centroid_of(even.front()), stack.z_mm.front() - caps.below_mm), false);
  for (std::size_t k = 0; k + 1 < even.size(); ++k) {
    begin_part();
    add_strip(r.mesh, r.rings[k], r.rings[k + 1], options.strip);
  }
  begin_part();
  add_cap(r.mesh, r.rings.back(), raised(centroid_of(even.back()), stack.z_mm.back() + caps.above_mm), true);
  begin_part();
  return r;
}

/// Area of a triangle's projection on the plane of the slices, positive where its normal points up.
double projected_area(const TriMesh& mesh, const std::array<std::uint32_t, 3>& t) {
  const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  return (b - a).cross(c - a).z() / 2;
}

}  // namespace

std::span<const std::string_view> names_of(Strip) { return strip_names; }

TriMesh tessellate(const ContourStack& stack, const Tessellation& requested, const CapHeights& caps) {
  Tessellation options = requested;
  check_options(options, "tessellation");
  check_stack(stack);
  return join(stack, even_contours(stack, options), options, caps).mesh;
}

StackVolumes volumes_of(const ContourStack& stack, const Tessellation& requested, const CapHeights& caps) {
  Tessellation options = requested;
  check_options(options, "tessellation");
  check_stack(stack);
  const std::vector<Contour> even = even_contours(stack, options);
  const Rings r = join(stack, even, options, caps);

  StackVolumes v;
  v.gauss = volume_mm3(r.mesh);
  // A raised cap is one more gap, whose outer contour has shrunk to a point.
  for (std::size_t part = 0; part + 1 < r.first_triangle.size(); ++part) {
    const bool lowest = part == 0, highest = part == even.size();
    const double low = lowest ? stack.z_mm.front() - caps.below_mm : stack.z_mm[part - 1];
    const double high = highest ? stack.z_mm.back() + caps.above_mm : stack.z_mm[part];
    const double upper_area = highest ? 0 : signed_area(even[part]);
    v.trapezoid += upper_area * (high - low);
    v.triangle_exact += upper_area * (high - low);
    for (std::size_t n = r.first_triangle[part]; n < r.first_triangle[part + 1]; ++n) {
      const auto& t = r.mesh.triangles[n];
      const double area = projected_area(r.mesh, t);
      const double height =
          (r.mesh.vertices[t[0]].z() + r.mesh.vertices[t[1]].z() + r.mesh.vertices[t[2]].z()) / 3 - low;
      v.trapezoid += area * (high - low) / 2;
      v.triangle_exact += area * height;
    }
  }
  return v;
}

}  // namespace dynasurf::mesh
