#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "dynasurf/core/study.hpp"
#include "dynasurf/core/volume.hpp"

// One view of a camera with parallel holes as a linear operator and its adjoint. Internal.

namespace dynasurf::synthetic {

/// An n × n × n volume as columns along the patient: value (x, y, z) at (y n + x) n + z, so that what a view does to a
/// column is done to all its voxels at once.
struct Columns {
  int n = 0;
  std::vector<float> values;
  std::vector<std::uint8_t> is_empty;  // per column
  explicit Columns(int side) : n(side), values(size_of({side, side, side})) {}
};
Columns columns_of(const Image& image);
Image image_of(const Columns& columns, const Grid& grid);

/// The four columns around a point of the rotated lattice, and their weights; -1: beyond the volume.
struct Taps {
  std::array<int, 4> column{-1, -1, -1, -1};
  std::array<float, 4> weight{};
};

/// What a view does, whatever the activity. Depth 0 is next to the camera.
struct ViewModel {
  int n = 0;
  double cos = 1, sin = 0;
  std::vector<Taps> taps;           // per (depth, across)
  std::vector<float> transmission;  // per (depth, across, z): part that leaves the body; empty: all
  std::vector<float> buildup;       // the same: scattered photons; empty: none wanted
  std::vector<double> across_steps,
      along_steps;           // variance added behind depth b, in bins²; the first: before the camera
  double scatter_share = 0;  // per bin, of the next bin's scatter
};

struct ViewSettings {
  double angle_deg = 0, radius_mm = 0, voxel_mm = 1;
  const Columns* attenuation = nullptr;  // 1/mm
  const CameraResponse* response = nullptr;
  double scatter = 0, scatter_slope_per_mm = 0.012;
};
ViewModel make_view(int n, const ViewSettings& settings);

/// Adds the n × n bins (across slowest, z fastest) of the view to `bins`, and scattered photons to `scattered` (may be
/// empty).
void project_view(const ViewModel& view, const Columns& activity, std::span<float> bins, std::span<float> scattered);
/// Adds the adjoint (without scatter).
void back_project_view(const ViewModel& view, std::span<const float> bins, Columns& sum);

/// Adds variances (in bins²) to an n × n square, across its rows and along them. Symmetric, hence its own adjoint.
void widen_square(std::span<float> square, int n, double across, double along);

/// Bins as `project_view` has them, from and to rows along the patient with columns fastest.
std::vector<float> transposed(std::span<const float> square, int n);

}  // namespace dynasurf::synthetic
