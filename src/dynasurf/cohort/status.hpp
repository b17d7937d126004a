#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "dynasurf/io/detail/staging.hpp"

namespace dynasurf::cohort {

/// How the last run of a study ended.
struct StudyStatus {
  std::string id;
  bool done = false;    // there is a result; else the run failed
  std::string verdict;  // ok, check, fail; empty where there is no result
  std::string reason;   // of a failure, one line
  int attempts = 1;
  std::string started;           // UTC, 2026-01-31T12:00:00Z
  double wall_s = 0, cpu_s = 0;  // of the last attempt
  double peak_mb = 0;            // most memory in use
  std::string input_sha256;      // of the input (see `input_hash`); empty when it could not be read
  std::string input_stamp;       // sizes and times by which an unchanged input is known without reading it
  std::string settings;          // short hash of options and program
  std::string host;
};

/// The table status.tsv of a cohort: a row for every run of a study, appended when it has ended; the last row of an id
/// holds. Any number of processes may append; a row is whole or not there. A row that a process could not finish, since
/// it was killed or the disk was full, is cut off by the next one.
class StatusFile {
 public:
  /// Opens the table, with its head line when it is new, and reads it. Throws InputError for a file that is no such
  /// table, IoError.
  explicit StatusFile(const std::filesystem::path& path);

  /// Takes in what others have appended since.
  void read_on();
  /// The last row of a study; null when it has none.
  const StudyStatus* find(const std::string& id) const;
  /// Appends a row, and takes in what others have appended before it.
  void append(const StudyStatus& row);

  const std::map<std::string, StudyStatus>& all() const { return rows_; }

 private:
  void read_locked();
  std::filesystem::path path_;
  io::staging::Descriptor file_;
  std::uint64_t read_bytes_ = 0;
  std::size_t lines_ = 0;
  std::map<std::string, StudyStatus> rows_;
};

/// The table as it stands, without being opened for writing. An unfinished last row is passed over.
std::map<std::string, StudyStatus> read_status(const std::filesystem::path& path);

}  // namespace dynasurf::cohort
