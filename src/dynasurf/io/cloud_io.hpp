#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "dynasurf/core/note.hpp"
#include "dynasurf/core/point_cloud.hpp"
#include "dynasurf/io/detail/mesh_parts.hpp"

namespace dynasurf::io {

/// One or more files as one cloud.
struct CloudInput {
  PointCloud cloud;
  std::vector<CloudSource> sources;  // one per file
  Notes notes;  // "read.sampled", "read.normals_dropped", "read.colours_dropped", "read.left_out", "read.scans",
                // "read.no_count"
};

/// Reads clouds, told by the name's ending:
///
/// * PLY (ascii, binary of both byte orders): `vertex` with x, y, z; nx, ny, nz; red, green, blue; scan;
/// * XYZ, TXT, ASC, PTS, CSV: rows of numbers between blanks, commas or semicolons. A first line may name the columns
///   (x y z nx ny nz red green blue scan, or Points:0 and so on as ParaView has them; others are skipped). Without
///   names: 3 coordinates; 4: and an intensity; 6: and a unit normal or a colour of 0 to 255, whichever the first 1000
///   rows are; 7: intensity and either; 9: both; 10: intensity and both. A lone number counts the points that follow,
///   and each such block is a scan. PWN: 6 columns, the last three a normal of any length;
/// * OBJ, OFF: vertices, with normals and colours where each vertex has them;
/// * PCD; PTX and E57: scans brought to one frame, without places that hold no valid point; E57 with its checksums;
/// * LAS and LAZ 1.0 to 1.4: points that are not withheld or noise, with colours; a scan per source;
/// * STL, and PLY, OBJ, OFF with faces: a surface. It is sampled evenly by area to `points_of_a_surface` points, the
///   vertices of its triangles first, with the normals of its triangles where they are oriented alike.
///
/// Coordinates that are not finite are kept: scanners write them where they saw nothing. Normals are kept when every
/// finite point of every file has one that is finite and not 0, colours when every file has them; else a note tells.
/// Several files, or several scans in a file, are numbered in `scans`, from 0 in the order of appearance. Where a scan
/// was taken from is read from E57 (its pose, unless that of all is none; the middle of angles), PTX (the registered
/// position, or the middle of the grid's frame where that is 0) and PCD (VIEWPOINT, unless it is that of none).
/// Strict: cut short, longer or shorter than declared, a value that is no number: all refused, also when comments in
/// front tell of more ("# Vertices: 35947", "# 500 points"). Where neither the format nor a comment tells (XYZ, TXT,
/// ASC, CSV, PWN, OBJ), a cut at the end of a row cannot be seen, and the note "read.no_count" says so; nor can a PTS
/// be told that was cut between two scans, or an ascii STL between two solids. Time is linear in the file (times the
/// logarithm of the scans). At most 2 GiB a file, 100 million points, 1 MiB a line, 1024 properties and 256 elements of
/// a PLY; what a header declares must fit the limit of memory, at 200 bytes a point, before rows are read. Throws
/// InputError naming the file and the line or byte, also for a file without points; IoError.
CloudInput read_cloud(std::span<const std::filesystem::path> files);

/// Writes binary PLY with doubles for the points, floats for normals, bytes for colours, integers for scans, of what
/// the cloud has. Whole or not at all. Throws InputError for an empty cloud or arrays of different lengths, IoError.
void write_cloud(const PointCloud& cloud, const std::filesystem::path& path);

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
