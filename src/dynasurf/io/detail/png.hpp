#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace dynasurf::io {

/// Red, green, blue.
using Colour = std::array<std::uint8_t, 3>;

/// A picture of `width` x `height` pixels, row by row from the top.
struct Picture {
  int width = 0, height = 0;
  std::vector<Colour> pixels;

  Picture() = default;
  Picture(int w, int h, Colour background = {0, 0, 0})
      : width(w), height(h), pixels(w * static_cast<std::size_t>(h), background) {}
  Colour& operator()(int x, int y) { return pixels[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)]; }
  const Colour& operator()(int x, int y) const {
    return pixels[y * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

/// A PNG file as bytes, 8 bits per colour. Throws InputError for a picture without pixels, IoError.
std::string encode_png(const Picture& picture);

/// An animated PNG that repeats: each picture stands for `milliseconds`. What knows no animations shows the first one.
/// Throws InputError unless there are pictures, all of one size, OptionError for a time of less than 1 or more than
/// 60000 ms, IoError.
std::string encode_animation(std::span<const Picture> pictures, int milliseconds);

/// PNG, 8 bits per colour. The same picture gives the same bytes. The file appears whole or not at all.
/// Throws InputError for a picture without pixels, IoError.
void write_png(const Picture& picture, const std::filesystem::path& path);

/// Reads what `write_png` wrote, or any PNG as 8-bit colours. Throws InputError, IoError.
Picture read_png(const std::filesystem::path& path);

}  // namespace dynasurf::io
