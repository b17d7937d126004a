#include "dynasurf/report/detail/page_parts.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include <zlib.h>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf::report::detail {
namespace {

constexpr double position_steps = 65535;
// Of zlib: a fifth of the time of its default 6 for pictures, and pages that are 1 % larger.
constexpr int packing_level = 4;
constexpr std::size_t piece_bytes = std::size_t{1} << 18;

/// The bytes from `begin` to `end` as deflated blocks (RFC 1951), the last of them marked where the bytes end.
Bytes deflated(const Bytes& bytes, std::size_t begin, std::size_t end) {
  constexpr int window_bits = 15, memory_level = 8;  // zlib's own; negative: without a header
  constexpr std::size_t window = std::size_t{1} << window_bits;
  z_stream stream{};
  const auto fail = [&] {
    throw IoError("report: not enough memory to pack " + std::to_string(bytes.size()) + " bytes");
  };
  if (deflateInit2(&stream, packing_level, Z_DEFLATED, -window_bits, memory_level, Z_DEFAULT_STRATEGY) != Z_OK) fail();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> owner(&stream, deflateEnd);
  const std::size_t before = std::min(begin, window);
  if (before > 0) deflateSetDictionary(&stream, bytes.data() + begin - before, before);
  constexpr std::size_t flush_bytes = 16;
  Bytes out(deflateBound(&stream, end - begin) + flush_bytes);
  stream.next_in = const_cast<Bytef*>(bytes.data() + begin);  // zlib's declaration; it only reads
  stream.avail_in = end - begin;
  stream.next_out = out.data();
  stream.avail_out = out.size();
  const bool is_last = end == bytes.size();
  if (deflate(&stream, is_last ? Z_FINISH : Z_SYNC_FLUSH) != (is_last ? Z_STREAM_END : Z_OK)) fail();
  out.resize(stream.total_out);
  return out;
}

}  // namespace

// The data stand in a script element, which "</script" or "<!--" would end or change: no < remains. All else beyond
// ASCII is escaped too, so that the encoding of the page does not matter.
std::string text_for_html(const Json& json) {
  std::string text;
  for (const char c : json.dump(-1, ' ', true, Json::error_handler_t::replace))
    if (c == '<')
      text += "\\u003c";
    else
      text += c;
  return text;
}

std::string base64(const Bytes& bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t left = std::min<std::size_t>(3, bytes.size() - i);
    std::uint32_t word = 0;
    for (std::size_t b = 0; b < 3; ++b) word = word << 8 | (b < left ? bytes[i + b] : 0u);
    for (std::size_t d = 0; d < 4; ++d) text += d <= left ? digits[word >> (18 - 6 * d) & 63u] : '=';
  }
  return text;
}

// A zlib stream (RFC 1950) of pieces of one length, so that it is the same for any number of threads: all but the last
// end at a whole byte, and copies reach back beyond their start.
std::string packed(const Bytes& bytes) {
  const std::size_t count = std::max<std::size_t>(1, (bytes.size() + piece_bytes - 1) / piece_bytes);
  std::vector<Bytes> pieces(count);
  std::vector<uLong> sums(count);
  parallel_for(count, 1, [&](std::size_t n, std::size_t) {
    const std::size_t begin = n * piece_bytes, end = std::min(bytes.size(), begin + piece_bytes);
    pieces[n] = deflated(bytes, begin, end);
    sums[n] = adler32(adler32(0, nullptr, 0), bytes.data() + begin, end - begin);
  });
  Bytes out{0x78, 0x5e};
  uLong sum = sums.front();
  for (std::size_t n = 0; n < count; ++n) {
    out.insert(out.end(), pieces[n].begin(), pieces[n].end());
    if (n > 0) sum = adler32_combine(sum, sums[n], std::min(bytes.size() - n * piece_bytes, piece_bytes));
  }
  for (const unsigned shift : {24u, 16u, 8u, 0u}) out.push_back(sum >> shift & 255u);
  return base64(out);
}

Bytes steps_of(const std::vector<Vec3>& points, const Box& box) {
  Bytes bytes;
  bytes.reserve(points.size() * 6);
  for (const Vec3& p : points)
    for (int axis = 0; axis < 3; ++axis) {
      const double side = box.high[axis] - box.low[axis];
      const double share = side > 0 ? (p[axis] - box.low[axis]) / side : 0;
      append<std::uint16_t>(bytes, std::clamp(std::round(share * position_steps), 0.0, position_steps));
    }
  return bytes;
}

std::string triangles_of(const TriMesh& mesh) {
  Bytes bytes;
  bytes.reserve(mesh.triangles.size() * 12);
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) append(bytes, vertex);
  return packed(bytes);
}

Json transition_json(const cloud::LodTransition& transition, const Box& box) {
  Bytes cuts;
  for (const auto& cut : transition.cuts)
    for (const std::uint32_t vertex : cut) append(cuts, vertex);
  return {{"cuts", packed(cuts)},
          {"triangles", triangles_of(transition.fine)},
          {"start", packed(steps_of(transition.start, box))}};
}

std::string filled_page(std::string_view page, const Json& data) {
  constexpr std::string_view place = "{{DATA}}";
  const std::size_t at = page.find(place);
  DYNASURF_ASSERT(at != std::string_view::npos);
  std::string html(page.substr(0, at));
  html += text_for_html(data);
  html += page.substr(at + place.size());
  return html;
}

}  // namespace dynasurf::report::detail
