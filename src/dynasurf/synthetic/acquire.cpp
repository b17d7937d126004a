#include <cmath>
#include <string>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/detail/projector.hpp"
#include "dynasurf/synthetic/detail/random.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

/// Two windows of 5.6 keV beside a peak of 28 keV hold this part of the peak's scatter.
constexpr double side_windows = 0.4;
/// Scatter has no detail: its estimate is smoothed that much.
constexpr double scatter_filter_mm = 30;
// Streams of random numbers: counts of gate g have 2 g, its side windows 2 g + 1.
constexpr std::uint64_t stream_of_beats = std::uint64_t{1} << 40;

/// Weights of neighbours at first, first + 1, ...
struct Kernel {
  int first = 0;
  std::vector<float> weights{1.0F};
};

/// The mean over several displacements, in bins, by linear interpolation.
Kernel kernel_of(const std::vector<double>& shifts) {
  const auto [least, most] = std::minmax_element(shifts.begin(), shifts.end());
  Kernel kernel;
  kernel.first = floor_int(*least);
  kernel.weights.assign(floor_int(*most) - kernel.first + 2, 0.0F);
  for (const double shift : shifts) {
    const int below = floor_int(shift), cell = below - kernel.first;
    const float nearer = (1 - (shift - below)) / shifts.size(), further = (shift - below) / shifts.size();
    kernel.weights[cell] += nearer;
    kernel.weights[cell + 1] += further;
  }
  return kernel;
}

std::vector<float> displaced(const std::vector<float>& square, Index n, const Kernel& across, const Kernel& along) {
  std::vector<float> result(square.size(), 0.0F);
  for (Index a = 0; a < n; ++a)
    for (Index s = 0; s < std::ssize(across.weights); ++s) {
      const Index to = a + across.first + s;
      if (to < 0 || to >= n || across.weights[s] == 0) continue;
      for (Index z = 0; z < n; ++z)
        for (Index t = 0; t < std::ssize(along.weights); ++t) {
          const Index up = z + along.first + t;
          if (up < 0 || up >= n) continue;
          result[to * n + up] += across.weights[s] * along.weights[t] * square[a * n + z];
        }
    }
  return result;
}

/// Where a breath carries the activity along the body: cos⁴ rests at expiration (Lujan et al. 1999). mm, of mean 0.
std::vector<double> breath(double way_mm) {
  constexpr int instants = 8;
  if (way_mm == 0) return {0.0};
  std::vector<double> along;
  for (int i = 0; i < instants; ++i) {
    const double c = own::cos(M_PI * i / instants);
    along.push_back(way_mm * (c * c * c * c - 3.0 / 8));
  }
  return along;
}

struct Movement {
  Kernel across, along;
  bool is_any = false;
};

Movement movement_at(const Acquisition& o, std::size_t view, double angle_deg, double voxel_mm) {
  const bool moved = view >= o.move_at * o.views;
  const double angle = angle_deg * (M_PI / 180);
  std::vector<double> along = breath(o.breathing_mm);
  for (double& z : along) z = (z + (moved ? o.move_z_mm : 0)) / voxel_mm;
  const double across = moved ? (o.move_x_mm * own::cos(angle) + o.move_y_mm * own::sin(angle)) / voxel_mm : 0;
  return {kernel_of({across}), kernel_of(along), along.size() > 1 || along[0] != 0 || across != 0};
}

/// Fine bins (across slowest) summed into the camera's, as rows with columns fastest, added to `bins`.
void rebin(const std::vector<float>& fine, Index n, int factor, float* bins) {
  const Index size = n / factor;
  for (Index a = 0; a < n; ++a)
    for (Index z = 0; z < n; ++z) bins[z / factor * size + a / factor] += fine[a * n + z];
}

/// Expected counts of one view in all gates, in the unit of the activity.
void see(const std::vector<Columns>& activity, const ViewModel& model, const Movement& movement, int factor,
         std::size_t view, Projections& p) {
  const int n = model.n;
  const std::size_t square = size_of({n, n, 1});
  for (std::size_t g = 0; g < activity.size(); ++g) {
    std::vector<float> direct(square, 0.0F), scattered(model.buildup.empty() ? 0 : square, 0.0F);
    project_view(model, activity[g], direct, scattered);
    if (movement.is_any) direct = displaced(direct, n, movement.across, movement.along);
    rebin(direct, n, factor, &p.gates[g][view * p.bins()]);
    if (!scattered.empty()) rebin(scattered, n, factor, &p.scatter[g][view * p.bins()]);
  }
}

/// Smooths what the side windows tell.
void smooth(std::vector<float>& scatter, int size, double bin_mm) {
  const double sigma = sigma_of_fwhm(scatter_filter_mm) / bin_mm;
  const std::size_t bins = size_of({size, size, 1});
  for (std::size_t v = 0; v < scatter.size(); v += bins)
    widen_square(std::span(scatter).subspan(v, bins), size, sigma * sigma, sigma * sigma);
}

/// From expectations in the unit of the activity to counts.
void count(Projections& p, const Acquisition& o, std::uint64_t seed) {
  double total = 0;
  for (const auto* kind : {&p.gates, &p.scatter})
    for (const auto& gate : *kind)
      for (const float value : gate) total += value;
  const double scale = total > 0 ? 1e6 * o.million_counts / total : 0;
  parallel_for(p.gates.size() * p.views(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n) {
      const std::size_t g = n / p.views(), v = n % p.views();
      const double accepted = 1 - 2 * o.rejected_percent / 100 * Random(seed, stream_of_beats, v).uniform();
      for (std::size_t b = v * p.bins(); b < (v + 1) * p.bins(); ++b) {
        const double aside = p.scatter.empty() ? 0 : scale * accepted * p.scatter[g][b];
        double mean = scale * accepted * p.gates[g][b] + aside, told = aside;
        if (o.is_noisy) {
          mean = Random(seed, 2 * g, b).poisson(mean);
          told = Random(seed, 2 * g + 1, b).poisson(side_windows * aside) / side_windows;
        }
        p.gates[g][b] = mean;
        if (!p.scatter.empty()) p.scatter[g][b] = told;
      }
    }
  });
  for (auto& gate : p.scatter) smooth(gate, p.size, p.bin_mm);
}

Projections blank(const Grid& grid, int factor, std::size_t gates, const std::vector<double>& angle_deg,
                  const std::vector<double>& radius_mm, bool is_scattered) {
  Projections p;
  p.size = grid.dims[0] / factor;
  p.bin_mm = grid.spacing[0] * factor;
  p.centre = to_world(grid, 0.5 * (grid.dims[0] - 1) * grid.spacing);
  p.angle_deg = angle_deg, p.radius_mm = radius_mm;
  p.gates.assign(gates, std::vector<float>(p.views() * p.bins(), 0.0F));
  if (is_scattered) p.scatter = p.gates;
  return p;
}

void check_cubic(const std::vector<Image>& activity, const Image* attenuation, std::size_t angles, std::size_t radii) {
  if (activity.empty()) throw InputError("projections need an activity; none was given");
  const Grid& grid = activity.front().grid;
  const bool is_cube = grid.dims[0] == grid.dims[1] && grid.dims[0] == grid.dims[2] && grid.dims[0] >= 2 &&
                       grid.spacing == Vec3::Constant(grid.spacing[0]) && grid.direction == Mat3::Identity();
  if (!is_cube) throw InputError("the activity does not lie on n x n x n cubic voxels with the axes of the world");
  for (const Image& image : activity)
    if (!(image.grid == grid)) throw InputError("the gates of the activity lie on different grids");
  if (attenuation != nullptr && !(attenuation->grid == grid))
    throw InputError("the attenuation lies on another grid than the activity");
  if (angles != radii) throw InputError("the views have as many angles as radii; the numbers differ");
}

}  // namespace

Collimator collimator_of(const Acquisition& acquisition) {
  switch (acquisition.collimator) {
    case CollimatorModel::lehr:
      return {1.11, 0.16, 24.05, 3.8};
    case CollimatorModel::legp:
      return {1.45, 0.20, 24.05, 3.8};
    case CollimatorModel::czt:
      return {2.26, 0.20, 21.7, 2.46};
    case CollimatorModel::own:
      break;
  }
  return acquisition.own_collimator;
}

namespace {
/// Holes less two mean free paths in lead at 140 keV, through which photons pass at both ends.
double effective_length_mm(const Collimator& c) { return c.length_mm - 0.74; }
}  // namespace

CameraResponse response_of(const Collimator& c) {
  return {c.intrinsic_mm, c.hole_mm, c.hole_mm / effective_length_mm(c)};
}

double fwhm_at(const CameraResponse& r, double distance_mm) {
  const double aperture = r.aperture_mm + r.growth * distance_mm;
  return std::sqrt(r.intrinsic_mm * r.intrinsic_mm + aperture * aperture);
}

double sensitivity_cps_per_mbq(const Collimator& c) {
  constexpr double shape = 0.26, photons_per_decay = 0.885, counted = 0.86;
  const double cone = shape * c.hole_mm / effective_length_mm(c), open = c.hole_mm / (c.hole_mm + c.septum_mm);
  return 1e6 * cone * cone * open * open * photons_per_decay * counted;
}

std::vector<double> angles_of(const Acquisition& o) {
  std::vector<double> angles;
  angles.reserve(o.views);
  for (int v = 0; v < o.views; ++v) angles.push_back(o.start_deg + o.arc_deg * v / o.views);
  return angles;
}

Grid activity_grid(const Acquisition& o, const Vec3& centre) {
  Grid grid;
  const int n = o.size * o.oversampling;
  grid.dims = {n, n, n};
  grid.spacing = Vec3::Constant(o.bin_mm / o.oversampling);
  grid.origin = centre - 0.5 * (n - 1) * grid.spacing;
  return grid;
}

Projections project(const std::vector<Image>& activity, const Image* attenuation, const CameraResponse* response,
                    const std::vector<double>& angle_deg, const std::vector<double>& radius_mm) {
  check_cubic(activity, attenuation, angle_deg.size(), radius_mm.size());
  const Grid& grid = activity.front().grid;
  Projections p = blank(grid, 1, activity.size(), angle_deg, radius_mm, false);
  if (response != nullptr) p.response = *response;
  std::vector<Columns> columns;
  columns.reserve(activity.size());
  for (const Image& image : activity) columns.push_back(columns_of(image));
  const Columns map = attenuation != nullptr ? columns_of(*attenuation) : Columns(0);
  parallel_for(p.views(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      ViewSettings s{angle_deg[v], radius_mm[v], grid.spacing[0], attenuation != nullptr ? &map : nullptr, response};
      see(columns, make_view(p.size, s), {}, 1, v, p);
    }
  });
  return p;
}

Grid transaxial_grid(const Projections& p) {
  Grid grid;
  grid.dims = {p.size, p.size, p.size};
  grid.spacing = Vec3::Constant(p.bin_mm);
  grid.origin = p.centre - 0.5 * (p.size - 1) * grid.spacing;
  return grid;
}

std::vector<Image> back_project(const Projections& p, const Image* attenuation, const CameraResponse* response) {
  const Columns map = attenuation != nullptr ? columns_of(*attenuation) : Columns(0);
  std::vector<Image> images(p.gates.size());
  parallel_for(images.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      Columns sum(p.size);
      for (std::size_t v = 0; v < p.views(); ++v) {
        ViewSettings s{p.angle_deg[v], p.radius_mm[v], p.bin_mm, attenuation != nullptr ? &map : nullptr, response};
        const std::vector<float> bins = transposed(std::span(p.gates[g]).subspan(v * p.bins(), p.bins()), p.size);
        back_project_view(make_view(p.size, s), bins, sum);
      }
      images[g] = image_of(sum, transaxial_grid(p));
    }
  });
  return images;
}

Projections acquire(const std::vector<Image>& activity, const Image& attenuation, const std::vector<double>& radius_mm,
                    const Acquisition& options, std::uint64_t seed) {
  Acquisition o = options;
  check_options(o, "acquisition");
  const std::vector<double> angle_deg = angles_of(o);
  check_cubic(activity, &attenuation, angle_deg.size(), radius_mm.size());
  const Grid& grid = attenuation.grid;
  if (grid.dims[0] != o.size * o.oversampling)
    throw InputError("the activity has " + std::to_string(grid.dims[0]) + " voxels a side; expected " +
                     std::to_string(o.size * o.oversampling));
  const bool is_scattered = o.scatter > 0 && o.attenuation;
  Projections p = blank(grid, o.oversampling, activity.size(), angle_deg, radius_mm, is_scattered);
  p.response = response_of(collimator_of(o));
  std::vector<Columns> columns;
  columns.reserve(activity.size());
  for (const Image& image : activity) columns.push_back(columns_of(image));
  const Columns map = columns_of(attenuation);
  parallel_for(p.views(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t v = begin; v < end; ++v) {
      const ViewSettings s{angle_deg[v],
                           radius_mm[v],
                           grid.spacing[0],
                           o.attenuation ? &map : nullptr,
                           &p.response,
                           is_scattered ? o.scatter : 0,
                           o.scatter_slope_per_cm / 10};
      see(columns, make_view(grid.dims[0], s), movement_at(o, v, angle_deg[v], grid.spacing[0]), o.oversampling, v, p);
    }
  });
  count(p, o, seed);
  return p;
}

}  // namespace dynasurf::synthetic
