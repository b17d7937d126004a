#pragma once
#include <cstdint>

#include "dynasurf/image/detail/slice.hpp"
#include "dynasurf/image/edges.hpp"

// From a strength per pixel to lines of one pixel: the later half of the detectors that thin their edges.

namespace dynasurf::image {

constexpr std::uint8_t minor_edge = 1, major_edge = 2;

/// Where the ridge through a pixel lies, px from its centre.
struct RidgeOffset {
  float x = 0, y = 0;
};

/// True when the strength of (i, j) is greater than one pixel along (x, y) and not smaller than one pixel against it,
/// both read between the two nearest of the eight neighbours. Of a plateau the pixel on the side that (x, y) points to
/// stays: the rule follows the vector, not the axes, so a turned image gives the turned ridges. A zero vector has no
/// ridge.
bool is_ridge(const Slice& strength, int i, int j, float x, float y);

/// Vertex of the parabola through the strengths along (x, y), at most half a step from the centre; 0 where the
/// strength has no maximum in between.
RidgeOffset ridge_offset(const Slice& strength, int i, int j, float x, float y);

/// The strengths with everything but their ridges across `across` set to 0.
Slice thin(const Slice& strength, const SliceVectors& across);

/// Marks as major edges in slice k the ridges that reach `high`, and those that reach `low` and hang on them
/// (8 neighbours).
void trace(const Slice& ridges, float low, float high, Mask& edges, int k);

/// Largest value of an image without negative ones; 0 for an empty one.
float largest_of(const Image& image);

/// Throws InputError unless all values are finite.
void require_finite(const Image& image);

/// Throws OptionError unless low <= high.
void require_order(double low, double high, const char* method);

/// Adds "edges.flat" when the strength is 0 everywhere.
void note_flat(EdgeMap& map);

/// Fills `map.offsets` for the edge pixels of slice k from their ridges; `map.offsets` is there and 0.
void put_offsets(const Slice& strength, const SliceVectors& across, EdgeMap& map, int k);

}  // namespace dynasurf::image
