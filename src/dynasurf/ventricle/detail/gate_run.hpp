#pragma once
#include <array>
#include <mutex>
#include <optional>
#include <vector>

#include "dynasurf/core/detail/stage_clock.hpp"
#include "dynasurf/ventricle/options.hpp"
#include "dynasurf/ventricle/result.hpp"

// What the stages of `reconstruct` hand on from one to the next.
namespace dynasurf::ventricle {

inline constexpr std::array<Border, 2> walls{Border::endo, Border::epi};

/// Counts finished pieces of work from several threads and tells the user, one call at a time.
class StageCounter {
 public:
  StageCounter(const Progress& progress, std::string_view stage, int total)
      : progress_(progress), stage_(stage), total_(total) {}
  void advance() {
    const std::lock_guard lock(mutex_);
    progress_(stage_, ++done_, total_);
  }

 private:
  const Progress& progress_;
  std::string_view stage_;
  int total_, done_ = 0;
  std::mutex mutex_;
};

/// What one wall of one gate passes through on its way from a border to a surface.
struct WallRun {
  Image border;
  dynamics::BorderPlanes planes;
  Image edge_map;  // of pipeline direct
  mesh::Placement placement;
  TriMesh start;  // grid frame; empty for pipeline contour
  field::FlowResult flow;
  dynamics::EvolutionResult evolved;
  std::optional<Surface> surface;
  std::optional<mesh::StackVolumes> stack;  // of pipeline contour
  std::optional<WallContours> contours;     // likewise
  std::optional<TriMesh> settled;
  bool exists() const { return !border.values.empty(); }
};

/// What one gate passes through.
struct GateRun {
  image::EdgeMap edges;
  Labels labels;
  int base_slice = -1;
  std::optional<heart::BasePlane> base_plane;
  WallRun endo, epi;
  Notes notes;
  WallRun& wall(Border w) { return w == Border::endo ? endo : epi; }
};

/// The drag of every voxel around a wall, kg/s; absent where it is the same everywhere.
std::optional<Image> drag_of(const WallRun& run, const Image& image, const dynamics::Evolution& evolution);

/// The field of a wall that has a border; contours have none.
void make_field(WallRun& run, const Options& options, const Progress& progress, StageClock& clock);

/// The surface of every wall that has a border: by contours, or by a mesh that moves, from a start of its own (`start`,
/// else the start that the options ask for) or from the surface of the gate before.
void find_surfaces(std::vector<GateRun>& runs, const Study& study, const Options& options, const TriMesh* start,
                   const Progress& progress, StageClock& clock);

/// Lets the surfaces settle on the slope of the image where the options ask for it, and measures them.
void measure_surfaces(std::vector<GateRun>& runs, const Study& study, const Options& options, StageClock& clock);

}  // namespace dynasurf::ventricle
