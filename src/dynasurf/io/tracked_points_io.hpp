#pragma once
#include <filesystem>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/tracked_points.hpp"

namespace dynasurf::io {

/// Tracked points of a file and what there is to say about them.
struct TrackedFile {
  TrackedPoints points;
  Notes notes;  // "motion.points_left_out", "motion.no_count"
};

/// Reads a table with a row per point and gate. Its first line names the columns: point (any word), gate (from 1), and
/// x_mm, y_mm, z_mm (or x, y, z) in the world (LPS); others are skipped. Commas, semicolons or blanks stand between the
/// cells; lines that begin with # are comments. Points come in the order of their first row. One that is missing in a
/// gate is left out, with a note.
/// Strict: 2 to 1000 gates without a gap, at most 2000 points, finite coordinates of at most 100 m, every pair of
/// point and gate once, every row of the same length, and no fewer rows than a comment in front tells ("# 40 rows"); a
/// table without one that was cut at the end of a row cannot be told from a whole one, and a note says so. At most 2
/// GiB and 1 MiB a line; linear in the file. Throws InputError naming the file and the line; IoError.
TrackedFile read_tracked_points(const std::filesystem::path& file);

/// Writes such a table with the number of its rows in front, whole or not at all. Throws IoError.
void write_tracked_points(const TrackedPoints& points, const std::filesystem::path& file);

}  // namespace dynasurf::io
