#pragma once
#include <algorithm>
#include <fstream>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

/// A drawing of lines in the plane, scaled to 600 x 600 pixels, y upwards.
class Drawing {
 public:
  void line(std::vector<Eigen::Vector2d> points, std::string colour) {
    lines_.push_back({std::move(points), std::move(colour)});
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
      out << "<polyline fill=\"none\" stroke=\"" << l.colour << "\" points=\"";
      for (const auto& p : l.points)
        out << 20 + scale[0] * (p[0] - low[0]) << ',' << 580 - scale[1] * (p[1] - low[1]) << ' ';
      out << "\"/>\n";
    }
    out << "</svg>\n";
  }

 private:
  struct Line {
    std::vector<Eigen::Vector2d> points;
    std::string colour;
  };
  std::vector<Line> lines_;
};
