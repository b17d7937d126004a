#pragma once
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/core/detail/rounding.hpp"
#include "dynasurf/core/tri_mesh.hpp"

namespace dynasurf::cloud {
struct LodTransition;
}

// How data get into a page: bytes as text, meshes as bytes.
namespace dynasurf::report::detail {

using Json = nlohmann::ordered_json;
using Bytes = std::vector<std::uint8_t>;

std::string base64(const Bytes& bytes);
/// Packed in zlib's format, which browsers call "deflate", as base64.
std::string packed(const Bytes& bytes);

/// Little-endian bytes of whole numbers.
template <class T>
void append(Bytes& bytes, T value) {
  for (std::size_t b = 0; b < sizeof(T); ++b) bytes.push_back(value >> (8 * b) & 0xff);
}

/// Box around every surface, so that all meshes share one scale.
struct Box {
  Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 high = -low;
};

/// World positions as 16-bit steps of the box: finer than 5 micrometres in a box of 30 cm. Three numbers a point.
Bytes steps_of(const std::vector<Vec3>& points, const Box& box);
/// Vertex indices, 32 bits each.
std::string triangles_of(const TriMesh& mesh);

/// How a level grows out of the next: where its vertices start, and how its triangles are cut for that.
Json transition_json(const cloud::LodTransition& transition, const Box& box);

/// JSON that may stand inside an HTML script element: no text in it can end the element or open a comment.
std::string text_for_html(const Json& json);

/// The page with its one {{DATA}} replaced by the JSON, which cannot end the element it stands in.
std::string filled_page(std::string_view page, const Json& data);

}  // namespace dynasurf::report::detail
