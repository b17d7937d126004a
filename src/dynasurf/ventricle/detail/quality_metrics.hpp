#pragma once
#include <span>

#include "dynasurf/core/volume.hpp"
#include "dynasurf/heart/detail/lv_shell.hpp"

namespace dynasurf::ventricle {

struct Result;

/// Numbers of a finished study that tell right results from wrong ones; `assess` compares them with limits. A number
/// whose data are missing has the value of a good result.
/// Where no wall is seen (a share `m` of the directions) a surface bridges the hole. A bridge that is off by a third of
/// the wall's apparent thickness `t` moves the volume of a ball of radius `r` by the share 3 m (t/3) / r: `bridged`.
struct QualityMetrics {
  double hot_neighbour = 0;  // share of the directions in which something as hot as the wall touches it
  double noise = 0;          // of a point of the wall from gate to gate, relative to the wall
  double bridged = 0;        // of the largest cavity: what surfaces may err by where no wall is seen, see below
  double unround = 0;        // spread of the outer surface's radius around the axis, relative to it; the worst gate
  // How far the middle of a gate's counts around the heart, and of its outer surface between edges, lies from where the
  // smooth beat has it; the worst gate.
  double counts_move_mm = 0, surface_moves_mm = 0;
  double thickness_mm = 12;  // between the two surfaces, mean of the gates
  double least_counts = 1;   // of a gate around the heart, relative to the usual gate
  double most_counts = 1;
  double endo_roughness = 0;  // of the volume curves, as `cycle_roughness`
  double epi_roughness = 0;
  double length_to_width = 1.3;  // of the outer surface: of the ellipsoid of its length and volume; mean of the gates
  double readings_apart = 0;     // points of ejection fraction: `gaussian_profile` over the edges, either way
  double end_systole = 0.4;      // part of the beat that has passed
  double base_seen = 1, base_spread_mm = 0, base_cut = 0;
};
QualityMetrics quality_metrics(const Result& result);

/// Share of the directions in which the image, beyond the wall of the cup, gets as bright as the wall without having
/// fallen much in between. Grid frame.
double hot_neighbour_share(const Image& image, const heart::LvShell& cup);

/// How much a point of the wall differs from its own smooth course over the beat, relative to the wall's brightness.
/// 0 for fewer than 8 gates.
double noise_of_wall(std::span<const Image> gates, const heart::LvShell& cup);

}  // namespace dynasurf::ventricle
