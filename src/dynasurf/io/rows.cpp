#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>
#include <optional>

#include "dynasurf/io/detail/mesh_formats.hpp"
#include "dynasurf/io/detail/text_cells.hpp"
#include "dynasurf/io/detail/told_counts.hpp"

// Clouds as rows of numbers: XYZ, PTS, PWN, CSV. Such files name their columns in a first line or not at all.

namespace dynasurf::io::detail {
namespace {

constexpr std::size_t absent = -1;
constexpr std::size_t rows_to_look_at = 1000, most_columns = 64;

/// Which column holds what.
struct Columns {
  std::size_t count = 0;
  std::array<std::size_t, 3> position{0, 1, 2};
  std::array<std::size_t, 3> normal{absent, absent, absent};
  std::array<std::size_t, 3> colour{absent, absent, absent};
  std::size_t scan = absent;
  double full_colour = 255;  // or 1, of real numbers
  char separator = ' ';      // ' ': any blanks
  bool named = false;        // by a first line

  bool has(const std::array<std::size_t, 3>& group) const { return group[0] != absent; }
};

/// "1,5" with a point, as tables of some countries have between semicolons; other cells as they are.
std::string_view with_point(std::string_view cell, char separator, std::string& room) {
  const std::size_t comma = separator == ';' ? cell.find(',') : std::string_view::npos;
  if (comma == std::string_view::npos || cell.find_first_of(".,", comma + 1) != std::string_view::npos ||
      cell.find('.') != std::string_view::npos)
    return cell;
  room = cell;
  room[comma] = '.';
  return room;
}

bool is_number(std::string_view cell) {
  double value = 0;
  if (cell.size() > 1 && cell[0] == '+') cell.remove_prefix(1);
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc{} && end == cell.data() + cell.size();
}

/// The columns that a first line names.
Columns named_columns(const TextReader& text, char separator) {
  Columns columns;
  columns.separator = separator;
  columns.named = true;
  columns.position.fill(absent);
  const auto names = cells_of(text.rest(), separator);
  columns.count = names.size();
  // ParaView writes "Points:0" and, in some versions, "Points_0".
  const std::array<std::initializer_list<std::string_view>, 10> known{{{"x", "points:0", "points_0"},
                                                                       {"y", "points:1", "points_1"},
                                                                       {"z", "points:2", "points_2"},
                                                                       {"nx", "normal_x", "normals:0", "normals_0"},
                                                                       {"ny", "normal_y", "normals:1", "normals_1"},
                                                                       {"nz", "normal_z", "normals:2", "normals_2"},
                                                                       {"r", "red", "rgb:0", "rgb_0"},
                                                                       {"g", "green", "rgb:1", "rgb_1"},
                                                                       {"b", "blue", "rgb:2", "rgb_2"},
                                                                       {"scan", "scan_id"}}};
  std::array<std::size_t, 10> found;
  found.fill(absent);
  for (std::size_t i = 0; i < names.size(); ++i)
    for (std::size_t k = 0; k < known.size(); ++k)
      if (std::find(known[k].begin(), known[k].end(), column_name(names[i])) != known[k].end()) {
        if (found[k] != absent) text.fail("column " + quoted(names[i]) + " is there twice");
        found[k] = i;
      }
  const auto take = [&](std::size_t first, std::array<std::size_t, 3>& group) {
    for (std::size_t k = 0; k < 3; ++k)
      if (found[first + k] == absent) return false;
    std::copy_n(found.begin() + first, 3, group.begin());
    return true;
  };
  if (!take(0, columns.position)) text.fail("the first line names no columns x, y and z");
  take(3, columns.normal);
  take(6, columns.colour);
  columns.scan = found[9];
  return columns;
}

/// What three columns hold, judged by the first rows.
struct Guess {
  bool unit = true, bytes = true, shares = true;
  void see(double a, double b, double c) {
    const double length = std::sqrt(a * a + b * b + c * c);
    // Normals with three decimals are off by a thousandth; those that are zero or not finite were not known.
    if (std::isfinite(length) && length > 0 && std::abs(length - 1) > 0.02) unit = false;
    for (const double v : {a, b, c}) {
      if (!(v >= 0 && v <= 1)) shares = false;
      if (!(v >= 0 && v <= 255 && v == std::floor(v))) bytes = false;
    }
  }
};

/// What the three numbers from each column on look like in the first rows; sets how many columns there are.
std::vector<Guess> guesses_of(TextReader text, Columns& columns) {
  std::vector<Guess> guesses(most_columns);
  bool any = false;
  for (std::size_t row = 0; row < rows_to_look_at && (row == 0 || next_row(text)); ++row) {
    const auto cells = cells_of(text.rest(), columns.separator);
    if (cells.size() == 1) continue;  // the number of points that follow
    if (!any) columns.count = cells.size();
    any = true;
    if (cells.size() != columns.count || columns.count > most_columns) break;  // told when the rows are read
    for (std::size_t c = 3; c + 2 < cells.size(); ++c) {
      std::array<double, 3> v{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::string room;
        const std::string_view cell = with_point(cells[c + k], columns.separator, room);
        if (is_number(cell)) v[k] = text.number_of<double>(cell, "a value");
      }
      guesses[c].see(v[0], v[1], v[2]);
    }
  }
  return guesses;
}

/// The columns of rows without names, from the first rows. Throws when they can mean several things.
Columns guessed_columns(const TextReader& text, char separator, bool normals_first) {
  Columns columns;
  columns.separator = separator;
  const std::vector<Guess> guesses = guesses_of(text, columns);
  const auto group = [](std::size_t first) { return std::array<std::size_t, 3>{first, first + 1, first + 2}; };
  const auto place = [&](std::size_t first) {
    const bool unit = guesses[first].unit && !columns.has(columns.normal);
    if (unit || (normals_first && first == 3)) {
      columns.normal = group(first);
    } else if ((guesses[first].bytes || guesses[first].shares) && !columns.has(columns.colour)) {
      columns.colour = group(first);
      columns.full_colour = guesses[first].bytes ? 255 : 1;
    } else {
      text.fail("columns " + std::to_string(first + 1) + " to " + std::to_string(first + 3) +
                " are neither unit normals nor colours of 0 to 255 or 0 to 1; name the columns in a first line (x y z "
                "nx ny nz "
                "red green blue)");
    }
  };
  switch (columns.count) {
    case 0:
      columns.count = 3;  // a file of counts alone
      break;
    case 3:
    case 4:  // and an intensity
      break;
    case 6:
      place(3);
      break;
    case 7:  // an intensity and a colour
      place(4);
      break;
    case 9:
      place(3);
      place(6);
      break;
    case 10:  // an intensity between
      place(4);
      place(7);
      break;
    default:
      text.fail(std::to_string(columns.count) +
                " columns without names; expected 3, 4, 6, 7, 9 or 10, or a first line that names them");
  }
  return columns;
}

/// Whether the colours of named columns are real numbers from 0 to 1, from the first rows.
bool has_shares(TextReader text, const Columns& columns) {
  bool any_fraction = false;
  for (std::size_t row = 0; row < rows_to_look_at && next_row(text); ++row) {
    const auto cells = cells_of(text.rest(), columns.separator);
    for (const std::size_t column : columns.colour) {
      std::string room;
      if (column >= cells.size()) continue;
      const std::string_view cell = with_point(cells[column], columns.separator, room);
      if (!is_number(cell)) continue;
      const double value = text.number_of<double>(cell, "a value");
      if (!(value >= 0 && value <= 1)) return false;
      any_fraction = any_fraction || value != std::floor(value);
    }
  }
  return any_fraction;
}

/// `text` stands at the first row.
Columns columns_of(const TextReader& text, bool normals_first) {
  const char separator = separator_of(text.rest());
  const auto first = cells_of(text.rest(), separator);
  const bool letters = !first.empty() && !first[0].empty() &&
                       (std::isalpha(static_cast<unsigned char>(first[0][0])) != 0 || first[0][0] == '"');
  if (letters && !is_number(first[0])) {
    Columns columns = named_columns(text, separator);
    if (columns.has(columns.colour) && has_shares(text, columns)) columns.full_colour = 1;
    return columns;
  }
  TextReader row = text;
  if (first.size() == 1 && !next_row(row)) return guessed_columns(text, ' ', normals_first);
  return guessed_columns(row, separator_of(row.rest()), normals_first);
}

bool is_one_cell(std::string_view line, char separator) {
  Cells cells(line, separator);
  cells.next();
  return !cells.next();
}

class RowReader {
 public:
  RowReader(const TextReader& text, const Columns& columns, TriMesh& mesh, VertexData& data)
      : text_(text), columns_(columns), mesh_(mesh), data_(data), values_(columns.count) {}

  void read(std::string_view line) {
    Cells cells(line, columns_.separator);
    std::size_t count = 0;
    while (const auto cell = cells.next()) {
      // Columns without a meaning here may hold any text.
      if (count < values_.size()) values_[count] = is_used(count) ? number(*cell) : 0;
      ++count;
    }
    if (count != columns_.count)
      text_.fail("a row of " + std::to_string(count) + " columns; expected " + std::to_string(columns_.count));
    mesh_.vertices.push_back(vector(columns_.position));
    if (columns_.has(columns_.normal)) data_.normals.push_back(vector(columns_.normal));
    if (columns_.has(columns_.colour)) add_colour();
    if (columns_.scan != absent) {
      const double scan = values_[columns_.scan];
      if (!(scan >= 0 && scan <= 4294967295.0)) text_.fail("the number of a scan is out of range; expected 0 or more");
      data_.scans.push_back(static_cast<std::uint32_t>(scan));
    }
  }

 private:
  bool is_used(std::size_t column) const {
    const auto in = [column](const auto& group) {
      return std::find(group.begin(), group.end(), column) != group.end();
    };
    return in(columns_.position) || in(columns_.normal) || in(columns_.colour) || column == columns_.scan;
  }
  /// An empty cell is a value that was not measured.
  double number(std::string_view cell) {
    if (cell.empty() && columns_.separator != ' ') return std::numeric_limits<double>::quiet_NaN();
    return text_.number_of<double>(with_point(cell, columns_.separator, room_), "a value");
  }
  Vec3 vector(const std::array<std::size_t, 3>& group) const {
    return {values_[group[0]], values_[group[1]], values_[group[2]]};
  }
  void add_colour() {
    auto& colour = data_.colours.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      const double light = values_[columns_.colour[c]];
      if (!(light >= 0 && light <= columns_.full_colour))
        text_.fail("a colour is out of range; expected 0 to " + std::to_string(static_cast<int>(columns_.full_colour)));
      colour[c] = colour_byte(light, columns_.full_colour);
    }
  }

  const TextReader& text_;
  const Columns& columns_;
  TriMesh& mesh_;
  VertexData& data_;
  std::vector<double> values_;
  std::string room_;
};

}  // namespace

TriMesh decode_rows(const MeshFile& file, VertexData& data, bool normals_first) {
  require_memory_of(file, count_lines(file.bytes), 0, true);
  constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";
  const std::size_t begin = file.bytes.starts_with(byte_order_mark) ? byte_order_mark.size() : 0;
  data.has_end = file.bytes.empty() || file.bytes.back() == '\n';
  TextReader text(file, begin, 0, true);
  TriMesh mesh;
  if (!next_row(text)) return mesh;
  const Columns columns = columns_of(text, normals_first);
  RowReader rows(text, columns, mesh, data);

  // A lone number is the count of the points that follow; several such blocks are several scans.
  std::optional<std::size_t> declared;
  std::size_t block_begin = 0;
  std::uint32_t blocks = 0;
  const auto end_block = [&] {
    const std::size_t found = mesh.vertices.size() - block_begin;
    if (declared && found != *declared)
      text.fail(std::to_string(found) + " points in this block; " + std::to_string(*declared) + " were declared");
    if (columns.scan == absent) data.scans.resize(mesh.vertices.size(), blocks);
    block_begin = mesh.vertices.size();
    ++blocks;
  };
  for (bool more = !columns.named || next_row(text); more; more = next_row(text)) {
    const std::string_view line = text.rest();
    if (is_one_cell(line, columns.separator)) {
      if (declared || !mesh.vertices.empty()) end_block();
      declared = text.number<std::uint32_t>("the number of points that follow");
    } else {
      rows.read(line);
    }
  }
  end_block();
  const ToldCounts told = told_counts(file);
  require_told(file, told.points, mesh.vertices.size(), "points");
  require_told(file, told.rows, mesh.vertices.size(), "rows");
  data.has_count = declared || told.points || told.rows;
  if (columns.scan == absent && blocks == 1) data.scans.clear();
  return mesh;
}

}  // namespace dynasurf::io::detail
