#pragma once
#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Writes E57 files for tests, by the format alone: nothing here is shared with the reader.
namespace dynasurf::test {

/// A column of points: its element in the prototype, and its values as so many bits each.
struct E57Column {
  std::string element;
  unsigned bits = 0;
  std::vector<std::uint64_t> values;
};

inline E57Column e57_singles(const std::string& name, const std::vector<float>& values) {
  E57Column column{"<" + name + " type=\"Float\" precision=\"single\"/>", 32, {}};
  for (const float v : values) column.values.push_back(std::bit_cast<std::uint32_t>(v));
  return column;
}

inline E57Column e57_doubles(const std::string& name, const std::vector<double>& values) {
  E57Column column{"<" + name + " type=\"Float\"/>", 64, {}};
  for (const double v : values) column.values.push_back(std::bit_cast<std::uint64_t>(v));
  return column;
}

/// Integers; with `scaling` (scale="0.1" offset="3", say) scaled ones.
inline E57Column e57_integers(const std::string& name, std::int64_t least, std::int64_t most,
                              const std::vector<std::int64_t>& values, const std::string& scaling = "") {
  const auto above = [&](std::int64_t v) {
    return std::bit_cast<std::uint64_t>(v) - std::bit_cast<std::uint64_t>(least);
  };
  E57Column column{"<" + name + " type=\"" + (scaling.empty() ? "Integer" : "ScaledInteger") + "\" minimum=\"" +
                       std::to_string(least) + "\" maximum=\"" + std::to_string(most) + "\" " + scaling + "/>",
                   static_cast<unsigned>(std::bit_width(above(most))),
                   {}};
  for (const std::int64_t v : values) column.values.push_back(above(v));
  return column;
}

struct E57Scan {
  std::vector<E57Column> columns;
  std::string more;                // elements beside the points: pose, colorLimits
  std::size_t packet_bytes = 512;  // of a column in a packet, a little more for later columns
  bool has_other_packets = false;  // an index in front, empty ones between
};

inline std::uint64_t e57_place(std::size_t at) { return at / 1020 * 1024 + at % 1020; }

/// CRC-32C bit by bit, as its definition has it.
inline std::uint32_t e57_checksum(std::string_view bytes) {
  std::uint32_t crc = 0xFFFFFFFFu;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 1) != 0 ? crc >> 1 ^ 0x82F63B78u : crc >> 1;
  }
  return ~crc;
}

/// The pages of a file with such a content. Its length in the header, where there is one, is set to what it becomes.
inline std::string e57_pages(std::string content) {
  content.resize(std::max<std::size_t>(1, (content.size() + 1019) / 1020) * 1020, '\0');
  const std::uint64_t length = content.size() / 1020 * 1024;
  std::memcpy(content.data() + 16, &length, sizeof length);
  std::string file;
  for (std::size_t at = 0; at < content.size(); at += 1020) {
    file += content.substr(at, 1020);
    const std::uint32_t crc = e57_checksum(std::string_view(content).substr(at, 1020));
    for (int shift = 24; shift >= 0; shift -= 8) file += static_cast<char>(crc >> shift & 255);
  }
  return file;
}

template <class T>
void e57_append(std::string& out, T value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

inline std::string e57_bits(const E57Column& column) {
  std::string bytes((column.values.size() * column.bits + 7) / 8, '\0');
  std::size_t at = 0;
  for (const std::uint64_t value : column.values)
    for (unsigned bit = 0; bit < column.bits; ++bit, ++at)
      if ((value >> bit & 1) != 0)
        bytes[at / 8] = static_cast<char>(static_cast<unsigned char>(bytes[at / 8]) | 1u << at % 8);
  return bytes;
}

inline void e57_append_packets(std::string& content, const E57Scan& scan) {
  std::vector<std::string> streams;
  for (const E57Column& column : scan.columns) streams.push_back(e57_bits(column));
  if (scan.has_other_packets) content += std::string("\0\0\x0f\0\0\0\0\0\0\0\0\0\0\0\0\0", 16);
  const auto is_left = [](const std::string& s) { return !s.empty(); };
  do {
    std::string lengths, bytes;
    for (std::size_t c = 0; c < streams.size(); ++c) {
      const std::string piece = streams[c].substr(0, scan.packet_bytes + c);
      streams[c].erase(0, piece.size());
      e57_append(lengths, static_cast<std::uint16_t>(piece.size()));
      bytes += piece;
    }
    std::string packet("\1\0\0\0\0\0", 6);
    packet += lengths + bytes;
    packet.resize((packet.size() + 3) / 4 * 4, '\0');
    const auto length = static_cast<std::uint16_t>(packet.size() - 1),
               count = static_cast<std::uint16_t>(streams.size());
    std::memcpy(packet.data() + 2, &length, 2);
    std::memcpy(packet.data() + 4, &count, 2);
    content += packet;
    if (scan.has_other_packets) content += std::string("\2\0\7\0****", 8);
  } while (std::any_of(streams.begin(), streams.end(), is_left));
}

/// The content of a file with these scans. The text `from` in its XML becomes `to`.
inline std::string e57_content(const std::vector<E57Scan>& scans, std::string_view from = "",
                               std::string_view to = "") {
  std::string content(48, '\0');
  std::string xml =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" "
      "xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\" "
      "xmlns:nor=\"http://www.libe57.org/E57_NOR_surface_normals.txt\">\n"
      "<formatName type=\"String\"><![CDATA[ASTM E57 3D Imaging Data File]]></formatName>\n"
      "<guid type=\"String\"><![CDATA[{A}]]></guid>\n<versionMajor type=\"Integer\">1</versionMajor>\n"
      "<versionMinor type=\"Integer\"/>\n<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n";
  for (const E57Scan& scan : scans) {
    const std::size_t begin = content.size();
    content.append(32, '\0');
    e57_append_packets(content, scan);
    const std::uint64_t length = content.size() - begin, data = e57_place(begin + 32);
    content[begin] = '\1';
    std::memcpy(content.data() + begin + 8, &length, 8);
    std::memcpy(content.data() + begin + 16, &data, 8);
    xml += "<vectorChild type=\"Structure\">\n<guid type=\"String\"><![CDATA[{B}]]></guid>\n" + scan.more +
           "<points type=\"CompressedVector\" fileOffset=\"" + std::to_string(e57_place(begin)) + "\" recordCount=\"" +
           std::to_string(scan.columns.front().values.size()) + "\">\n<prototype type=\"Structure\">\n";
    for (const E57Column& column : scan.columns) xml += column.element + "\n";
    xml +=
        "</prototype>\n<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"></codecs>\n</points>\n</vectorChild>\n";
  }
  xml += "</data3D>\n<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"></images2D>\n</e57Root>\n";
  if (const std::size_t at = from.empty() ? xml.npos : xml.find(from); at != xml.npos) xml.replace(at, from.size(), to);
  std::string header = "ASTM-E57";
  e57_append(header, std::uint32_t{1});
  e57_append(header, std::uint32_t{0});
  e57_append(header, std::uint64_t{0});
  e57_append(header, e57_place(content.size()));
  e57_append(header, std::uint64_t{xml.size()});
  e57_append(header, std::uint64_t{1024});
  content.replace(0, 48, header);
  return content + xml;
}

inline std::string e57_file(const std::vector<E57Scan>& scans, std::string_view from = "", std::string_view to = "") {
  return e57_pages(e57_content(scans, from, to));
}

}  // namespace dynasurf::test
