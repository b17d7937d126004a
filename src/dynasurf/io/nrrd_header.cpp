#include "dynasurf/io/detail/nrrd_header.hpp"

#include <algorithm>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/detail/text_stream.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::io {
namespace {

constexpr std::size_t longest_header = std::size_t{1} << 20;

void read_line(NrrdHeader& header, const std::string& line) {
  if (line[0] == '#') return;
  const auto colon = line.find(':');
  if (colon == std::string::npos)
    throw InputError(header.where + ": NRRD header line \"" + line.substr(0, 60) + "\" has no colon");
  // A line with := is a key of whoever wrote the file, which keeps its spelling; fields of the format are known in any
  // case, with or without blanks.
  const bool is_key = colon + 1 < line.size() && line[colon + 1] == '=';
  std::string name = line.substr(0, colon);
  if (!is_key) {
    name = small_letters(name);
    std::erase(name, ' ');
  }
  header.data_file_is_last = !is_key && name == "datafile";
  auto& table = is_key ? header.keys : header.fields;
  if (!table.emplace(name, trimmed(line.substr(colon + (is_key ? 2 : 1)))).second)
    throw InputError(header.where + ": NRRD header gives \"" + name.substr(0, 60) + "\" twice");
}

/// A header that lost its last lines must not pass for a whole one. It is whole up to an empty line; and up to the name
/// of its data file, which the programs that leave the empty line out write last. `line` is what follows the last line
/// break.
void require_end(const NrrdHeader& header, const std::string& line) {
  if (header.has_blank_line) return;
  if (!line.empty())
    throw InputError(header.where + ": is cut off: the last line of the NRRD header, \"" + line.substr(0, 60) +
                     "\", has no end");
  if (!header.data_file_is_last)
    throw InputError(header.where +
                     ": may be cut off: the NRRD header ends without a blank line; end it with one, or " +
                     "with the line \"data file\"");
}

}  // namespace

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t\r");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

NrrdHeader read_nrrd_header(const std::filesystem::path& path) {
  NrrdHeader header;
  header.where = path.string();
  ByteSource source(path, ByteSource::Packing::plain);
  const std::uint64_t size = source.most_bytes_left();
  std::string line;
  bool first = true;
  for (; header.end < size && !header.has_blank_line;) {
    if (header.end >= longest_header) throw InputError(header.where + ": NRRD header is longer than 1 MiB");
    std::byte byte{};
    source.read({&byte, 1}, "header");
    ++header.end;
    const char c = static_cast<char>(byte);
    if (c != '\n') {
      line += c;
      continue;
    }
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (first) {
      if (line.size() != 8 || line.compare(0, 7, "NRRD000") != 0 || line[7] < '1' || line[7] > '5')
        throw InputError(header.where + ": is not a NRRD file of version 1 to 5");
      first = false;
    } else if (line.empty()) {
      header.has_blank_line = true;
    } else {
      read_line(header, line);
    }
    line.clear();
  }
  require_end(header, line);
  return header;
}

std::vector<std::string> words(const std::string& text) {
  TextInput in(text);
  std::vector<std::string> found;
  for (std::string word; in >> word;) found.push_back(word);
  return found;
}

std::vector<std::string> quoted(const std::string& text) {
  std::vector<std::string> found;
  for (auto at = text.find('"'); at != std::string::npos; at = text.find('"', at)) {
    const auto end = text.find('"', at + 1);
    if (end == std::string::npos) break;
    found.push_back(text.substr(at + 1, end - at - 1));
    at = end + 1;
  }
  return found;
}

}  // namespace dynasurf::io
