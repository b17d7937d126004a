#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

namespace dynasurf::io {

/// Bytes [begin, end) of a file.
struct FilePiece {
  std::uint64_t begin = 0, end = 0;
  std::uint64_t size() const { return end - begin; }
};

/// Where things stand in a DICOM file, found without taking any of it into memory.
struct DicomOutline {
  bool explicit_vr = true, big_endian = false, run_lengths = false;  // the transfer syntax
  std::vector<FilePiece> wanted;                                     // whole elements of the first level
  std::optional<FilePiece> pixels;                                   // the value of PixelData
  bool pixels_are_words = false;                                     // its representation is OW
  bool has_real_pixels = false;                                      // pixel data of 32 or 64 bits
  std::vector<FilePiece> fragments;                                  // of packed pixels, without the table of offsets
};

// What a DICOM file may hold. Real files hold some hundred elements, nested 3 to 5 deep.
inline constexpr std::uint64_t most_dicom_elements = 10'000'000;  // that are passed over
inline constexpr std::uint64_t most_nested_elements = 10'000;     // within the wanted ones, items counted too
inline constexpr std::uint64_t most_unordered_elements = 1000;    // of these, tags that do not ascend
inline constexpr std::size_t deepest_dicom_nesting = 32;
inline constexpr std::uint64_t longest_dicom_value = std::uint64_t{2} << 20;  // of a wanted element, bytes

/// Walks once through a DICOM file, with or without preamble, and finds the elements of the first level whose tags are
/// `wanted` ((group << 16) | element) and the pixel data. Takes time linear in the file, one small buffer, no
/// recursion. Throws InputError for a file that is cut off (also in elements that nobody wants), packed in another way
/// than run lengths (named, with the way to convert it), above the limits over this line, or with a wanted tag twice;
/// IoError when it cannot be read.
/// What cannot be told: a file cut exactly between two elements behind its pixel data is whole without them. Nothing
/// that is wanted stands there, because tags ascend and the pixels are the last to be read.
DicomOutline outline_of_dicom(const std::filesystem::path& path, std::span<const std::uint32_t> wanted);

}  // namespace dynasurf::io
