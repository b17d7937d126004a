#pragma once
#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/options.hpp"
#include "dynasurf/core/progress.hpp"
#include "dynasurf/field/detail/flow_result.hpp"

namespace dynasurf::field {

/// Gradient vector flow at rest near the borders alone. Voxels near a border are solved for; beyond, the field is
/// smooth, and coarser and coarser cells stand for it. Time and memory follow the area of the border, where those of
/// `SteadyGvf` follow the volume of the box.
struct BandGvf {
  static constexpr std::string_view name = "band";
  double mu = 0.2;
  double tolerance = 1e-3;
  int reach_voxels = 3;
  int most_cycles = 20;
};
void describe(auto& visit, BandGvf& o) {
  visit("mu", o.mu, OptionInfo{"balance: 0 keeps the gradient, large spreads it (thesis 3.36)", "", 1e-6, 1e4});
  visit("tolerance", o.tolerance,
        OptionInfo{"stop cycles below this relative distance from what they tend to", "", 1e-6, 0.1});
  visit("reach_voxels", o.reach_voxels,
        OptionInfo{"bricks of 8 voxels that come so near to a border are solved for", "voxels", 1, 64});
  visit("most_cycles", o.most_cycles, OptionInfo{"give up with a note after this many cycles", "", 1, 1000});
}

/// Generalised gradient vector flow at rest (see `SteadyGgvf`) near the borders alone.
struct BandGgvf {
  static constexpr std::string_view name = "band_ggvf";
  double k = 0.1;
  double tolerance = 1e-3;
  int reach_voxels = 3;
  int most_cycles = 20;
};
void describe(auto& visit, BandGgvf& o) {
  visit("k", o.k,
        OptionInfo{"K as a share of the largest gradient: small keeps weak gradients (thesis 3.42)", "", 0.01, 100});
  visit("tolerance", o.tolerance,
        OptionInfo{"stop cycles below this relative distance from what they tend to", "", 1e-6, 0.1});
  visit("reach_voxels", o.reach_voxels,
        OptionInfo{"bricks of 8 voxels that come so near to a border are solved for", "voxels", 1, 64});
  visit("most_cycles", o.most_cycles, OptionInfo{"give up with a note after this many cycles", "", 1, 1000});
}

/// A field on bricks of 8x8x8 cells near the borders and on coarser cells elsewhere. Holds at least one voxel.
class BandField {
 public:
  struct Levels;
  explicit BandField(std::shared_ptr<const Levels> levels);

  const Grid& grid() const;
  /// Field at a voxel, 1/mm along the axes of the grid; beyond the band, interpolated from coarser cells. The voxel
  /// must lie in the grid.
  Vec3 at(int i, int j, int k) const;
  bool is_in_band(int i, int j, int k) const;
  /// Largest length of a vector in the band.
  double largest() const;
  std::size_t voxels_in_band() const;
  std::size_t bytes() const;

 private:
  std::shared_ptr<const Levels> levels_;
};

/// Field at a point of the grid frame, as `sample` of a dense field reads it (FLD-SAMPLE).
Vec3 sample(const BandField& field, const Vec3& grid_mm, Sampling how, const Vec3& velocity = Vec3::Zero());

/// The field on every voxel: time and memory of the box.
VectorField dense_field(const BandField& field);

/// A field near borders, and how it was reached.
struct BandResult {
  BandField field;
  int cycles = 0;
  double error = 0;  // estimated relative distance in the band from what the cycles tend to
  Notes notes;       // "band.tolerance_missed"
};

/// The field of a map, equal spread in mm (the `metric` scheme). Differs from the field of `SteadyGvf` because cells
/// beyond the band are coarse: in the band by about 1e-3 with the default reach (docs/stages/field.md).
/// Looks at every voxel once. Same bytes for any number of threads. A constant map gives a zero field. Throws like
/// `SteadyGvf`.
BandResult band_field(const Image& edge_map, const BandGvf& options, const Progress& progress = {});
BandResult band_field(const Image& edge_map, const BandGgvf& options, const Progress& progress = {});

/// The same for a map that is 1 on `border` and 0 elsewhere, without ever holding the box. Throws InputError for a
/// voxel outside the grid.
BandResult band_field(const Grid& grid, std::span<const Index3> border, const BandGvf& options,
                      const Progress& progress = {});
BandResult band_field(const Grid& grid, std::span<const Index3> border, const BandGgvf& options,
                      const Progress& progress = {});

/// The field of a band on every voxel, for those who need them all.
FlowResult flow_field(const Image& edge_map, const BandGvf& options, const Progress& progress = {});
FlowResult flow_field(const Image& edge_map, const BandGgvf& options, const Progress& progress = {});

}  // namespace dynasurf::field
