#include <algorithm>
#include <vector>

#include "dynasurf/core/parallel.hpp"
#include "dynasurf/io/detail/bytes.hpp"
#include "dynasurf/io/detail/las.hpp"
#include "dynasurf/io/detail/range_decoder.hpp"

// LAZ (M. Isenburg, LASzip: lossless compression of LiDAR data, PE&RS 79, 2013): LAS whose points are coded in chunks.
// A variable header of LAS tells how, a table at the end where the chunks are.

namespace dynasurf::io::detail {
namespace {

constexpr std::string_view anew = "; expected LAZ as 'laszip -i in.laz -o out.laz' or PDAL write it";
constexpr std::size_t no_table = 0xffffffff;

enum class Coder { whole = 1, chunks = 2, layers = 3 };

struct Coding {
  Coder coder;
  std::size_t chunk_points;  // `no_table`: the table tells
};

/// What LAZ calls a part of a point, and the version of it that is read.
struct Item {
  std::size_t kind, version, bytes;
};

std::vector<Item> items_of(const LasHeader& header) {
  const LasFormat& format = header.format;
  std::vector<Item> items;
  if (header.extended) {
    items.push_back({10, 3, 30});
    if (header.is_infrared)
      items.push_back({12, 3, 8});
    else if (format.colour != LasFormat::none)
      items.push_back({11, 3, 6});
    if (format.has_waveform) items.push_back({13, 3, 29});
  } else {
    items.push_back({6, 2, 20});
    if (format.time != LasFormat::none) items.push_back({7, 2, 8});
    if (format.colour != LasFormat::none) items.push_back({8, 2, 6});
  }
  if (const std::size_t extra = header.record - format.bytes; extra > 0)
    items.push_back({header.extended ? std::size_t{14} : 0, header.extended ? std::size_t{3} : 2, extra});
  return items;
}

/// The variable header of LASzip: where it begins, and its bytes.
std::string_view coding_header(const MeshFile& file, const LasHeader& header, std::size_t& place) {
  constexpr std::size_t head = 54;
  place = header.header_bytes;
  for (std::size_t n = 0; n < header.extra_headers && header.begin - place >= head; ++n) {
    const std::string_view user = file.bytes.substr(place + 2, 16);
    const auto number = load<std::uint16_t>(file.bytes.data() + place + 18);
    const std::size_t bytes = load<std::uint16_t>(file.bytes.data() + place + 20);
    place += head;
    if (bytes > header.begin - place) break;
    if (number == 22204 && user.starts_with("laszip encoded")) return file.bytes.substr(place, bytes);
    place += bytes;
  }
  refuse(file, "byte", header.header_bytes, "no header of LASzip tells how the points are compressed");
}

Coding read_coding(const MeshFile& file, const LasHeader& header) {
  std::size_t place = 0;
  const std::string_view bytes = coding_header(file, header, place);
  constexpr std::size_t head = 34, of_item = 6;
  const auto number = [&](std::size_t at) { return std::size_t{load<std::uint16_t>(bytes.data() + at)}; };
  if (bytes.size() < head || bytes.size() < head + of_item * number(32))
    refuse(file, "byte", place, "the header of LASzip is cut");
  const std::size_t coder = number(0);
  if (coder < 1 || coder > 3 || number(2) != 0 || (coder == 3) != header.extended)
    refuse(file, "byte", place, "a coder of LAZ that is not known" + std::string(anew));
  const std::vector<Item> expected = items_of(header);
  bool is_known = number(32) == expected.size() && (header.extended || !header.format.has_waveform);
  for (std::size_t n = 0; is_known && n < expected.size(); ++n) {
    const std::size_t at = head + of_item * n;
    is_known =
        number(at) == expected[n].kind && number(at + 2) == expected[n].bytes && number(at + 4) == expected[n].version;
  }
  if (!is_known) refuse(file, "byte", place + 32, "a version of LAZ that is not read" + std::string(anew));
  const std::size_t points = load<std::uint32_t>(bytes.data() + 12);
  if (points == 0) refuse(file, "byte", place + 12, "chunks of no points");
  return {static_cast<Coder>(coder), points};
}

/// Where the table of chunks stands: told in front of the points, or at the end of a file that was written in one go.
std::size_t table_place(const MeshFile& file, const LasHeader& header) {
  const std::size_t size = file.bytes.size(), first = header.begin + 8;
  if (size < first + 8) refuse(file, "byte", size, "the file ends in its points");
  auto place = load<std::uint64_t>(file.bytes.data() + header.begin);
  if (place < first || place == ~std::uint64_t{0}) place = load<std::uint64_t>(file.bytes.data() + size - 8);
  if (place < first || place > size - 8)
    refuse(file, "byte", header.begin, "the table of chunks is missing; the file was cut, or not written to its end");
  return place;
}

std::vector<LazChunk> read_table(const MeshFile& file, const LasHeader& header, const Coding& coding) {
  const std::size_t table = table_place(file, header);
  const std::size_t count = load<std::uint32_t>(file.bytes.data() + table + 4);
  std::size_t place = header.begin + 8, left = header.points;
  // Each chunk holds its first point as it is.
  if (count > (table - place) / header.record)
    refuse(file, "byte", table + 4, std::to_string(count) + " chunks do not fit in front of their table");
  RangeDecoder decoder(file.bytes.substr(table + 8));
  IntegerModel numbers(32, 2);
  std::int32_t points = 0, bytes = 0;
  std::vector<LazChunk> chunks;
  for (std::size_t n = 0; n < count && left > 0; ++n) {
    if (coding.chunk_points == no_table) points = numbers.decode(decoder, points, 0);
    bytes = numbers.decode(decoder, bytes, 1);
    const std::size_t here = coding.chunk_points == no_table ? static_cast<std::uint32_t>(points) : coding.chunk_points;
    const std::size_t size = static_cast<std::uint32_t>(bytes);
    if (decoder.is_broken() || size > table - place)
      refuse(file, "byte", table, "the table of chunks does not fit the file");
    if (here > 0) chunks.push_back({file.bytes.substr(place, size), std::min(here, left), nullptr});
    place += size;
    left -= std::min(here, left);
  }
  if (left > 0)
    refuse(file, "byte", 107,
           std::to_string(header.points) + " points are declared; the chunks hold " +
               std::to_string(header.points - left));
  return chunks;
}

}  // namespace

std::string unpack_laz(const MeshFile& file, const LasHeader& header) {
  if (header.begin > file.bytes.size()) refuse(file, "byte", file.bytes.size(), "the file ends in its header");
  const Coding coding = read_coding(file, header);
  std::vector<LazChunk> chunks;
  if (coding.coder == Coder::whole)
    chunks.push_back({file.bytes.substr(header.begin), header.points, nullptr});
  else
    chunks = read_table(file, header, coding);
  // Even a symbol that always comes takes its part of a bit: nothing is allotted for points that cannot be there.
  constexpr std::size_t most_points_of_a_byte = 2048;
  for (const LazChunk& chunk : chunks)
    if (chunk.points / most_points_of_a_byte > chunk.bytes.size())
      refuse(file, "byte", static_cast<std::size_t>(chunk.bytes.data() - file.bytes.data()),
             std::to_string(chunk.points) + " points cannot stand in " + std::to_string(chunk.bytes.size()) + " bytes");
  std::string records(header.points * header.format.bytes, '\0');
  char* to = records.data();
  for (LazChunk& chunk : chunks) {
    chunk.to = to;
    to += chunk.points * header.format.bytes;
  }
  std::vector<std::uint8_t> is_whole(chunks.size(), 0);
  parallel_for(chunks.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t n = begin; n < end; ++n)
      is_whole[n] = header.extended ? unpack_layered(chunks[n], header) : unpack_pointwise(chunks[n], header);
  });
  const auto broken = std::find(is_whole.begin(), is_whole.end(), 0) - is_whole.begin();
  if (static_cast<std::size_t>(broken) < chunks.size())
    refuse(file, "byte",
           static_cast<std::size_t>(chunks[static_cast<std::size_t>(broken)].bytes.data() - file.bytes.data()),
           "the chunk of points that begins here is damaged");
  return records;
}

}  // namespace dynasurf::io::detail
