#include "dynasurf/io/cloud_io.hpp"

#include "input_files.hpp"
#include "target.hpp"

bool dynasurf::fuzz::run_tracks(std::string_view bytes) {
  InputFiles files;
  const auto path = files.add("a.csv", bytes);
  return reads(path.string(), [&] {
    const TrackedPoints points = io::read_tracked_points(path).points;
    for (const auto& gate : points.gates) require(gate.size() == points.name.size(), "every point is in every gate");
  });
}
