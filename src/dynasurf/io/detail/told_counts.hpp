#pragma once
#include <cstddef>
#include <optional>

#include "dynasurf/io/detail/mesh_formats.hpp"

namespace dynasurf::io::detail {

/// What the comments in front of the first row of a text tell of how much follows. Formats without counts of their own
/// (OBJ, XYZ, tables) can be told from a file that was cut at the end of a line by nothing else.
struct ToldCounts {
  std::optional<std::size_t> points, faces, rows;
};

/// Looks for comments (# or //) such as "# Vertices: 35947", "# 8 vertices, 12 faces", "# number of points = 500",
/// "# 40 rows". A comment that says anything else beside is not understood as a count.
ToldCounts told_counts(const MeshFile& file);

/// Throws InputError when there are fewer than were told. More are no sign of a cut.
void require_told(const MeshFile& file, const std::optional<std::size_t>& told, std::size_t found, const char* what);

}  // namespace dynasurf::io::detail
