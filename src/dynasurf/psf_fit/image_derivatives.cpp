#include "dynasurf/psf_fit/detail/image_derivatives.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/psf_fit/detail/harmonics.hpp"

namespace dynasurf::psf_fit {
namespace {

/// What the wall along one direction adds to the image when the numbers of the gate change: points on its two sides and
/// in its middle, and by how much each counts for the harmonics of endo, wall and uptake in that direction.
struct WallRay {
  static constexpr int points = 3;
  Vec3 position[points];  // grid frame, mm
  Eigen::Vector3f by_field[points];
};

/// Pixels near a position along one axis and what they see of a point there.
struct Seen {
  int from = 0;
  std::vector<float> weight;
};

void look_along(const Pixels& pixels, int axis, double position, double sigma_mm, double edge_mm, Seen& seen) {
  const double spacing = pixels.spacing[axis], joined = pixels.joined[axis];
  double variance = sigma_mm * sigma_mm;
  const double voxel = spacing * spacing / 12;
  if (variance < voxel) variance = voxel + edge_mm * edge_mm;
  const double reach = 2.9 * std::sqrt(variance) + 0.5 * spacing * (joined - 1);
  const double pitch = spacing * joined, start = pixels.centre(axis, 0);
  seen.weight.clear();
  seen.from = std::max(0, ceil_int((position - reach - start) / pitch));
  const int to = std::min(pixels.count[axis] - 1, floor_int((position + reach - start) / pitch));
  // Of a Gaussian at even steps each value is the one before times a ratio, which shrinks evenly itself.
  const double from = spacing * (pixels.first[axis] + seen.from * pixels.joined[axis]) - position;
  double value = own::exp(-from * from / (2 * variance)) / (joined * std::sqrt(2 * M_PI * variance));
  double ratio = own::exp(-spacing * (from + 0.5 * spacing) / variance);
  const double shrinks_by = own::exp(-spacing * spacing / variance);
  for (int n = seen.from; n <= to; ++n) {
    double sum = 0;
    for (int v = 0; v < pixels.joined[axis]; ++v) {
      sum += value;
      value *= ratio;
      ratio *= shrinks_by;
    }
    seen.weight.push_back(sum);
  }
}

class WallRays {
 public:
  WallRays(const BeatProblem& problem, const Eigen::VectorXd& gate)
      : problem_(problem), layout_(problem.layout.gate), gate_(gate) {}

  WallRay along(const Vec3& direction, const Eigen::VectorXd& harmonics, double solid_angle) const {
    const GateLayout& l = layout_;
    const HeartFrame& frame = problem_.cells.frame;
    const double endo = own::exp(field(harmonics, l.endo, l.endo_degree));
    const double muscle = own::exp(field(harmonics, l.wall, l.wall_degree));
    const double epi = own::cbrt(endo * endo * endo + muscle), middle = (endo + epi) / 2;
    const double uptake = own::exp(std::clamp(field(harmonics, l.uptake, l.uptake_degree), -5.0, 2.0));
    const double volume = frame.scale.prod() * solid_angle;
    WallRay ray;
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
    return 0.5 * own::erfc(-height / (problem_.cells.lattice.edge_mm * std::sqrt(2.0)));
  }

  double field(const Eigen::VectorXd& harmonics, int first, int degree) const {
    return gate_.segment(first, harmonics_up_to(degree)).dot(harmonics.head(harmonics_up_to(degree)));
  }

  const BeatProblem& problem_;
  const GateLayout& layout_;
  const Eigen::VectorXd& gate_;
};

/// What the pixels see of the directions. Each pixel collects the three points of a ray first; then, pixel by pixel,
/// the harmonics of all rays that it sees are summed up, so that its line is written once.
class RayPainter {
 public:
  RayPainter(const BeatProblem& problem, const Vec3& sigma_mm, const std::vector<std::size_t>& chosen)
      : pixels_(problem.pixels),
        sigma_mm_(sigma_mm),
        edge_mm_(problem.cells.lattice.edge_mm),
        row_of_(problem.pixels.size(), -1),
        seen_by_(chosen.size(), 0) {
    for (std::size_t n = 0; n < chosen.size(); ++n) row_of_[chosen[n]] = n;
  }

  void paint(const WallRay& ray, std::size_t number) {
    auto& seen = seen_;
    Index3 first = pixels_.count, end{0, 0, 0};
    for (std::size_t p = 0; p < seen.size(); ++p) {
      for (std::size_t a = 0; a < 3; ++a) seen[p][a].weight.clear();
      if (ray.by_field[p].isZero(0)) continue;
      for (std::size_t a = 0; a < 3; ++a)
        look_along(pixels_, a, ray.position[p][a], sigma_mm_[a], edge_mm_, seen[p][a]);
      if (!is_seen(seen[p])) continue;
      for (std::size_t a = 0; a < 3; ++a) {
        first[a] = std::min(first[a], seen[p][a].from);
        end[a] = std::max<int>(end[a], seen[p][a].from + seen[p][a].weight.size());
      }
    }
    const Index3 size{end[0] - first[0], end[1] - first[1], end[2] - first[2]};
    if (size[0] <= 0) return;
    for (std::vector<float>& of_field : box_) of_field.assign(size_of(size), 0.0F);
    for (std::size_t p = 0; p < seen.size(); ++p)
      if (is_seen(seen[p])) add_point(seen[p], ray.by_field[p], first, size);
    look_through_box(first, size, number);
  }

  /// After all rays: sorts what was seen by its row.
  void sort(const EvenRays& rays) {
    std::size_t sum = 0;
    end_.resize(seen_by_.size());
    for (std::size_t row = 0; row < end_.size(); ++row) end_[row] = sum, sum += seen_by_[row];
    harmonics_.resize(views_.size());
    for (auto& of_field : factor_) of_field.resize(views_.size());
    for (const View& view : views_) {
      const std::size_t at = end_[view.row]++;
      harmonics_[at] = rays.lines.line(view.ray);
      for (std::size_t f = 0; f < 3; ++f) factor_[f][at] = view.by_field[f];
    }
  }

  void sum_up(const GateLayout& layout, std::size_t row, float* line) const {
    const int first[3] = {layout.endo, layout.wall, layout.uptake};
    const int degree[3] = {layout.endo_degree, layout.wall_degree, layout.uptake_degree};
    const std::size_t begin = end_[row] - seen_by_[row];
    for (std::size_t f = 0; f < 3; ++f)
      detail::add_lines(line + first[f], harmonics_up_to(degree[f]), harmonics_.data() + begin,
                        factor_[f].data() + begin, seen_by_[row]);
  }

 private:
  struct View {
    std::uint32_t row, ray;
    Eigen::Vector3f by_field;
  };

  static bool is_seen(const std::array<Seen, 3>& seen) {
    return !seen[0].weight.empty() && !seen[1].weight.empty() && !seen[2].weight.empty();
  }

  void add_point(const std::array<Seen, 3>& seen, const Eigen::Vector3f& by_field, const Index3& first,
                 const Index3& size) {
    for (std::size_t k = 0; k < seen[2].weight.size(); ++k)
      for (std::size_t j = 0; j < seen[1].weight.size(); ++j) {
        const float plane = seen[2].weight[k] * seen[1].weight[j];
        const std::size_t slice = (seen[2].from - first[2]) + k, line = (seen[1].from - first[1]) + j;
        const std::size_t begin = (seen[0].from - first[0]) + size[0] * (line + size[1] * slice);
        for (std::size_t f = 0; f < box_.size(); ++f) {
          float* at = box_[f].data() + begin;
          const float by = by_field[f];
          if (by == 0) continue;
          for (std::size_t i = 0; i < seen[0].weight.size(); ++i) at[i] += plane * seen[0].weight[i] * by;
        }
      }
  }

  void look_through_box(const Index3& first, const Index3& size, std::uint32_t number) {
    const float *endo = box_[0].data(), *wall = box_[1].data(), *uptake = box_[2].data();
    std::size_t at = 0;
    for (int k = 0; k < size[2]; ++k)
      for (int j = 0; j < size[1]; ++j) {
        const int* row = row_of_.data() + index_in(pixels_.count, {first[0], first[1] + j, first[2] + k});
        for (int i = 0; i < size[0]; ++i, ++at) {
          if (row[i] < 0 || (endo[at] == 0 && wall[at] == 0 && uptake[at] == 0)) continue;
          const std::uint32_t pixel = row[i];
          views_.push_back({pixel, number, {endo[at], wall[at], uptake[at]}});
          ++seen_by_[row[i]];
        }
      }
  }

  const Pixels& pixels_;
  Vec3 sigma_mm_;
  double edge_mm_;
  std::vector<int> row_of_;                                // per pixel; -1: none
  std::array<std::array<Seen, 3>, WallRay::points> seen_;  // [point][axis] of one ray
  std::array<std::vector<float>, 3> box_;                  // what the pixels around one ray see of it, by field
  std::vector<View> views_;                                // in the order of the rays
  std::vector<std::size_t> seen_by_;                       // views of each row
  std::vector<std::size_t> end_;                           // of those of each row, once they are sorted
  std::vector<const float*> harmonics_;
  std::array<std::vector<float>, 3> factor_;
};

/// What changes an image as a whole: the number that does, and its derivative.
struct WholeImage {
  int number;
  std::vector<float> image;
};

std::vector<WholeImage> whole_images(const BeatProblem& problem, const Eigen::VectorXd& gate, const Activity& activity,
                                     const Vec3& sigma_mm) {
  const GateLayout& layout = problem.layout.gate;
  const PsfProjector camera = make_camera(problem.cells.lattice, problem.pixels, sigma_mm, problem.filtered);
  const HeartCells& cells = problem.cells;
  const float background = gate[layout.background];
  const float cavity = gate[layout.cavity];
  std::vector<WholeImage> images;
  std::vector<float> lattice(cells.lattice.size(), 0.0F);
  const auto add = [&](int number, const auto& value_of) {
    for (std::size_t c = 0; c < cells.cell.size(); ++c) lattice[cells.cell[c]] = value_of(c);
    images.push_back({number, project(camera, lattice)});
  };
  const auto by_height = [&](std::size_t c) {
    return activity.by_plane[c] *
           ((activity.uptake[c] - background) * activity.epi[c] + (cavity - activity.uptake[c]) * activity.endo[c]);
  };
  add(layout.plane, by_height);
  add(layout.plane + 1, [&](std::size_t c) { return by_height(c) * cells.x[c]; });
  add(layout.plane + 2, [&](std::size_t c) { return by_height(c) * cells.y[c]; });
  add(layout.cavity, [&](std::size_t c) { return activity.below[c] * activity.endo[c]; });
  add(layout.background, [&](std::size_t c) { return -activity.below[c] * activity.epi[c]; });
  for (float& v : images.back().image) v += 1.0F;
  const auto by_widths = project_by_widths(camera, activity.cells);
  for (int number = 0; number < 3; ++number) {
    images.push_back({layout.width + number, std::vector<float>(problem.pixels.size(), 0.0F)});
    for (int axis = 0; axis < 3; ++axis) {
      const float factor = log_widths(axis, number);
      for (std::size_t n = 0; n < problem.pixels.size(); ++n) images.back().image[n] += factor * by_widths[axis][n];
    }
  }
  return images;
}

}  // namespace

EvenRays even_rays(const BeatProblem& problem) {
  const GateLayout& layout = problem.layout.gate;
  const Vec3& scale = problem.cells.frame.scale;
  // Points as dense as the blur is wide sum up smoothly.
  const double pitch = 1.15 * std::max(problem.sigma_mm, 0.8 * problem.pixels.spacing.minCoeff());
  const double area = 4 * M_PI * scale[0] * (0.4 * scale[0] + 0.6 * scale[2]) * 1.4;
  const int count = std::clamp(area / (pitch * pitch), 150.0, 1200.0);
  const int degree = std::max({layout.endo_degree, layout.wall_degree, layout.uptake_degree});
  const std::size_t length = harmonics_up_to(degree), lines = count;
  EvenRays rays{{}, Eigen::MatrixXd(length, count), {}};
  rays.lines = {lines, length};
  for (int n = 0; n < count; ++n) {
    rays.direction.push_back(fibonacci_direction(n, count));
    real_spherical_harmonics(rays.direction.back(), degree, {rays.harmonics.col(n).data(), length});
    std::copy(rays.harmonics.col(n).begin(), rays.harmonics.col(n).end(), rays.lines.line(n));
  }
  return rays;
}

detail::AlignedMatrix squares_of_derivatives(const BeatProblem& problem, const EvenRays& rays, std::size_t g,
                                             const Eigen::VectorXd& gate, const Activity& activity,
                                             const std::vector<std::size_t>& chosen) {
  const GateLayout& layout = problem.layout.gate;
  const Vec3 sigma = point_spread(problem, gate);
  RayPainter painter(problem, sigma, chosen);
  const WallRays walls(problem, gate);
  const double solid_angle = 4 * M_PI / rays.direction.size();
  for (std::size_t n = 0; n < rays.direction.size(); ++n)
    painter.paint(walls.along(rays.direction[n], rays.harmonics.col(n), solid_angle), n);
  painter.sort(rays);
  const std::vector<WholeImage> images = whole_images(problem, gate, activity, sigma);

  // Some lines at a time, so that they are still in the cache when they are squared.
  const std::size_t length = layout.count();
  detail::AlignedMatrix squares = detail::no_squares(length), lines(detail::lines_at_once, length);
  for (std::size_t first = 0; first < chosen.size(); first += lines.count) {
    const std::size_t count = std::min(lines.count, chosen.size() - first);
    std::fill(lines.values.begin(), lines.values.end(), 0.0F);
    for (std::size_t n = 0; n < count; ++n) {
      float* line = lines.line(n);
      const std::size_t pixel = chosen[first + n];
      painter.sum_up(layout, first + n, line);
      for (const WholeImage& whole : images) line[whole.number] = whole.image[pixel];
      for (int k = 0; k < layout.attenuation_count; ++k)
        line[layout.attenuation + k] = problem.attenuation[k][g][pixel];
      for (int b = 0; b < layout.blob_count; ++b) line[layout.blobs + b] = problem.blobs[b][pixel];
      const float scale = std::sqrt(problem.weight[pixel]);
      for (std::size_t i = 0; i < length; ++i) line[i] *= scale;
    }
    detail::syrk(lines, count, squares);
  }
  return squares;
}

}  // namespace dynasurf::psf_fit
