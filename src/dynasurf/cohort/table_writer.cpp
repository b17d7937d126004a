#include "dynasurf/cohort/detail/table_writer.hpp"

#include <charconv>

#include <sqlite3.h>

#include "dynasurf/cohort/detail/table.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf::cohort::detail {
namespace {

/// Names of columns come from tables of users: quoted, none can be more than a name to SQL.
std::string quoted(const std::string& name) {
  std::string text = "\"";
  for (const char c : name) text += c == '"' ? std::string("\"\"") : std::string(1, c);
  return text + "\"";
}

const char* sql_type(CellType type) {
  return type == CellType::real ? " REAL" : type == CellType::whole ? " INTEGER" : " TEXT";
}

/// A cell as the type of its column where it is a number of that type; else as text, and empty as null.
int bind(sqlite3_stmt* statement, int place, const std::string& cell, CellType type) {
  const char *const begin = cell.data(), *const end = begin + cell.size();
  if (cell.empty()) return sqlite3_bind_null(statement, place);
  if (type == CellType::real) {
    double value = 0;
    if (const auto [rest, error] = std::from_chars(begin, end, value); error == std::errc{} && rest == end)
      return sqlite3_bind_double(statement, place, value);
  }
  if (type == CellType::whole) {
    sqlite3_int64 value = 0;
    if (const auto [rest, error] = std::from_chars(begin, end, value); error == std::errc{} && rest == end)
      return sqlite3_bind_int64(statement, place, value);
  }
  // TRANSIENT: SQLite copies the text, which is gone when the row is stepped.
  return sqlite3_bind_text(statement, place, begin, cell.size(), SQLITE_TRANSIENT);
}

}  // namespace

SqliteFile::SqliteFile(const std::filesystem::path& path) : path_(path) {
  if (sqlite3_open_v2(path.c_str(), &database_, SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE, nullptr) != SQLITE_OK) {
    const std::string reason = database_ ? sqlite3_errmsg(database_) : "out of memory";
    sqlite3_close(database_);
    throw IoError(path.string() + ": cannot be made: " + reason);
  }
  // The folder that it stands in appears whole or not at all: a journal has nothing to save.
  run("PRAGMA journal_mode = OFF");
  run("PRAGMA synchronous = OFF");
  run("BEGIN");
}

SqliteFile::~SqliteFile() { sqlite3_close(database_); }

void SqliteFile::fail() const { throw IoError(path_.string() + ": cannot be written: " + sqlite3_errmsg(database_)); }

void SqliteFile::run(const std::string& statement) {
  if (sqlite3_exec(database_, statement.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK) fail();
}

void SqliteFile::finish() {
  run("COMMIT");
  if (sqlite3_close(database_) != SQLITE_OK) fail();
  database_ = nullptr;
}

TableWriter::TableWriter(const std::filesystem::path& tsv, SqliteFile& database, const std::string& name,
                         const std::vector<Column>& columns)
    : path_(tsv), file_(tsv, std::ios::binary), database_(database) {
  std::string definition, places, head;
  for (const Column& column : columns) {
    const char* comma = types_.empty() ? "" : ", ";
    definition += comma + quoted(column.name) + sql_type(column.type);
    places += std::string(comma) + "?";
    head += (types_.empty() ? "" : "\t") + column.name;
    types_.push_back(column.type);
  }
  database.run("CREATE TABLE " + quoted(name) + " (" + definition + ")");
  const std::string insert = "INSERT INTO " + quoted(name) + " VALUES (" + places + ")";
  if (sqlite3_prepare_v2(database.handle(), insert.c_str(), -1, &insert_, nullptr) != SQLITE_OK) database.fail();
  file_ << head << "\n";
}

TableWriter::~TableWriter() { sqlite3_finalize(insert_); }

void TableWriter::add(const std::vector<std::string>& cells) {
  for (int n = 0; n < std::ssize(types_); ++n) {
    const std::string cell = tsv_cell(cells.at(n));
    if (n > 0) file_ << '\t';
    file_ << cell;
    if (bind(insert_, n + 1, cell, types_[n]) != SQLITE_OK) database_.fail();
  }
  file_ << '\n';
  if (sqlite3_step(insert_) != SQLITE_DONE) database_.fail();
  sqlite3_reset(insert_);
}

void TableWriter::finish() {
  sqlite3_finalize(insert_);
  insert_ = nullptr;
  file_.close();
  if (!file_) throw IoError(path_.string() + ": cannot be written; is the disk full?");
}

}  // namespace dynasurf::cohort::detail
