#include "dynasurf/io/png.hpp"

#include <cstring>
#include <string>

#include <png.h>

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

}  // namespace

std::string encode_png(const Picture& picture) {
  if (picture.pixels.empty()) throw InputError("the picture is empty; expected pixels");
  PngImage png;
  png.image.width = static_cast<png_uint_32>(picture.width);
  png.image.height = static_cast<png_uint_32>(picture.height);
  png.image.format = PNG_FORMAT_RGB;
  png_alloc_size_t bytes = 0;
  const auto write = [&](void* to) {
    if (!png_image_write_to_memory(&png.image, to, &bytes, 0, picture.pixels.data(), 0, nullptr))
      throw IoError(std::string("a PNG cannot be made: ") + png.image.message);
  };
  write(nullptr);
  std::string file(bytes, '\0');
  write(file.data());
  file.resize(bytes);
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
  Picture picture(static_cast<int>(png.image.width), static_cast<int>(png.image.height));
  if (!png_image_finish_read(&png.image, nullptr, picture.pixels.data(), 0, nullptr)) fail();
  return picture;
}

}  // namespace dynasurf::io
