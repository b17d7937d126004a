#include "dynasurf/report/detail/page_parts.hpp"

#include <algorithm>
#include <cmath>

#include <zlib.h>

#include "dynasurf/cloud/lod.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::report::detail {
namespace {

constexpr double position_steps = 65535;
// Of zlib: a fifth of the time of its default 6 for pictures, and pages that are 1 % larger.
constexpr int packing_level = 4;

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

std::string packed(const Bytes& bytes) {
  uLongf size = compressBound(bytes.size());
  Bytes out(size);
  if (compress2(out.data(), &size, bytes.data(), bytes.size(), packing_level) != Z_OK)
    throw IoError("report: not enough memory to pack " + std::to_string(bytes.size()) + " bytes");
  out.resize(size);
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
