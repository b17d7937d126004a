#pragma once
#include <array>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "dynasurf/core/volume.hpp"
#include "dynasurf/mesh/detail/ray_bvh.hpp"
#include "dynasurf/ventricle/measures/detail/heart_axes.hpp"
#include "dynasurf/ventricle/measures/detail/segments.hpp"
#include "dynasurf/ventricle/measures/detail/wall_thickness.hpp"

namespace dynasurf::ventricle {

/// Where a polar map is sampled: `rings` from apex to base, `sectors` counter-clockwise from the lateral wall, sample
/// (ring, sector) in the middle of its cell. Ring and sector borders fall on all borders of segments.
struct PolarGrid {
  int rings = 16, sectors = 48;
  std::size_t size() const { return size_of({sectors, rings, 1}); }
  std::size_t index(int ring, int sector) const { return index_in({sectors, rings, 1}, {sector, ring, 0}); }
  PolarPoint point(std::size_t index) const {
    const std::size_t ring = index / sectors;
    const std::size_t sector = index % sectors;
    return {(ring + 0.5) / rings, (sector + 0.5) * 360 / sectors};
  }
};

/// One value per sample, ring by ring from the apex; absent where the wall was not met.
using PolarValues = std::vector<std::optional<double>>;

/// What perfusion is made of: the largest counts in the wall, or the activity that was fitted with it. Limits of the
/// one do not hold for the other.
enum class Perfusion { none, counts, uptake };
inline std::span<const std::string_view> names_of(Perfusion) {
  static constexpr std::array<std::string_view, 3> names{"none", "counts", "uptake"};
  return names;
}

/// The wall of one gate seen along the rays of its frame.
struct WallMap {
  PolarGrid grid;
  std::vector<std::optional<Vec3>> endo, epi;  // where the rays meet the surfaces, world
  std::vector<Vec3> outwards;                  // directions of the rays
  PolarValues counts;            // largest value of the image between the surfaces (cubic interpolation); within 6
                                 // mm of the valve plane that of the ring below
  PolarValues uptake;            // of the wall, mean of both surfaces; absent where it is not known
  PolarValues thickness_mm;      // of the nearest vertices of both surfaces, by their rays
  std::vector<double> area_mm2;  // of the middle of the wall for each sample; 0 where it was not met
};

/// The activity of the wall at the vertices of both surfaces, where it is known better than from the image.
struct WallUptake {
  const std::vector<double>*endo = nullptr, *epi = nullptr;
};
/// `image` may be on any grid of the world. Samples whose rays miss a surface, or meet its lid, are absent.
WallMap map_wall(const mesh::TracedSurface& endo, const mesh::TracedSurface& epi, const WallUptake& uptake,
                 const WallThickness& thickness, const HeartAxes& axes, const Image& image, const PolarGrid& grid = {});

/// The same of a cavity whose outer wall is not seen: where the rays meet its surface, and nothing of a wall. Areas are
/// those of the surface.
WallMap map_cavity(const mesh::TracedSurface& endo, const HeartAxes& axes, const PolarGrid& grid = {});

/// Mean of the values of each segment (entry 0: segment 1), weighted by `weight`; absent where no sample has a value.
PolarValues segment_means(SegmentModel model, const PolarGrid& grid, const PolarValues& values,
                          const std::vector<double>& weight);

/// Values of the vertices of one surface from a map, bilinear between samples, for drawing. Vertices of segment 0 (the
/// lid) and those beside absent samples only are absent.
PolarValues on_vertices(const PolarGrid& grid, const PolarValues& values, const HeartAxes& axes,
                        const std::vector<Vec3>& vertices);

}  // namespace dynasurf::ventricle
