#include <algorithm>
#include <utility>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"
#include "dynasurf/io/detail/dicom_file.hpp"
#include "dynasurf/io/detail/dicom_outline.hpp"

namespace dynasurf::io {
namespace {

std::uint64_t bytes_of_frame(const DicomImage& image) {
  return static_cast<std::uint64_t>(image.bits_allocated) / 8 * image.rows * image.columns;
}

/// The values of one frame, stored in one byte each or in two, the low one first.
void decode(std::span<const std::byte> bytes, const DicomImage& image, std::span<float> values) {
  // Old files keep overlays in the bits that the value does not use.
  const int shift = image.high_bit + 1 - image.bits_stored;
  const std::uint32_t mask = (1u << image.bits_stored) - 1, sign = image.is_signed ? 1u << (image.bits_stored - 1) : 0;
  const auto value_of = [=, slope = image.slope, intercept = image.intercept](std::uint32_t raw) -> float {
    const std::int32_t value =
        static_cast<std::int32_t>(((raw >> shift) & mask) ^ sign) - static_cast<std::int32_t>(sign);
    return slope * value + intercept;
  };
  if (image.bits_allocated == 16)
    for (std::size_t p = 0; p < values.size(); ++p)
      values[p] = value_of(std::to_integer<std::uint32_t>(bytes[2 * p]) |
                           std::to_integer<std::uint32_t>(bytes[2 * p + 1]) << 8);
  else
    for (std::size_t p = 0; p < values.size(); ++p) values[p] = value_of(std::to_integer<std::uint32_t>(bytes[p]));
}

/// The bytes [begin, begin + out.size()) of unpacked pixels, 16-bit words turned round where the file has them so.
void read_plain(FileWindow& file, const FilePiece& pixels, bool turned, std::uint64_t begin, std::span<std::byte> out) {
  if (!turned) return file.read(pixels.begin + begin, out, "pixel data");
  // A frame of 8 bits may begin in the middle of a word.
  const std::uint64_t from = begin / 2 * 2, to = std::min((begin + out.size() + 1) / 2 * 2, pixels.size());
  std::vector<std::byte> words(to - from);
  file.read(pixels.begin + from, words, "pixel data");
  for (std::size_t n = 0; n + 1 < words.size(); n += 2) std::swap(words[n], words[n + 1]);
  std::copy_n(words.begin() + begin - from, out.size(), out.begin());
}

[[noreturn]] void refuse_run_lengths(const DicomImage& image, int frame, const std::string& reason) {
  throw InputError(image.where() + ": its run-length pixel data are damaged in frame " + std::to_string(frame + 1) +
                   ": " + reason);
}

/// One plane of bytes: runs of a repeated byte, and of bytes as they are (DICOM PS3.5, annex G.3). `out` receives every
/// `stride`-th byte. False when the runs end too early.
bool unpack_plane(std::span<const std::byte> runs, std::span<std::byte> out, std::size_t stride) {
  std::size_t in = 0, place = 0;
  while (place < out.size()) {
    if (in >= runs.size()) return false;
    const int byte = std::to_integer<unsigned char>(runs[in++]);
    const int control = byte < 128 ? byte : byte - 256;
    if (control == -128) continue;
    const std::size_t count = static_cast<std::size_t>(control < 0 ? -control : control) + 1;
    if (runs.size() - in < (control < 0 ? 1 : count)) return false;
    for (std::size_t n = 0; n < count && place < out.size(); ++n, place += stride)
      out[place] = runs[control < 0 ? in : in + n];
    in += control < 0 ? 1 : count;
  }
  return true;
}

/// A frame packed in run lengths: a table of 16 numbers, then one plane per byte of a value, the high byte first.
void read_packed(FileWindow& file, const DicomImage& image, const FilePiece& fragment, int frame,
                 std::span<std::byte> out) {
  constexpr std::size_t table_bytes = 64;
  // A byte needs two at worst; what is longer holds nothing that belongs here.
  if (fragment.size() < table_bytes || fragment.size() > table_bytes + 2 * out.size() + 64)
    refuse_run_lengths(image, frame, std::to_string(fragment.size()) + " bytes cannot be one frame");
  std::vector<std::byte> bytes(fragment.size());
  file.read(fragment.begin, bytes, "packed frame");
  const auto entry = [&](std::size_t n) {
    std::size_t value = 0;
    for (std::size_t b = 0; b < 4; ++b) value |= std::to_integer<std::size_t>(bytes[4 * n + b]) << 8 * b;
    return value;
  };
  const std::size_t planes = static_cast<std::size_t>(image.bits_allocated) / 8;
  if (entry(0) != planes)
    refuse_run_lengths(image, frame, std::to_string(entry(0)) + " planes; expected " + std::to_string(planes));
  for (std::size_t p = 0; p < planes; ++p) {
    const std::size_t begin = entry(p + 1), end = p + 1 < planes ? entry(p + 2) : bytes.size();
    if (begin < table_bytes || begin > end || end > bytes.size())
      refuse_run_lengths(image, frame, "plane " + std::to_string(p + 1) + " stands outside of it");
    if (!unpack_plane(std::span(bytes).subspan(begin, end - begin), out.subspan(planes - 1 - p), planes))
      refuse_run_lengths(image, frame, "plane " + std::to_string(p + 1) + " ends too early");
  }
}

void check_amount(const DicomImage& image, const DicomOutline& outline) {
  const std::uint64_t frames = image.frames, expected = bytes_of_frame(image) * frames;
  if (outline.run_lengths) {
    // Run lengths pack 128 bytes into 2 at best: more is a lie, found before memory is taken.
    if (expected > 64 * size_of_file(image.path))
      throw InputError(image.where() + ": declares more pixels than its run-length data can hold");
    if (outline.fragments.size() != frames)
      throw InputError(image.where() + ": holds " + std::to_string(outline.fragments.size()) +
                       " packed pieces; expected one for each of " + std::to_string(frames) +
                       " frames (repack it with: dcmdrle IN OUT)");
    return;
  }
  const std::uint64_t stored = outline.pixels->size();
  if (stored != expected && stored != expected + expected % 2)
    throw InputError(image.where() + ": its pixel data are " + std::to_string(stored) + " bytes; " +
                     std::to_string(image.frames) + " frames of " + std::to_string(image.columns) + " x " +
                     std::to_string(image.rows) + " pixels need " + std::to_string(expected));
}

}  // namespace

void read_dicom_frames(const DicomImage& image, const std::function<void(int, std::span<const float>)>& use) {
  const DicomOutline outline = outline_of_dicom(image.path, {});
  if (!outline.pixels) throw InputError(image.where() + ": holds no pixel data");
  check_amount(image, outline);
  FileWindow file(image.path);
  std::vector<std::byte> bytes(bytes_of_frame(image));
  std::vector<float> values(bytes.size() / (static_cast<std::size_t>(image.bits_allocated) / 8));
  for (int f = 0; f < image.frames; ++f) {
    if (outline.run_lengths)
      read_packed(file, image, outline.fragments[f], f, bytes);
    else
      read_plain(file, *outline.pixels, outline.big_endian && outline.pixels_are_words, f * bytes.size(), bytes);
    decode(bytes, image, values);
    use(f, values);
  }
}

}  // namespace dynasurf::io
