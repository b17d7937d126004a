#include <gtest/gtest.h>
#include <zlib.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/png.hpp"

namespace dynasurf::io {
namespace {

struct Chunk {
  std::string name, content;
};

std::uint32_t number_at(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t n = 0; n < 4; ++n) value = value << 8 | static_cast<unsigned char>(bytes[at + n]);
  return value;
}

/// Every chunk, its sum checked.
std::vector<Chunk> chunks_of(const std::string& file) {
  std::vector<Chunk> chunks;
  for (std::size_t at = 8; at < file.size();) {
    const std::size_t length = number_at(file, at);
    const std::string summed = file.substr(at + 4, 4 + length);
    EXPECT_EQ(number_at(file, at + 8 + length),
              crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size())));
    chunks.push_back({summed.substr(0, 4), summed.substr(4)});
    at += 12 + length;
  }
  return chunks;
}

std::string inflated(const std::string& packed, std::size_t bytes) {
  std::string text(bytes, '\0');
  auto length = static_cast<uLongf>(bytes);
  EXPECT_EQ(uncompress(reinterpret_cast<Bytef*>(text.data()), &length, reinterpret_cast<const Bytef*>(packed.data()),
                       static_cast<uLong>(packed.size())),
            Z_OK);
  EXPECT_EQ(length, bytes);
  return text;
}

TEST(Animation, HoldsEveryPictureAsThePngSpecificationSays) {
  const std::vector<Picture> pictures{Picture(3, 2, {255, 0, 0}), Picture(3, 2, {0, 255, 0}),
                                      Picture(3, 2, {0, 0, 255})};
  const std::vector<Chunk> chunks = chunks_of(encode_animation(pictures, 80));
  ASSERT_GE(chunks.size(), 8u);
  EXPECT_EQ(chunks.front().name, "IHDR");
  EXPECT_EQ(chunks.back().name, "IEND");
  std::uint32_t next = 0, frames = 0;
  std::string data;
  std::vector<std::string> packed;
  for (const Chunk& chunk : chunks) {
    if (chunk.name == "acTL") {
      EXPECT_EQ(number_at(chunk.content, 0), 3u);
      EXPECT_EQ(number_at(chunk.content, 4), 0u) << "repeats for ever";
      EXPECT_TRUE(packed.empty()) << "acTL comes before the data";
    }
    if (chunk.name == "fcTL") {
      EXPECT_EQ(number_at(chunk.content, 0), next++);
      EXPECT_EQ(number_at(chunk.content, 4), 3u);
      EXPECT_EQ(number_at(chunk.content, 8), 2u);
      EXPECT_EQ(number_at(chunk.content, 20), 80u << 16 | 1000u);
      EXPECT_EQ(chunk.content.size(), 26u);
      packed.emplace_back();
      ++frames;
    }
    if (chunk.name == "IDAT") packed.at(0) += chunk.content;
    if (chunk.name == "fdAT") {
      EXPECT_EQ(number_at(chunk.content, 0), next++);
      packed.back() += chunk.content.substr(4);
    }
  }
  EXPECT_EQ(frames, 3u);
  ASSERT_EQ(packed.size(), 3u);
  // Two rows, each a filter's byte and three pixels. With one colour the filter leaves the first pixel as it is in the
  // first row.
  for (std::size_t n = 0; n < 3; ++n) {
    const std::string rows = inflated(packed[n], 2 * (1 + 3 * 3));
    for (std::size_t c = 0; c < 3; ++c) EXPECT_EQ(static_cast<unsigned char>(rows[1 + c]), c == n ? 255 : 0) << n;
  }
}

TEST(Animation, RefusesWhatIsNone) {
  const std::vector<Picture> unequal{Picture(3, 2), Picture(2, 3)};
  EXPECT_THROW(encode_animation({}, 80), InputError);
  EXPECT_THROW(encode_animation(unequal, 80), InputError);
  EXPECT_THROW(encode_animation({unequal.data(), 1}, 0), OptionError);
}

}  // namespace
}  // namespace dynasurf::io
