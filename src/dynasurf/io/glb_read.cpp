#include "dynasurf/io/detail/glb_read.hpp"

#include <algorithm>
#include <array>
#include <cstring>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/gltf_scene.hpp"
#include "dynasurf/io/detail/json_read.hpp"
#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/mesh_io.hpp"

namespace dynasurf::io {
namespace detail {
namespace {

/// The format counts bytes in 32 bits. Sums and products of two such numbers do not leave 64.
constexpr std::int64_t max_bytes = std::int64_t{1} << 32;

[[noreturn]] void refuse(const std::string& name, const std::string& what) { throw InputError(name + ": " + what); }

/// Takes the next chunk off the front of `left`.
std::string_view next_chunk(std::string_view& left, std::uint32_t kind, const std::string& name, const char* what) {
  if (left.size() < 8) refuse(name, std::string("ends before its ") + what + " chunk; expected a binary glTF");
  const std::size_t length = load<std::uint32_t>(left.data());
  if (load<std::uint32_t>(left.data() + 4) != kind)
    refuse(name, std::string("has another chunk where its ") + what + " chunk belongs; expected a binary glTF");
  left.remove_prefix(8);
  if (length > left.size() || length % 4 != 0)
    refuse(name, std::string("its ") + what + " chunk says it holds " + std::to_string(length) +
                     " bytes; expected a multiple of 4, at most the " + std::to_string(left.size()) + " that follow");
  const std::string_view chunk = left.substr(0, length);
  left.remove_prefix(length);
  return chunk;
}

std::int64_t offset_in(const JsonNode& node) {
  return has(node, "byteOffset") ? whole_in(node, "byteOffset", 0, max_bytes) : 0;
}

/// A file that was handed on must not make this machine open others, a pipe or a device among them.
void refuse_other_files(const JsonNode& document) {
  for (const char* key : {"buffers", "images"}) {
    if (!has(document, key)) continue;
    const JsonNode list = list_in(document, key);
    for (std::size_t n = 0; n < size_of(list); ++n)
      if (const JsonNode item = object_of(list, n); has(item, "uri"))
        refuse(item.file, item.path + ": names another file (uri); expected all bytes in the file itself");
  }
}

/// The buffer without the bytes that fill its chunk up to a multiple of four.
std::string_view buffer_of(const JsonNode& document, std::string_view chunk) {
  const JsonNode buffers = list_in(document, "buffers");
  if (size_of(buffers) != 1) refuse_value(buffers, "a list of 1");
  const std::int64_t most = chunk.size();
  const auto length = whole_in(object_of(buffers, 0), "byteLength", std::max<std::int64_t>(most - 3, 0), most);
  return chunk.substr(0, length);
}

/// The bytes of an accessor whose rows are `row_bytes` long.
std::string_view block_of(GlbFile& glb, std::int64_t accessor, const char* type, int component,
                          std::int64_t row_bytes) {
  const JsonNode a = item_of_document(glb, "accessors", accessor);
  glb.is_block_read.resize(std::max(glb.is_block_read.size(), static_cast<std::size_t>(accessor) + 1));
  if (glb.is_block_read[accessor])
    refuse(glb.name, a.path + ": is used twice; expected numbers of its own for each use");
  glb.is_block_read[accessor] = true;
  if (has(a, "sparse")) refuse(glb.name, a.path + ".sparse: expected plain numbers");
  if (text_in(a, "type") != type) refuse(glb.name, a.path + ".type: expected " + type);
  whole_in(a, "componentType", component, component);
  const std::int64_t count = whole_in(a, "count", 1, max_bytes), offset = offset_in(a);
  const JsonNode view = item_of_document(glb, "bufferViews", whole_in(a, "bufferView", 0, max_bytes));
  whole_in(view, "buffer", 0, 0);
  if (has(view, "byteStride")) refuse(glb.name, view.path + ".byteStride: expected numbers without gaps");
  const std::int64_t begin = offset_in(view), length = whole_in(view, "byteLength", 1, max_bytes);
  const std::int64_t held = glb.binary.size();
  if (begin + length > held)
    refuse(glb.name, view.path + ": ends at byte " + std::to_string(begin + length) + " of its buffer; expected " +
                         std::to_string(held) + " at most");
  if (offset + count * row_bytes > length)
    refuse(glb.name, a.path + ": ends at byte " + std::to_string(offset + count * row_bytes) +
                         " of its view; expected " + std::to_string(length) + " at most");
  // glTF aligns accessors to the size of their components, which is 4 here.
  if ((begin + offset) % 4 != 0)
    refuse(glb.name, a.path + ": begins at byte " + std::to_string(begin + offset) + "; expected a multiple of 4");
  return glb.binary.substr(begin + offset, count * row_bytes);
}

/// Precondition: the block is not empty.
template <class Number>
std::vector<Number> numbers_from(std::string_view block) {
  std::vector<Number> numbers(block.size() / sizeof(Number));
  std::memcpy(numbers.data(), block.data(), block.size());
  return numbers;
}

std::vector<Vec3> places_of(GlbFile& glb, const JsonNode& attributes, const Vec3& middle) {
  const std::int64_t accessor = whole_in(attributes, "POSITION", 0, max_bytes);
  const std::vector<float> numbers = rows_of_three(glb, accessor);
  std::vector<Vec3> places;
  places.reserve(numbers.size() / 3);
  for (std::size_t i = 0; i < numbers.size(); i += 3) {
    places.push_back(Eigen::Vector3f(numbers[i], numbers[i + 1], numbers[i + 2]).cast<double>() + middle);
    if (!places.back().allFinite())
      refuse(glb.name, "accessors[" + std::to_string(accessor) + "]: vertex " + std::to_string(i / 3) +
                           " is not finite; expected a place");
  }
  return places;
}

std::vector<std::array<std::uint32_t, 3>> triangles_of(GlbFile& glb, const JsonNode& primitive, std::size_t vertices) {
  const std::int64_t accessor = whole_in(primitive, "indices", 0, max_bytes);
  const std::string where = "accessors[" + std::to_string(accessor) + "]: ";
  const std::vector<std::uint32_t> corners = indices_of(glb, accessor);
  if (corners.size() % 3 != 0)
    refuse(glb.name, where + std::to_string(corners.size()) + " corners; expected three for each triangle");
  std::vector<std::array<std::uint32_t, 3>> triangles;
  triangles.reserve(corners.size() / 3);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    triangles.push_back({corners[i], corners[i + 1], corners[i + 2]});
    for (const std::uint32_t v : triangles.back())
      if (v >= vertices)
        refuse(glb.name, where + "triangle " + std::to_string(i / 3) + " uses vertex " + std::to_string(v) + " of " +
                             std::to_string(vertices));
  }
  return triangles;
}

LodSurface level_of(GlbFile& glb, const JsonNode& node) {
  LodSurface level;
  level.name = text_in(node, "name");
  const std::vector<double> middle = numbers_in(node, "translation");
  if (middle.size() != 3) refuse(glb.name, node.path + ".translation: expected three numbers");
  const JsonNode mesh = item_of_document(glb, "meshes", whole_in(node, "mesh", 0, max_bytes));
  const JsonNode primitives = list_in(mesh, "primitives");
  if (size_of(primitives) != 1) refuse_value(primitives, "a list of 1");
  const JsonNode primitive = object_of(primitives, 0), attributes = object_in(primitive, "attributes");
  if (has(attributes, "TEXCOORD_0"))
    refuse(glb.name, node.path + ": is textured, and its triangles share no vertices; expected plain ones");
  if (has(primitive, "mode")) whole_in(primitive, "mode", gltf::triangles, gltf::triangles);
  level.mesh.vertices = places_of(glb, attributes, Vec3(middle[0], middle[1], middle[2]));
  level.mesh.triangles = triangles_of(glb, primitive, level.mesh.vertices.size());
  return level;
}

}  // namespace

GlbFile open_glb(std::string_view bytes, const std::string& name) {
  if (bytes.size() < 12 || load<std::uint32_t>(bytes.data()) != gltf::glb_magic ||
      load<std::uint32_t>(bytes.data() + 4) != gltf::glb_version)
    refuse(name, "is no binary glTF 2.0");
  if (const std::size_t length = load<std::uint32_t>(bytes.data() + 8); length != bytes.size())
    refuse(name, "holds " + std::to_string(bytes.size()) + " bytes; expected " + std::to_string(length) +
                     ", as its header says");
  std::string_view left = bytes.substr(12);
  GlbFile glb{name, {}, {}, {}};
  glb.document = parse_json(next_chunk(left, gltf::json_chunk, name, "JSON"), name);
  const std::string_view chunk = next_chunk(left, gltf::binary_chunk, name, "binary");
  if (!left.empty()) refuse(name, std::to_string(left.size()) + " bytes follow its two chunks; expected none");
  const JsonNode document = root_of(glb.document, name);
  refuse_other_files(document);
  glb.binary = buffer_of(document, chunk);
  return glb;
}

JsonNode item_of_document(const GlbFile& glb, std::string_view list, std::int64_t n) {
  const JsonNode items = list_in(root_of(glb.document, glb.name), list);
  if (n < 0 || static_cast<std::size_t>(n) >= size_of(items))
    refuse(glb.name, items.path + ": item " + std::to_string(n) + " is asked for; there are " +
                         std::to_string(size_of(items)) + ", counted from 0");
  return object_of(items, n);
}

std::vector<float> rows_of_three(GlbFile& glb, std::int64_t accessor) {
  return numbers_from<float>(block_of(glb, accessor, "VEC3", gltf::float_32, 3 * sizeof(float)));
}

std::vector<std::uint32_t> indices_of(GlbFile& glb, std::int64_t accessor) {
  return numbers_from<std::uint32_t>(block_of(glb, accessor, "SCALAR", gltf::unsigned_int, sizeof(std::uint32_t)));
}

std::vector<LodSurface> decode_lod_glb(const MeshFile& file) {
  GlbFile glb = open_glb(file.bytes, file.name);
  const JsonNode nodes = list_in(root_of(glb.document, glb.name), "nodes");
  if (size_of(nodes) == 0) refuse_value(nodes, "a level at least");
  std::vector<LodSurface> levels;
  for (std::size_t n = 0; n < size_of(nodes); ++n) levels.push_back(level_of(glb, object_of(nodes, n)));
  return levels;
}

}  // namespace detail

std::vector<LodSurface> read_lod_glb(const std::filesystem::path& path) {
  const std::string bytes = detail::read_whole(path, "levels of detail");
  return detail::decode_lod_glb({path.string(), bytes});
}

}  // namespace dynasurf::io
