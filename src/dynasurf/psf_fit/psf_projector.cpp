#include "dynasurf/psf_fit/detail/psf_projector.hpp"

#include <algorithm>
#include <cmath>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/psf_fit/detail/matrix_loops.hpp"

namespace dynasurf::psf_fit {
namespace {

constexpr double reach_sigmas = 3.7;

double gaussian(double x, double variance) {
  return own::exp(-x * x / (2 * variance)) / std::sqrt(2 * M_PI * variance);
}

/// Share of a cell that lies in a voxel.
double overlap(double cell, double step, double voxel, double spacing) {
  const double low = std::max(cell - step / 2, voxel - spacing / 2),
               high = std::min(cell + step / 2, voxel + spacing / 2);
  return std::max(0.0, high - low) / spacing;
}

/// exp(-t) I_n(t), n = 0, 1, ... up to where it ends: a Gaussian filter of variance t on a lattice.
std::vector<double> discrete_gaussian(double t) {
  const int reach = ceil_int(4.5 * std::sqrt(t)) + 1;
  // The integral of exp(t (cos w - 1)) cos(n w) over one period; the trapezoid rule is exact for periodic functions.
  constexpr int nodes = 64;
  std::vector<double> half;
  for (int n = 0; n <= reach; ++n) {
    double sum = 0;
    for (int m = 0; m < nodes; ++m) {
      const double w = 2 * M_PI * m / nodes;
      sum += own::exp(t * (own::cos(w) - 1)) * own::cos(n * w);
    }
    half.push_back(sum / nodes);
  }
  return half;
}

/// What a voxel of the study collects of a cell at a distance, and its derivative by the log of the deviation.
class VoxelKernel {
 public:
  VoxelKernel(const CellLattice& cells, const Pixels& pixels, int axis, double sigma_mm, double filtered)
      : step_(cells.step[axis]), spacing_(pixels.spacing[axis]) {
    const double whole = sigma_mm * sigma_mm - cells.edge_mm * cells.edge_mm;
    double of_filter = filtered * sigma_mm * sigma_mm;
    // A Gaussian much narrower than a cell cannot be sampled; the voxel itself is the widest part of the blur there.
    const double least = 0.36 * step_ * step_;
    is_box_ = whole < least;
    if (!is_box_) {
      of_filter = std::min(of_filter, whole - least);
      variance_ = whole - of_filter;
      by_log_sigma_ = 2 * sigma_mm * sigma_mm;
      filter_ = discrete_gaussian(of_filter / (spacing_ * spacing_));
    }
  }
  double reach() const {
    if (is_box_) return spacing_ / 2 + step_ / 2;
    return reach_sigmas * std::sqrt(variance_) + spacing_ * (filter_.size() - 1);
  }
  double weight(double distance) const {
    if (is_box_) return overlap(distance, step_, 0, spacing_);
    return sum(distance, [&](double x) { return step_ * gaussian(x, variance_); });
  }
  /// The filter stays while the camera's blur widens.
  double by_log_sigma(double distance) const {
    if (is_box_) return 0;
    return sum(distance, [&](double x) {
      return step_ * gaussian(x, variance_) * (x * x / variance_ - 1) / (2 * variance_) * by_log_sigma_;
    });
  }

 private:
  template <class F>
  double sum(double distance, const F& value) const {
    double total = filter_[0] * value(distance);
    for (std::size_t n = 1; n < filter_.size(); ++n) {
      const double shift = spacing_ * n;
      total += filter_[n] * (value(distance - shift) + value(distance + shift));
    }
    return total;
  }
  double step_, spacing_, variance_ = 0, by_log_sigma_ = 0;
  bool is_box_ = false;
  std::vector<double> filter_;
};

AxisKernel axis_kernel(const CellLattice& cells, const Pixels& pixels, int axis, double sigma_mm, double filtered) {
  const double step = cells.step[axis], spacing = pixels.spacing[axis];
  const VoxelKernel voxel_kernel(cells, pixels, axis, sigma_mm, filtered);
  const double reach = voxel_kernel.reach() + 0.5 * spacing * (pixels.joined[axis] - 1);
  const int cell_count = cells.count[axis], joined = pixels.joined[axis];
  AxisKernel kernel;
  for (int n = 0; n < pixels.count[axis]; ++n) {
    const double centre = pixels.centre(axis, n);
    const int from = std::clamp(ceil_int((centre - reach - cells.start[axis]) / step), 0, cell_count);
    const int to = std::clamp(floor_int((centre + reach - cells.start[axis]) / step) + 1, from, cell_count);
    kernel.from.push_back(from);
    kernel.to.push_back(to);
    kernel.at.push_back(kernel.weights.size());
    for (int c = from; c < to; ++c) {
      const double cell = cells.start[axis] + c * step;
      double weight = 0, by_width = 0;
      for (int v = 0; v < joined; ++v) {
        const double voxel = spacing * (pixels.first[axis] + n * joined + v);
        weight += voxel_kernel.weight(cell - voxel) / joined;
        by_width += voxel_kernel.by_log_sigma(cell - voxel) / joined;
      }
      kernel.weights.push_back(weight);
      kernel.by_width.push_back(by_width);
    }
  }
  return kernel;
}

/// A kernel along one axis, or its transpose: what every number of `to` collects of those of `from`.
struct Collector {
  const float* weights = nullptr;
  std::vector<int> from, to, at;
  std::vector<float> own;  // of a transpose
};
Collector collector(const AxisKernel& kernel, const std::vector<float>& weights) {
  return {weights.data(), kernel.from, kernel.to, kernel.at, {}};
}
Collector transposed(const AxisKernel& kernel, int cells) {
  const std::size_t pixels = kernel.from.size();
  Collector back;
  for (int c = 0; c < cells; ++c) {
    // Pixels that see a cell lie together.
    std::size_t first = 0;
    while (first < pixels && kernel.to[first] <= c) ++first;
    std::size_t end = first;
    back.at.push_back(back.own.size());
    for (; end < pixels && kernel.from[end] <= c && c < kernel.to[end]; ++end)
      back.own.push_back(kernel.weights[kernel.at[end] + c - kernel.from[end]]);
    back.from.push_back(first);
    back.to.push_back(end);
  }
  back.weights = back.own.data();
  return back;
}

/// out[n] += sum over the kernel of in[c], for blocks of `stride` values that lie together; `length` of them go in.
void collect(const Collector& kernel, int length, std::size_t stride, std::size_t blocks, const float* in, float* out) {
  std::vector<const float*> lines;
  for (std::size_t b = 0; b < blocks; ++b, in += length * stride)
    for (std::size_t n = 0; n < kernel.from.size(); ++n, out += stride) {
      lines.clear();
      for (int c = kernel.from[n]; c < kernel.to[n]; ++c) lines.push_back(in + c * stride);
      detail::add_lines(out, stride, lines.data(), kernel.weights + kernel.at[n], lines.size());
    }
}

/// The same for single values: all that one of `in` goes to is added at once. `out` has `out_length` values a block.
void spread(const Collector& kernel, int length, int out_length, std::size_t blocks, const float* in, float* out) {
  detail::AlignedMatrix to_all(length, out_length);
  for (std::size_t n = 0; n < kernel.from.size(); ++n)
    for (int c = kernel.from[n]; c < kernel.to[n]; ++c)
      to_all.line(c)[n] = kernel.weights[kernel.at[n] + c - kernel.from[n]];
  std::vector<const float*> lines;
  for (std::size_t c = 0; c < to_all.count; ++c) lines.push_back(to_all.line(c));
  for (std::size_t b = 0; b < blocks; ++b, in += length, out += out_length)
    detail::add_lines(out, to_all.length, lines.data(), in, lines.size());
}

/// The three passes from cells to pixels: along z first, where whole planes lie together, then y, then x. Each adds.
struct Passes {
  Index3 c, p;
  std::vector<float> along_z() const { return std::vector<float>(size_of({c[0], c[1], p[2]})); }
  std::vector<float> along_y() const { return std::vector<float>(size_of({c[0], p[1], p[2]})); }
  void z(const Collector& kernel, const float* in, std::vector<float>& out) const {
    collect(kernel, c[2], size_of({c[0], c[1], 1}), 1, in, out.data());
  }
  void y(const Collector& kernel, const std::vector<float>& in, std::vector<float>& out) const {
    collect(kernel, c[1], c[0], p[2], in.data(), out.data());
  }
  void x(const Collector& kernel, const std::vector<float>& in, std::vector<float>& out) const {
    spread(kernel, c[0], p[0], size_of({1, p[1], p[2]}), in.data(), out.data());
  }
};

}  // namespace

std::vector<float> join(const Image& image, const Pixels& p) {
  std::vector<float> means(p.size());
  std::size_t at = 0;
  for (int k = 0; k < p.count[2]; ++k)
    for (int j = 0; j < p.count[1]; ++j)
      for (int i = 0; i < p.count[0]; ++i) {
        double sum = 0;
        for (int c = 0; c < p.joined[2]; ++c)
          for (int b = 0; b < p.joined[1]; ++b)
            for (int a = 0; a < p.joined[0]; ++a)
              sum += image(p.first[0] + i * p.joined[0] + a, p.first[1] + j * p.joined[1] + b,
                           p.first[2] + k * p.joined[2] + c);
        means[at++] = sum / (p.joined[0] * p.joined[1] * p.joined[2]);
      }
  return means;
}

PsfProjector make_camera(const CellLattice& cells, const Pixels& pixels, const Vec3& sigma_mm, double filtered) {
  PsfProjector camera{cells, pixels, {}};
  for (int a = 0; a < 3; ++a) camera.axes[a] = axis_kernel(cells, pixels, a, sigma_mm[a], filtered);
  return camera;
}

std::vector<float> project(const PsfProjector& camera, std::span<const float> cells) {
  const Passes pass{camera.cells.count, camera.pixels.count};
  const auto kernel = [&](std::size_t axis) { return collector(camera.axes[axis], camera.axes[axis].weights); };
  std::vector<float> z = pass.along_z(), y = pass.along_y(), x(camera.pixels.size());
  pass.z(kernel(2), cells.data(), z);
  pass.y(kernel(1), z, y);
  pass.x(kernel(0), y, x);
  return x;
}

std::array<std::vector<float>, 3> project_by_widths(const PsfProjector& camera, std::span<const float> cells) {
  const Passes pass{camera.cells.count, camera.pixels.count};
  const auto kernel = [&](std::size_t axis) { return collector(camera.axes[axis], camera.axes[axis].weights); };
  const auto by_width = [&](std::size_t axis) { return collector(camera.axes[axis], camera.axes[axis].by_width); };
  const auto passed_x = [&](const Collector& along_x, const std::vector<float>& in) {
    std::vector<float> out(camera.pixels.size());
    pass.x(along_x, in, out);
    return out;
  };
  const auto passed_y = [&](const Collector& along_y, const std::vector<float>& in) {
    std::vector<float> out = pass.along_y();
    pass.y(along_y, in, out);
    return out;
  };
  std::vector<float> z = pass.along_z(), by_z = pass.along_z();
  pass.z(kernel(2), cells.data(), z);
  pass.z(by_width(2), cells.data(), by_z);
  return {passed_x(by_width(0), passed_y(kernel(1), z)), passed_x(kernel(0), passed_y(by_width(1), z)),
          passed_x(kernel(0), passed_y(kernel(1), by_z))};
}

std::vector<float> backproject(const PsfProjector& camera, std::span<const float> pixels) {
  const Index3 c = camera.cells.count, p = camera.pixels.count;
  const Passes pass{c, p};
  std::vector<float> y = pass.along_y(), z = pass.along_z(), x(camera.cells.size());
  spread(transposed(camera.axes[0], c[0]), p[0], c[0], size_of({1, p[1], p[2]}), pixels.data(), y.data());
  collect(transposed(camera.axes[1], c[1]), p[1], c[0], p[2], y.data(), z.data());
  collect(transposed(camera.axes[2], c[2]), p[2], size_of({c[0], c[1], 1}), 1, z.data(), x.data());
  return x;
}

}  // namespace dynasurf::psf_fit
