#include "dynasurf/ventricle/fit/image_derivatives.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/ventricle/fit/harmonics.hpp"

namespace dynasurf {
namespace {

/// What one point on or in the wall adds to the image when the numbers of the gate change.
struct Source {
  Vec3 position;                 // grid frame, mm
  Eigen::RowVectorXf by_number;  // of endo, wall and uptake harmonics, in this order
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
  const double reach = 3.3 * std::sqrt(variance) + 0.5 * spacing * (joined - 1);
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

class Sources {
 public:
  Sources(const BeatProblem& problem, const Eigen::VectorXd& gate)
      : problem_(problem), layout_(problem.layout.gate), gate_(gate) {}

  std::vector<Source> all() const {
    const Vec3& scale = problem_.cells.frame.scale;
    // Points as dense as the blur is wide sum up smoothly.
    const double pitch = 1.15 * std::max(problem_.sigma_mm, 0.8 * problem_.pixels.spacing.minCoeff());
    const double area = 4 * M_PI * scale[0] * (0.4 * scale[0] + 0.6 * scale[2]) * 1.4;
    const int count = std::clamp(static_cast<int>(area / (pitch * pitch)), 150, 1200);
    std::vector<Source> sources;
    for (int n = 0; n < count; ++n) add(even_direction(n, count), 4 * M_PI / count, sources);
    return sources;
  }

 private:
  double below(const Vec3& heart) const {
    const double height =
        gate_[layout_.plane] + gate_[layout_.plane + 1] * heart[0] + gate_[layout_.plane + 2] * heart[1] - heart[2];
    return 0.5 * std::erfc(-height / (problem_.cells.lattice.edge_mm * std::sqrt(2.0)));
  }

  double field(const std::vector<double>& harmonics, int first, int degree) const {
    double sum = 0;
    for (int k = 0; k < harmonics_up_to(degree); ++k) sum += gate_[first + k] * harmonics[static_cast<std::size_t>(k)];
    return sum;
  }

  void add(const Vec3& direction, double solid_angle, std::vector<Source>& sources) const {
    const GateLayout& l = layout_;
    const HeartFrame& frame = problem_.cells.frame;
    std::vector<double> harmonics(
        static_cast<std::size_t>(harmonics_up_to(std::max({l.endo_degree, l.wall_degree, l.uptake_degree}))));
    harmonics_at(direction, std::max({l.endo_degree, l.wall_degree, l.uptake_degree}), harmonics);
    const double endo = std::exp(field(harmonics, l.endo, l.endo_degree));
    const double muscle = std::exp(field(harmonics, l.wall, l.wall_degree));
    const double epi = std::cbrt(endo * endo * endo + muscle), middle = (endo + epi) / 2;
    const double uptake = std::exp(std::clamp(field(harmonics, l.uptake, l.uptake_degree), -5.0, 2.0));
    const double volume = frame.scale.prod() * solid_angle;
    const auto place = [&](double q, double by_endo, double by_wall, double by_uptake) {
      const Vec3 heart = (q * direction).cwiseProduct(frame.scale);
      const double share = below(heart) * volume;
      if (share < 1e-3 * volume) return;
      Source source{frame.from_heart(heart), Eigen::RowVectorXf(l.plane)};
      const auto fill = [&](int first, int degree, double factor) {
        for (int k = 0; k < harmonics_up_to(degree); ++k)
          source.by_number[first + k] = static_cast<float>(factor * share * harmonics[static_cast<std::size_t>(k)]);
      };
      fill(l.endo, l.endo_degree, by_endo);
      fill(l.wall, l.wall_degree, by_wall);
      fill(l.uptake, l.uptake_degree, by_uptake);
      sources.push_back(std::move(source));
    };
    // Through the wall by Simpson's rule. A wall that moves by d(log q) sweeps q^3 of its solid angle.
    const double third = (epi - endo) / 6;
    const double outer = uptake - gate_[l.background];
    place(endo, (gate_[l.cavity] - uptake) * endo * endo * endo, 0, third * endo * endo * uptake);
    place(middle, 0, 0, 4 * third * middle * middle * uptake);
    place(epi, outer * endo * endo * endo, outer * muscle / 3, third * epi * epi * uptake);
  }

  const BeatProblem& problem_;
  const GateLayout& layout_;
  const Eigen::VectorXd& gate_;
};

void put_column(const std::vector<float>& image, const std::vector<std::size_t>& chosen, int column,
                ImageDerivatives& derivatives) {
  for (std::size_t n = 0; n < chosen.size(); ++n) derivatives(static_cast<Eigen::Index>(n), column) = image[chosen[n]];
}

void add(std::vector<float>& sum, const std::vector<float>& more) {
  for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += more[n];
}

}  // namespace

ImageDerivatives image_derivatives(const BeatProblem& problem, const Eigen::VectorXd& gate, const Activity& activity,
                                   const std::vector<std::size_t>& chosen) {
  const GateLayout& layout = problem.layout.gate;
  const Pixels& pixels = problem.pixels;
  const double sigma = problem.sigma_mm * std::exp(gate[layout.width]);
  ImageDerivatives derivatives = ImageDerivatives::Zero(static_cast<Eigen::Index>(chosen.size()), layout.count());
  std::vector<int> row_of(pixels.size(), -1);
  for (std::size_t n = 0; n < chosen.size(); ++n) row_of[chosen[n]] = static_cast<int>(n);

  for (const Source& source : Sources(problem, gate).all()) {
    Seen seen[3];
    for (int a = 0; a < 3; ++a)
      seen[a] = seen_along(pixels, a, source.position[a], sigma, problem.cells.lattice.edge_mm);
    for (std::size_t k = 0; k < seen[2].weight.size(); ++k)
      for (std::size_t j = 0; j < seen[1].weight.size(); ++j) {
        const float plane = seen[2].weight[k] * seen[1].weight[j];
        const std::size_t line =
            static_cast<std::size_t>(pixels.count[0]) *
            (static_cast<std::size_t>(seen[1].from) + j +
             static_cast<std::size_t>(pixels.count[1]) * (static_cast<std::size_t>(seen[2].from) + k));
        for (std::size_t i = 0; i < seen[0].weight.size(); ++i) {
          const int row = row_of[line + static_cast<std::size_t>(seen[0].from) + i];
          if (row >= 0) derivatives.row(row).head(layout.plane) += plane * seen[0].weight[i] * source.by_number;
        }
      }
  }

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
  for (int b = 0; b < layout.blob_count; ++b)
    put_column(problem.blobs[static_cast<std::size_t>(b)], chosen, layout.blobs + b, derivatives);
  return derivatives;
}

}  // namespace dynasurf
