#pragma once
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "dynasurf/io/detail/json_node.hpp"

namespace dynasurf::io::detail {

/// A binary glTF that was taken apart. Nothing but its own bytes is ever read: a buffer or a picture that names a file
/// is refused, whatever the name.
struct GlbFile {
  std::string name;
  nlohmann::ordered_json document;
  std::string_view binary;          // the buffer; points into the bytes that were given
  std::vector<bool> is_block_read;  // of each accessor
};

/// Checks the container, its two chunks and what the document says of the buffer. Throws InputError.
GlbFile open_glb(std::string_view bytes, const std::string& name);

/// The numbers of an accessor, row by row. Each accessor may be read once: a short file must not name the same numbers
/// a thousand times. Throws InputError for another type or component type, for sparse and interleaved numbers, and for
/// whatever does not lie within its view and the buffer.
std::vector<float> rows_of_three(GlbFile& glb, std::int64_t accessor);
std::vector<std::uint32_t> indices_of(GlbFile& glb, std::int64_t accessor);

/// The item of a list of the document. Throws InputError for a list that is not there, or not that long.
JsonNode item_of_document(const GlbFile& glb, std::string_view list, std::int64_t n);

}  // namespace dynasurf::io::detail
