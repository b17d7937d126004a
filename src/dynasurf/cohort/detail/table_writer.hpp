#pragma once
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "dynasurf/cohort/detail/schema_columns.hpp"

struct sqlite3;
struct sqlite3_stmt;

namespace dynasurf::cohort::detail {

/// A new SQLite file that is filled in one transaction. Throws IoError.
class SqliteFile {
 public:
  explicit SqliteFile(const std::filesystem::path& path);
  ~SqliteFile();
  SqliteFile(const SqliteFile&) = delete;
  SqliteFile& operator=(const SqliteFile&) = delete;

  void run(const std::string& statement);
  /// Ends the transaction and closes the file.
  void finish();
  sqlite3* handle() const { return database_; }
  [[noreturn]] void fail() const;

 private:
  std::filesystem::path path_;
  sqlite3* database_ = nullptr;
};

/// A table that is written to a TSV file and to SQLite at once, row by row: no more than a row is held in memory.
class TableWriter {
 public:
  TableWriter(const std::filesystem::path& tsv, SqliteFile& database, const std::string& name,
              const std::vector<Column>& columns);
  ~TableWriter();
  TableWriter(const TableWriter&) = delete;
  TableWriter& operator=(const TableWriter&) = delete;

  /// One cell a column.
  void add(const std::vector<std::string>& cells);
  /// Throws IoError when the rows did not all reach the file.
  void finish();

 private:
  std::filesystem::path path_;
  std::ofstream file_;
  SqliteFile& database_;
  sqlite3_stmt* insert_ = nullptr;
  std::vector<CellType> types_;
};

}  // namespace dynasurf::cohort::detail
