#include "dynasurf/io/detail/gzip.hpp"

#include <algorithm>
#include <array>

#include <zlib.h>

#include "dynasurf/core/error.hpp"

namespace dynasurf::io {

std::string gzip(std::string_view content) {
  z_stream packer{};
  if (deflateInit2(&packer, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    throw IoError("zlib has no memory to pack a file");
  std::string packed;
  std::array<char, 1 << 16> block;
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    const auto n = static_cast<uInt>(std::min<std::size_t>(content.size(), 1u << 30));
    packer.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
    packer.avail_in = n;
    packer.next_out = reinterpret_cast<Bytef*>(block.data());
    packer.avail_out = static_cast<uInt>(block.size());
    status = deflate(&packer, n == content.size() ? Z_FINISH : Z_NO_FLUSH);
    content.remove_prefix(n - packer.avail_in);
    packed.append(block.data(), block.size() - packer.avail_out);
  }
  deflateEnd(&packer);
  return packed;
}

}  // namespace dynasurf::io
