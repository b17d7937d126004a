#include "dynasurf/io/detail/png.hpp"

#include <cstring>
#include <string>

#include <png.h>
#include <zlib.h>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"

namespace dynasurf::io {
namespace {

/// libpng's simplified interface, which frees what it took.
struct PngImage {
  png_image image;
  PngImage() {
    std::memset(&image, 0, sizeof image);
    image.version = PNG_IMAGE_VERSION;
  }
  ~PngImage() { png_image_free(&image); }
  PngImage(const PngImage&) = delete;
  PngImage& operator=(const PngImage&) = delete;
};

void put_32(std::string& bytes, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0}) bytes += static_cast<char>(value >> shift & 0xffU);
}

/// A chunk of a PNG file: its length, its name, what it holds, and the sum of both.
void put_chunk(std::string& file, const std::string& name, const std::string& content) {
  const std::string summed = name + content;
  put_32(file, content.size());
  file += summed;
  put_32(file, crc32(0, reinterpret_cast<const Bytef*>(summed.data()), static_cast<uInt>(summed.size())));
}

struct Chunk {
  std::string name, content;
};

constexpr std::size_t signature_bytes = 8;

/// The chunks of a PNG file that this program has made.
std::vector<Chunk> chunks_of(const std::string& png) {
  std::vector<Chunk> chunks;
  for (std::size_t at = signature_bytes; at + 12 <= png.size();) {
    std::size_t length = 0;
    for (std::size_t n = 0; n < 4; ++n) length = length << 8 | static_cast<unsigned char>(png[at + n]);
    chunks.push_back({png.substr(at + 4, 4), png.substr(at + 8, length)});
    at += 12 + length;
  }
  return chunks;
}

/// fcTL: the whole picture, shown for a time, in place of the one before.
std::string frame_control(std::uint32_t number, const Picture& picture, int milliseconds) {
  std::string control;
  put_32(control, number);
  put_32(control, picture.width);
  put_32(control, picture.height);
  put_32(control, 0);
  put_32(control, 0);
  put_32(control, milliseconds << 16 | 1000U);
  control += std::string(2, '\0');
  return control;
}

}  // namespace

std::string encode_animation(std::span<const Picture> pictures, int milliseconds) {
  if (pictures.empty()) throw InputError("an animation without pictures");
  if (milliseconds < 1 || milliseconds > 60000)
    throw OptionError("an animation of " + std::to_string(milliseconds) + " ms a picture; expected 1 to 60000");
  std::string file;
  std::uint32_t number = 0;
  for (const Picture& picture : pictures) {
    if (picture.width != pictures[0].width || picture.height != pictures[0].height)
      throw InputError("an animation of pictures that differ in size");
    const std::string png = encode_png(picture);
    const bool first = file.empty();
    if (first) file = png.substr(0, signature_bytes);
    bool controlled = false;
    for (const Chunk& chunk : chunks_of(png)) {
      if (chunk.name == "IEND") continue;
      if (chunk.name == "IDAT") {
        if (!controlled) put_chunk(file, "fcTL", frame_control(number++, picture, milliseconds));
        controlled = true;
        std::string numbered;
        if (!first) put_32(numbered, number++);
        put_chunk(file, first ? "IDAT" : "fdAT", numbered + chunk.content);
      } else if (first) {
        put_chunk(file, chunk.name, chunk.content);
        if (chunk.name != "IHDR") continue;
        std::string control;
        put_32(control, pictures.size());
        put_32(control, 0);  // for ever
        put_chunk(file, "acTL", control);
      }
    }
  }
  put_chunk(file, "IEND", "");
  return file;
}

std::string encode_png(const Picture& picture) {
  if (picture.pixels.empty()) throw InputError("the picture is empty; expected pixels");
  PngImage png;
  png.image.width = picture.width;
  png.image.height = picture.height;
  png.image.format = PNG_FORMAT_RGB;
  // Asked for the size alone, the library packs the picture once more.
  png_alloc_size_t bytes = PNG_IMAGE_PNG_SIZE_MAX(png.image);
  std::string file(bytes, '\0');
  if (!png_image_write_to_memory(&png.image, file.data(), &bytes, 0, picture.pixels.data(), 0, nullptr))
    throw IoError(std::string("a PNG cannot be made: ") + png.image.message);
  file.resize(bytes);
  file.shrink_to_fit();
  return file;
}

void write_png(const Picture& picture, const std::filesystem::path& path) {
  if (picture.pixels.empty()) throw InputError("picture for " + path.string() + " is empty; expected pixels");
  write_file(path, encode_png(picture));
}

Picture read_png(const std::filesystem::path& path) {
  PngImage png;
  const auto fail = [&] { throw InputError(path.string() + ": expected a PNG picture: " + png.image.message); };
  if (!png_image_begin_read_from_file(&png.image, path.c_str())) fail();
  constexpr png_uint_32 widest = 1 << 15;
  if (png.image.width > widest || png.image.height > widest)
    throw InputError(path.string() + ": expected a picture of at most 32768 pixels along each side");
  png.image.format = PNG_FORMAT_RGB;
  Picture picture(png.image.width, png.image.height);
  if (!png_image_finish_read(&png.image, nullptr, picture.pixels.data(), 0, nullptr)) fail();
  return picture;
}

}  // namespace dynasurf::io
