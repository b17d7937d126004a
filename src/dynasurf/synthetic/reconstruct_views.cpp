#include <algorithm>
#include <cmath>
#include <string>
#include <type_traits>

#include "dynasurf/core/detail/elementary.hpp"
#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"
#include "dynasurf/synthetic/camera.hpp"
#include "dynasurf/synthetic/detail/plane_filter.hpp"
#include "dynasurf/synthetic/detail/projector.hpp"
#include "dynasurf/synthetic/detail/render.hpp"

namespace dynasurf::synthetic {
namespace {

/// The window at a frequency in cycles per cm.
double window_at(const Fbp& o, double frequency) {
  switch (o.window) {
    case Window::ramp:
      return 1;
    case Window::butterworth:
      return 1 / std::sqrt(1 + own::pow(frequency / o.cutoff_per_cm, 2 * o.order));
    case Window::hann:
      return frequency < o.cutoff_per_cm ? 0.5 * (1 + own::cos(M_PI * frequency / o.cutoff_per_cm)) : 0;
  }
  return 1;
}

PlaneFilter filter_of(const Fbp& o, int n, double bin_mm) {
  std::vector<double> ramp;
  return make_plane_filter(n, [&](int k, int l, int size) {
    if (ramp.empty()) ramp = ramp_spectrum(size);
    const double per_cm = 10 / (bin_mm * size);
    return ramp[k < 0 ? k + size : k] * window_at(o, own::hypot(k * per_cm, l * per_cm));
  });
}

/// Adds what one filtered view (across slowest) says of each column, by linear interpolation.
void spread(const std::vector<float>& bins, double angle_deg, float scale, Columns& sum) {
  const Index n = sum.n;
  const double angle = angle_deg * (M_PI / 180), middle = (n - 1) / 2.0, c = own::cos(angle), s = own::sin(angle);
  for (Index y = 0; y < n; ++y)
    for (Index x = 0; x < n; ++x) {
      const double a = middle + (x - middle) * c + (y - middle) * s;
      const Index below = floor_int(a);
      if (below < 0 || below + 1 >= n) continue;
      const auto up = static_cast<float>(a - below) * scale, down = scale - up;
      const float* low = &bins[below * n];
      float* column = &sum.values[(y * n + x) * n];
      for (Index z = 0; z < n; ++z) column[z] += down * low[z] + up * low[n + z];
    }
}

std::vector<float> view_of(const Projections& p, const std::vector<float>& gate, std::size_t view) {
  return transposed(std::span(gate).subspan(view * p.bins(), p.bins()), p.size);
}

/// f = integral over half a turn of the filtered projections. On an arc other than half a turn or a whole one, all
/// views count alike.
std::vector<Image> run(const Projections& p, const Image*, const Fbp& o) {
  const PlaneFilter filter = filter_of(o, p.size, p.bin_mm);
  const float scale = M_PI / p.views();
  std::vector<Image> images(p.gates.size());
  parallel_for(images.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      Columns sum(p.size);
      // Two views in one transform: one is its real, the other its imaginary part.
      for (std::size_t v = 0; v < p.views(); v += 2) {
        const std::size_t next = std::min(v + 1, p.views() - 1);
        std::vector<float> first = view_of(p, p.gates[g], v), second = view_of(p, p.gates[g], next);
        filter_planes(filter, first, second);
        spread(first, p.angle_deg[v], scale, sum);
        if (next != v) spread(second, p.angle_deg[next], scale, sum);
      }
      images[g] = image_of(sum, transaxial_grid(p));
    }
  });
  return images;
}

/// The columns that every view sees: a disc.
Columns seen_disc(int n, float value) {
  Columns disc(n);
  disc.is_empty.assign(size_of({n, n, 1}), 1);
  for (int y = 0; y < n; ++y)
    for (int x = 0; x < n; ++x) {
      const double dx = x - (n - 1) / 2.0, dy = y - (n - 1) / 2.0;
      if (dx * dx + dy * dy > 0.25 * (n - 1) * (n - 1)) continue;
      const std::size_t column = index_in({n, n, 1}, {x, y, 0});
      disc.is_empty[column] = 0;
      std::fill_n(disc.values.begin() + column * n, n, value);
    }
  return disc;
}

/// One step of a gate: estimate *= A' (counts / (A estimate + scatter)) / A' 1.
void step(const Projections& p, std::size_t gate, bool use_scatter, const std::vector<std::size_t>& subset,
          const std::vector<ViewModel>& models, const Columns& norm, Columns& estimate) {
  Columns ratio(p.size);
  for (std::size_t s = 0; s < subset.size(); ++s) {
    std::vector<float> expected(p.bins(), 0.0F);
    if (use_scatter) expected = view_of(p, p.scatter[gate], subset[s]);
    project_view(models[s], estimate, expected, {});
    const std::vector<float> counts = view_of(p, p.gates[gate], subset[s]);
    for (std::size_t b = 0; b < expected.size(); ++b) expected[b] = expected[b] > 0 ? counts[b] / expected[b] : 0;
    back_project_view(models[s], expected, ratio);
  }
  for (std::size_t v = 0; v < ratio.values.size(); ++v)
    if (estimate.values[v] > 0) estimate.values[v] *= norm.values[v] > 0 ? ratio.values[v] / norm.values[v] : 0;
}

std::vector<Image> run(const Projections& p, const Image* attenuation, const Osem& o) {
  require_even_subsets(o, p.views());
  if (o.scatter && p.scatter.empty())
    throw OptionError("option reconstruction.scatter is true; expected false where the camera noted no scatter");
  if (o.attenuation && attenuation == nullptr) throw InputError("a map of attenuation was expected; there is none");
  const Columns map = o.attenuation ? columns_of(*attenuation) : Columns(0);
  std::vector<Columns> estimates(p.gates.size(), seen_disc(p.size, 1));
  const std::size_t subsets = o.subsets, per_subset = p.views() / subsets;
  for (std::size_t turn = 0; turn < o.iterations * subsets; ++turn) {
    std::vector<std::size_t> subset;
    // Views of a subset lie evenly around the patient.
    for (std::size_t s = 0; s < per_subset; ++s) subset.push_back(turn % subsets + s * subsets);
    std::vector<ViewModel> models(per_subset);
    parallel_for(per_subset, 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s)
        models[s] = make_view(p.size, {p.angle_deg[subset[s]], p.radius_mm[subset[s]], p.bin_mm,
                                       o.attenuation ? &map : nullptr, o.resolution ? &p.response : nullptr});
    });
    Columns norm(p.size);
    const std::vector<float> ones(p.bins(), 1.0F);
    for (const ViewModel& model : models) back_project_view(model, ones, norm);
    parallel_for(estimates.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t g = begin; g < end; ++g) step(p, g, o.scatter, subset, models, norm, estimates[g]);
    });
  }
  std::vector<Image> images(estimates.size());
  parallel_for(images.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t g = begin; g < end; ++g) {
      images[g] = image_of(estimates[g], transaxial_grid(p));
      if (o.filter_fwhm_mm > 0) images[g] = blur(images[g], o.filter_fwhm_mm);
    }
  });
  return images;
}

}  // namespace

void require_even_subsets(const Osem& options, std::size_t views) {
  if (views % options.subsets != 0)
    throw OptionError("option reconstruction.subsets is " + std::to_string(options.subsets) +
                      "; expected a divisor of the " + std::to_string(views) + " views");
}

std::vector<Image> reconstruct_views(const Projections& projections, const Image* attenuation,
                                     const Reconstruction& options) {
  Reconstruction chosen = options;
  std::visit([](auto& o) { check_options(o, "reconstruction"); }, chosen);
  if (projections.gates.empty() || projections.views() == 0)
    throw InputError("there are no projections to reconstruct");
  if (attenuation != nullptr && !(attenuation->grid == transaxial_grid(projections)))
    throw InputError("the attenuation lies on another grid than the reconstruction");
  return std::visit([&](const auto& o) { return run(projections, attenuation, o); }, chosen);
}

Image cut_out(const Image& image, const Grid& grid) {
  Image result(grid);
  const Grid& from = image.grid;
  const auto value = [&](int i, int j, int k) -> double { return from.contains(i, j, k) ? image(i, j, k) : 0; };
  parallel_for(grid.dims[2], 1, [&](int begin, int end) {
    for (int k = begin; k < end; ++k)
      for (int j = 0; j < grid.dims[1]; ++j)
        for (int i = 0; i < grid.dims[0]; ++i) {
          const Vec3 p = to_grid(from, to_world(grid, centre_of(grid, {i, j, k}))).cwiseQuotient(from.spacing);
          const int x = floor_int(p[0]), y = floor_int(p[1]), z = floor_int(p[2]);
          double sum = 0;
          for (int c = 0; c < 8; ++c) {
            const double fx = p[0] - x, fy = p[1] - y, fz = p[2] - z;
            sum += (c & 1 ? fx : 1 - fx) * (c & 2 ? fy : 1 - fy) * (c & 4 ? fz : 1 - fz) *
                   value(x + (c & 1), y + (c >> 1 & 1), z + (c >> 2));
          }
          result(i, j, k) = sum;
        }
  });
  return result;
}

}  // namespace dynasurf::synthetic
