#include <algorithm>
#include <array>
#include <charconv>
#include <unordered_map>

#include "dynasurf/core/error.hpp"
#include "dynasurf/io/cloud_io.hpp"
#include "dynasurf/io/detail/atomic_file.hpp"
#include "dynasurf/io/detail/text_cells.hpp"
#include "dynasurf/io/detail/told_counts.hpp"

namespace dynasurf::io {
namespace {

using detail::TextReader;

constexpr std::size_t absent = -1;
constexpr std::size_t most_points = 2000, most_gates = 1000, longest_name = 40;
constexpr double farthest_mm = 1e5;

struct Columns {
  std::size_t count = 0;
  std::array<std::size_t, 5> at{absent, absent, absent, absent, absent};  // point, gate, x, y, z
  char separator = ',';
};

Columns columns_of(const TextReader& text) {
  constexpr std::array<std::array<std::string_view, 2>, 5> known{
      {{"point", "point"}, {"gate", "gate"}, {"x_mm", "x"}, {"y_mm", "y"}, {"z_mm", "z"}}};
  Columns columns;
  columns.separator = detail::separator_of(text.rest());
  const auto names = detail::cells_of(text.rest(), columns.separator);
  columns.count = names.size();
  for (std::size_t n = 0; n < names.size(); ++n)
    for (std::size_t k = 0; k < known.size(); ++k) {
      const std::string name = detail::column_name(names[n]);
      if (name != known[k][0] && name != known[k][1]) continue;
      if (columns.at[k] != absent) text.fail("column " + detail::quoted(names[n]) + " is there twice");
      columns.at[k] = n;
    }
  for (std::size_t k = 0; k < known.size(); ++k)
    if (columns.at[k] == absent)
      text.fail("the first line names no column '" + std::string(known[k][0]) +
                "'; expected point, gate, x_mm, y_mm, z_mm");
  return columns;
}

/// The rows as they are read: what is known of every point, by gate.
struct Table {
  std::vector<std::string> name;
  std::unordered_map<std::string, std::size_t> number;
  std::vector<std::vector<std::optional<Vec3>>> places;  // [point][gate]
  std::size_t gates = 0;
};

void read_row(const TextReader& text, const Columns& columns, Table& table) {
  const auto cells = detail::cells_of(text.rest(), columns.separator);
  if (cells.size() != columns.count)
    text.fail("a row of " + std::to_string(cells.size()) + " cells; expected " + std::to_string(columns.count));
  const std::string name(cells[columns.at[0]]);
  if (name.empty() || name.size() > longest_name)
    text.fail("the name of a point is " + detail::quoted(name) + "; expected 1 to " + std::to_string(longest_name) +
              " bytes");
  const int gate = text.number_of<int>(cells[columns.at[1]], "a gate");
  if (gate < 1 || gate > static_cast<int>(most_gates))
    text.fail("gate " + std::to_string(gate) + " is out of range; expected 1 to " + std::to_string(most_gates));
  Vec3 place;
  for (int a = 0; a < 3; ++a) {
    place[a] = text.number_of<double>(cells[columns.at[static_cast<std::size_t>(a) + 2]], "a coordinate");
    if (!(std::abs(place[a]) <= farthest_mm)) text.fail("a coordinate is out of range; expected mm within 100 m");
  }
  const auto [entry, is_new] = table.number.try_emplace(name, table.name.size());
  if (is_new) {
    if (table.name.size() == most_points) text.fail("more than " + std::to_string(most_points) + " points");
    table.name.push_back(name);
    table.places.emplace_back();
  }
  auto& places = table.places[entry->second];
  const std::size_t at = gate - 1;
  if (places.size() <= at) places.resize(at + 1);
  if (places[at]) text.fail("point " + detail::quoted(name) + " is there twice in gate " + std::to_string(gate));
  places[at] = place;
  table.gates = std::max(table.gates, at + 1);
}

void require_gates(const Table& table, const std::string& file) {
  if (table.gates < 2)
    throw InputError(file + ": points of " + std::to_string(table.gates) + " gate; expected 2 or more");
  for (std::size_t g = 0; g < table.gates; ++g)
    if (std::none_of(table.places.begin(), table.places.end(),
                     [&](const auto& places) { return g < places.size() && places[g]; }))
      throw InputError(file + ": no point in gate " + std::to_string(g + 1) + " of " + std::to_string(table.gates));
}

std::string text_of(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

}  // namespace

TrackedFile read_tracked_points(const std::filesystem::path& path) {
  const std::string bytes = detail::read_whole(path, "a table of points");
  const detail::MeshFile file{path.string(), bytes};
  TextReader text(file);
  if (!detail::next_row(text)) throw InputError(path.string() + ": no rows; expected a table of points");
  const Columns columns = columns_of(text);
  Table table;
  std::size_t rows = 0;
  for (; detail::next_row(text); ++rows) read_row(text, columns, table);
  const detail::ToldCounts told = detail::told_counts(file);
  detail::require_told(file, told.rows, rows, "rows");
  if (table.name.empty()) throw InputError(path.string() + ": no points below the names of the columns");
  require_gates(table, path.string());

  TrackedFile result;
  if (!told.rows)
    result.notes.push_back({Severity::info, "motion.no_count",
                            "the table does not tell how many rows it has (\"# " + std::to_string(rows) +
                                " rows\" in front); one that was cut at the end of a row would look alike"});
  result.points.gates.resize(table.gates);
  // Motion compares the same points in all gates: one that is lost in a gate is of no use.
  for (std::size_t n = 0; n < table.name.size(); ++n) {
    const auto& places = table.places[n];
    if (places.size() < table.gates || std::any_of(places.begin(), places.end(), [](const auto& p) { return !p; }))
      continue;
    result.points.name.push_back(table.name[n]);
    for (std::size_t g = 0; g < table.gates; ++g) result.points.gates[g].push_back(*places[g]);
  }
  if (const std::size_t lost = table.name.size() - result.points.name.size(); lost > 0)
    result.notes.push_back({Severity::warning, "motion.points_left_out",
                            std::to_string(lost) + " of " + std::to_string(table.name.size()) +
                                " points are not known in every gate and were left out"});
  return result;
}

void write_tracked_points(const TrackedPoints& points, const std::filesystem::path& file) {
  std::string text =
      "# " + std::to_string(points.gates.size() * points.name.size()) + " rows\npoint,gate,x_mm,y_mm,z_mm\n";
  for (std::size_t g = 0; g < points.gates.size(); ++g)
    for (std::size_t n = 0; n < points.name.size(); ++n) {
      const Vec3& p = points.gates[g][n];
      text += points.name[n] + "," + std::to_string(g + 1) + "," + text_of(p[0]) + "," + text_of(p[1]) + "," +
              text_of(p[2]) + "\n";
    }
  write_file(file, text);
}

}  // namespace dynasurf::io
