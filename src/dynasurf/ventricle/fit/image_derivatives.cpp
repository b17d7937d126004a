#include "dynasurf/ventricle/fit/image_derivatives.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/ventricle/fit/harmonics.hpp"

namespace dynasurf {
namespace {

/// What the wall along one direction adds to the image when the numbers of the gate change: points on its two sides and
/// in its middle, and by how much each counts for the harmonics of endo, wall and uptake in that direction.
struct WallRay {
  static constexpr int points = 3;
  Eigen::RowVectorXf harmonics;
  Vec3 position[points];  // grid frame, mm
  Eigen::Vector3f by_field[points];
};

/// Pixels near a position along one axis and what they see of a point there.
struct Seen {
  int from = 0;
  std::vector<float> weight;
};

Seen seen_along(const Pixels& pixels, int axis, double position, double sigma_mm, double edge_mm) {
  const double spacing = pixels.spacing[axis], joined = pixels.joined[axis];
  double variance = sigma_mm * sigma_mm;
  const double voxel = spacing * spacing / 12;
  if (variance < voxel) variance = voxel + edge_mm * edge_mm;
  const double reach = 2.9 * std::sqrt(variance) + 0.5 * spacing * (joined - 1);
  const double pitch = spacing * joined, start = pixels.centre(axis, 0);
  Seen seen;
  seen.from = std::max(0, static_cast<int>(std::ceil((position - reach - start) / pitch)));
  const int to = std::min(pixels.count[axis] - 1, static_cast<int>(std::floor((position + reach - start) / pitch)));
  for (int n = seen.from; n <= to; ++n) {
    double sum = 0;
    for (int v = 0; v < pixels.joined[axis]; ++v) {
      const double x = spacing * (pixels.first[axis] + n * pixels.joined[axis] + v) - position;
      sum += std::exp(-x * x / (2 * variance));
    }
    seen.weight.push_back(static_cast<float>(sum / joined / std::sqrt(2 * M_PI * variance)));
  }
  return seen;
}

class WallRays {
 public:
  WallRays(const BeatProblem& problem, const Eigen::VectorXd& gate)
      : problem_(problem), layout_(problem.layout.gate), gate_(gate) {}

  WallRay along(const Vec3& direction, const Eigen::VectorXd& harmonics, double solid_angle) const {
    const GateLayout& l = layout_;
    const HeartFrame& frame = problem_.cells.frame;
    const double endo = std::exp(field(harmonics, l.endo, l.endo_degree));
    const double muscle = std::exp(field(harmonics, l.wall, l.wall_degree));
    const double epi = std::cbrt(endo * endo * endo + muscle), middle = (endo + epi) / 2;
    const double uptake = std::exp(std::clamp(field(harmonics, l.uptake, l.uptake_degree), -5.0, 2.0));
    const double volume = frame.scale.prod() * solid_angle;
    WallRay ray;
    ray.harmonics = harmonics.transpose().cast<float>();
    int point = 0;
    const auto place = [&](double q, double by_endo, double by_wall, double by_uptake) {
      const Vec3 heart = (q * direction).cwiseProduct(frame.scale);
      const double share = below(heart);
      ray.position[point] = frame.from_heart(heart);
      ray.by_field[point].setZero();
      if (share > 1e-3) ray.by_field[point] = (share * volume * Vec3(by_endo, by_wall, by_uptake)).cast<float>();
      ++point;
    };
    // Through the wall by Simpson's rule. A wall that moves by d(log q) sweeps q^3 of its solid angle.
    const double third = (epi - endo) / 6;
    const double outer = uptake - gate_[l.background];
    place(endo, (gate_[l.cavity] - uptake) * endo * endo * endo, 0, third * endo * endo * uptake);
    place(middle, 0, 0, 4 * third * middle * middle * uptake);
    place(epi, outer * endo * endo * endo, outer * muscle / 3, third * epi * epi * uptake);
    return ray;
  }

 private:
  double below(const Vec3& heart) const {
    const double height =
        gate_[layout_.plane] + gate_[layout_.plane + 1] * heart[0] + gate_[layout_.plane + 2] * heart[1] - heart[2];
    return 0.5 * std::erfc(-height / (problem_.cells.lattice.edge_mm * std::sqrt(2.0)));
  }

  double field(const Eigen::VectorXd& harmonics, int first, int degree) const {
    return gate_.segment(first, harmonics_up_to(degree)).dot(harmonics.head(harmonics_up_to(degree)));
  }

  const BeatProblem& problem_;
  const GateLayout& layout_;
  const Eigen::VectorXd& gate_;
};

/// Adds what the pixels see of one direction. Every pixel collects its three points first and is then written once.
class RayPainter {
 public:
  RayPainter(const BeatProblem& problem, const GateLayout& layout, double sigma_mm,
             const std::vector<std::size_t>& chosen)
      : pixels_(problem.pixels),
        layout_(layout),
        sigma_mm_(sigma_mm),
        edge_mm_(problem.cells.lattice.edge_mm),
        row_of_(problem.pixels.size(), -1),
        touched_at_(problem.pixels.size(), -1) {
    for (std::size_t n = 0; n < chosen.size(); ++n) row_of_[chosen[n]] = static_cast<int>(n);
  }

  void paint(const WallRay& ray, ImageDerivatives& derivatives) {
    for (const Touched& t : touched_) touched_at_[t.pixel] = -1;
    touched_.clear();
    for (int p = 0; p < WallRay::points; ++p)
      if (!ray.by_field[p].isZero(0)) collect(ray.position[p], ray.by_field[p]);
    const int endo = harmonics_up_to(layout_.endo_degree), wall = harmonics_up_to(layout_.wall_degree),
              uptake = harmonics_up_to(layout_.uptake_degree);
    for (const Touched& t : touched_) {
      auto row = derivatives.row(row_of_[t.pixel]);
      row.segment(layout_.endo, endo) += t.by_field[0] * ray.harmonics.head(endo);
      row.segment(layout_.wall, wall) += t.by_field[1] * ray.harmonics.head(wall);
      row.segment(layout_.uptake, uptake) += t.by_field[2] * ray.harmonics.head(uptake);
    }
  }

 private:
  struct Touched {
    std::size_t pixel;
    Eigen::Vector3f by_field;
  };

  void collect(const Vec3& position, const Eigen::Vector3f& by_field) {
    Seen seen[3];
    for (int a = 0; a < 3; ++a) seen[a] = seen_along(pixels_, a, position[a], sigma_mm_, edge_mm_);
    for (std::size_t k = 0; k < seen[2].weight.size(); ++k)
      for (std::size_t j = 0; j < seen[1].weight.size(); ++j) {
        const float plane = seen[2].weight[k] * seen[1].weight[j];
        const std::size_t line =
            static_cast<std::size_t>(pixels_.count[0]) *
                (static_cast<std::size_t>(seen[1].from) + j +
                 static_cast<std::size_t>(pixels_.count[1]) * (static_cast<std::size_t>(seen[2].from) + k)) +
            static_cast<std::size_t>(seen[0].from);
        for (std::size_t i = 0; i < seen[0].weight.size(); ++i) {
          if (row_of_[line + i] < 0) continue;
          int& at = touched_at_[line + i];
          if (at < 0) {
            at = static_cast<int>(touched_.size());
            touched_.push_back({line + i, Eigen::Vector3f::Zero()});
          }
          touched_[static_cast<std::size_t>(at)].by_field += plane * seen[0].weight[i] * by_field;
        }
      }
  }

  const Pixels& pixels_;
  const GateLayout& layout_;
  double sigma_mm_, edge_mm_;
  std::vector<int> row_of_, touched_at_;  // per pixel: its row, and its place among those touched; -1: none
  std::vector<Touched> touched_;
};

void put_column(const std::vector<float>& image, const std::vector<std::size_t>& chosen, int column,
                ImageDerivatives& derivatives) {
  for (std::size_t n = 0; n < chosen.size(); ++n) derivatives(static_cast<Eigen::Index>(n), column) = image[chosen[n]];
}

void add(std::vector<float>& sum, const std::vector<float>& more) {
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += more[n];
}

}  // namespace

EvenRays even_rays(const BeatProblem& problem) {
  const GateLayout& layout = problem.layout.gate;
  const Vec3& scale = problem.cells.frame.scale;
  // Points as dense as the blur is wide sum up smoothly.
  const double pitch = 1.15 * std::max(problem.sigma_mm, 0.8 * problem.pixels.spacing.minCoeff());
  const double area = 4 * M_PI * scale[0] * (0.4 * scale[0] + 0.6 * scale[2]) * 1.4;
  const int count = std::clamp(static_cast<int>(area / (pitch * pitch)), 150, 1200);
  const int degree = std::max({layout.endo_degree, layout.wall_degree, layout.uptake_degree});
  EvenRays rays{{}, Eigen::MatrixXd(harmonics_up_to(degree), count)};
  for (int n = 0; n < count; ++n) {
    rays.direction.push_back(even_direction(n, count));
    harmonics_at(rays.direction.back(), degree,
                 {rays.harmonics.col(n).data(), static_cast<std::size_t>(rays.harmonics.rows())});
  }
  return rays;
}

ImageDerivatives image_derivatives(const BeatProblem& problem, const EvenRays& rays, const Eigen::VectorXd& gate,
                                   const Activity& activity, const std::vector<std::size_t>& chosen) {
  const GateLayout& layout = problem.layout.gate;
  const Pixels& pixels = problem.pixels;
  const double sigma = problem.sigma_mm * std::exp(gate[layout.width]);
  ImageDerivatives derivatives = ImageDerivatives::Zero(static_cast<Eigen::Index>(chosen.size()), layout.count());
  RayPainter painter(problem, layout, sigma, chosen);
  const WallRays walls(problem, gate);
  const double solid_angle = 4 * M_PI / static_cast<double>(rays.direction.size());
  for (std::size_t n = 0; n < rays.direction.size(); ++n)
    painter.paint(walls.along(rays.direction[n], rays.harmonics.col(static_cast<Eigen::Index>(n)), solid_angle),
                  derivatives);

  // The other numbers change the image as a whole.
  const GammaCamera camera = make_camera(problem.cells.lattice, pixels, sigma, problem.filtered);
  const HeartCells& cells = problem.cells;
  const auto background = static_cast<float>(gate[layout.background]);
  const auto cavity = static_cast<float>(gate[layout.cavity]);
  std::vector<float> lattice(cells.lattice.size(), 0.0F);
  const auto column = [&](int number, const auto& value_of) {
    for (std::size_t c = 0; c < cells.cell.size(); ++c) lattice[cells.cell[c]] = value_of(c);
    put_column(see(camera, lattice), chosen, number, derivatives);
  };
  const auto by_height = [&](std::size_t c) {
    return activity.by_plane[c] *
           ((activity.uptake[c] - background) * activity.epi[c] + (cavity - activity.uptake[c]) * activity.endo[c]);
  };
  column(layout.plane, by_height);
  column(layout.plane + 1, [&](std::size_t c) { return by_height(c) * cells.x[c]; });
  column(layout.plane + 2, [&](std::size_t c) { return by_height(c) * cells.y[c]; });
  column(layout.cavity, [&](std::size_t c) { return activity.below[c] * activity.endo[c]; });
  column(layout.background, [&](std::size_t c) { return -activity.below[c] * activity.epi[c]; });
  derivatives.col(layout.background).array() += 1.0F;
  std::vector<float> by_width = see(camera, activity.cells, 0);
  add(by_width, see(camera, activity.cells, 1));
  add(by_width, see(camera, activity.cells, 2));
  put_column(by_width, chosen, layout.width, derivatives);
  for (std::size_t n = 0; n < chosen.size(); ++n)
    for (int b = 0; b < layout.blob_count; ++b)
      derivatives(static_cast<Eigen::Index>(n), layout.blobs + b) =
          problem.blobs[static_cast<std::size_t>(b)][chosen[n]];
  return derivatives;
}

}  // namespace dynasurf
