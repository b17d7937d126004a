#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "dynasurf/core/grid.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"

namespace dynasurf::io::detail {

/// What a point record of LAS holds in each format.
struct LasFormat {
  static constexpr std::size_t none = 0;
  std::size_t bytes;
  std::size_t time;    // where 64 bits of the time of GPS stand
  std::size_t colour;  // where three 16-bit numbers stand
  bool has_waveform;
};

struct LasHeader {
  std::size_t points, begin, record;
  std::size_t header_bytes, extra_headers;  // where the variable headers begin, and how many they are
  LasFormat format;
  bool extended;     // formats 6 to 10, whose flags stand elsewhere
  bool is_infrared;  // formats 8 and 10
  bool compressed;
  Vec3 scale, offset;
};

/// A chunk of LAZ: points that are coded without a look at others.
struct LazChunk {
  std::string_view bytes;
  std::size_t points;
  char* to;  // the records of its points, of `LasFormat::bytes` each
};

/// The point records of a LAZ file as in LAS, without bytes beyond those of the format. What clouds have no use of
/// (intensity, time, angle, waveforms) may keep the value that it has in the first point of the chunk. Throws
/// InputError.
std::string unpack_laz(const MeshFile& file, const LasHeader& header);

/// Formats 0 to 3: all of a point, then all of the next. False: the bytes are none of this coder.
bool unpack_pointwise(const LazChunk& chunk, const LasHeader& header);

/// Formats 6 to 10: each property in a layer of its own. False: the bytes are none of this coder.
bool unpack_layered(const LazChunk& chunk, const LasHeader& header);

/// Sums that go round at 32 bits, as the coder's do.
inline std::int32_t sum_of(std::int32_t a, std::int32_t b) {
  return static_cast<std::int32_t>(static_cast<std::uint32_t>(static_cast<std::uint64_t>(std::int64_t{a} + b)));
}

/// The median of the last differences, of five at most, as LAZ takes it: one of the higher and one of the lower are
/// given up in turn.
class LazMedian {
 public:
  std::int32_t get() const { return sorted_[2]; }
  void add(std::int32_t value);

 private:
  std::array<std::int32_t, 5> sorted_{};
  bool gives_up_highest_ = true;
};

}  // namespace dynasurf::io::detail
