#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <fstream>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

/// A drawing of lines in the plane and meshes in space, scaled to 600 x 600 pixels, y or z upwards.
class Drawing {
 public:
  void line(std::vector<Eigen::Vector2d> points, std::string colour) {
    lines_.push_back({std::move(points), std::move(colour), "none"});
  }

  /// A mesh as a wire frame with white faces, seen from the front, from the right and from above; far triangles first.
  void mesh(const std::vector<Eigen::Vector3d>& vertices, const std::vector<std::array<std::uint32_t, 3>>& triangles,
            const std::string& colour, const Eigen::Vector3d& moved = Eigen::Vector3d::Zero()) {
    const Eigen::Vector3d right(0.83, 0.55, 0), towards(0.48, -0.73, 0.48), up = towards.cross(right);
    std::vector<std::pair<double, std::size_t>> order;
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      double nearness = 0;
      for (const std::uint32_t v : triangles[t]) nearness += towards.dot(vertices[v]);
      order.emplace_back(nearness, t);
    }
    std::sort(order.begin(), order.end());
    for (const auto& [nearness, t] : order) {
      std::vector<Eigen::Vector2d> corners;
      for (const std::size_t c : {0, 1, 2, 0}) {
        const Eigen::Vector3d p = vertices[triangles[t][c]] + moved;
        corners.emplace_back(right.dot(p), up.dot(p));
      }
      lines_.push_back({std::move(corners), colour, "white"});
    }
  }

  void save(const std::string& path, bool equal_axes = true) const {
    Eigen::Vector2d low(1e300, 1e300), high(-1e300, -1e300);
    for (const Line& l : lines_)
      for (const auto& p : l.points) low = low.cwiseMin(p), high = high.cwiseMax(p);
    Eigen::Vector2d scale = 560 * (high - low).cwiseMax(1e-12).cwiseInverse();
    if (equal_axes) scale.setConstant(scale.minCoeff());
    std::ofstream out(path);
    out << "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"600\" height=\"600\">\n";
    for (const Line& l : lines_) {
      out << "<polyline fill=\"" << l.fill << "\" stroke=\"" << l.colour << "\" points=\"";
      for (const auto& p : l.points)
        out << 20 + scale[0] * (p[0] - low[0]) << ',' << 580 - scale[1] * (p[1] - low[1]) << ' ';
      out << "\"/>\n";
    }
    out << "</svg>\n";
  }

 private:
  struct Line {
    std::vector<Eigen::Vector2d> points;
    std::string colour, fill;
  };
  std::vector<Line> lines_;
};
