#include "dynasurf/cohort/status.hpp"

#include <array>
#include <cerrno>
#include <charconv>
#include <functional>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "dynasurf/cohort/detail/claims.hpp"
#include "dynasurf/cohort/detail/table.hpp"
#include "dynasurf/core/error.hpp"
#include "dynasurf/io/detail/byte_source.hpp"

namespace dynasurf::cohort {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view head =
    "id\tstate\tverdict\treason\tattempts\tstarted\twall_s\tcpu_s\tpeak_mb\tinput_sha256\tinput_"
    "stamp\tsettings\thost\n";
constexpr std::size_t columns = 13;
constexpr std::size_t longest_row = 4000;  // a single write of it stays whole

std::string number_text(double value) {
  char text[64];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::fixed, 3).ptr};
}

std::string line_of(const StudyStatus& row) {
  const std::string reason = detail::cut(detail::tsv_cell(row.reason), 2000);
  std::string line = row.id + "\t" + (row.done ? "done" : "failed") + "\t" + row.verdict + "\t" + reason + "\t" +
                     std::to_string(row.attempts) + "\t" + row.started + "\t" + number_text(row.wall_s) + "\t" +
                     number_text(row.cpu_s) + "\t" + number_text(row.peak_mb) + "\t" + row.input_sha256 + "\t" +
                     row.input_stamp + "\t" + row.settings + "\t" + detail::cut(detail::tsv_cell(row.host), 200) + "\n";
  if (line.size() > longest_row) throw IoError("a row of status.tsv is too long");
  return line;
}

std::vector<std::string> cells_of(std::string_view line) {
  std::vector<std::string> cells;
  for (std::size_t from = 0; from <= line.size();) {
    const std::size_t to = std::min(line.find('\t', from), line.size());
    cells.emplace_back(line.substr(from, to - from));
    from = to + 1;
  }
  return cells;
}

template <class Number>
Number number_in(const std::string& cell, const std::function<void()>& refuse) {
  Number value{};
  const auto [rest, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (error != std::errc{} || rest != cell.data() + cell.size()) refuse();
  return value;
}

StudyStatus parse_row(std::string_view line, const fs::path& path, std::size_t number) {
  const auto refuse = [&] {
    throw InputError(path.string() + ": line " + std::to_string(number) +
                     " is no row of this program; expected the table that dynasurf batch keeps");
  };
  const std::vector<std::string> cells = cells_of(line);
  if (cells.size() != columns || (cells[1] != "done" && cells[1] != "failed")) refuse();
  StudyStatus row;
  row.id = cells[0], row.done = cells[1] == "done", row.verdict = cells[2], row.reason = cells[3];
  row.attempts = number_in<int>(cells[4], refuse);
  row.started = cells[5];
  row.wall_s = number_in<double>(cells[6], refuse);
  row.cpu_s = number_in<double>(cells[7], refuse);
  row.peak_mb = number_in<double>(cells[8], refuse);
  row.input_sha256 = cells[9], row.input_stamp = cells[10], row.settings = cells[11], row.host = cells[12];
  return row;
}

/// Takes in the whole lines of `text`, whose first is line `lines + 1`; returns how many bytes that were.
std::size_t take_lines(std::string_view text, const fs::path& path, std::size_t& lines,
                       std::map<std::string, StudyStatus>& rows) {
  std::size_t taken = 0;
  for (std::size_t to = text.find('\n'); to != std::string_view::npos; to = text.find('\n', taken)) {
    const std::string_view line = text.substr(taken, to - taken);
    if (++lines == 1) {
      if (line != head.substr(0, head.size() - 1))
        throw InputError(path.string() + ": is not the table that dynasurf batch keeps; expected another --out");
    } else {
      StudyStatus row = parse_row(line, path, lines);
      rows[row.id] = std::move(row);
    }
    taken = to + 1;
  }
  return taken;
}

void write_at_end(int fd, std::string_view text, const fs::path& path) {
  const off_t end = ::lseek(fd, 0, SEEK_END);
  const ssize_t written = end < 0 ? -1 : ::write(fd, text.data(), text.size());
  if (written == std::ssize(text)) return;
  // A short write is taken for a full disk; what was written of the row is taken back, and the table stays whole.
  const int code = written < 0 ? errno : ENOSPC;
  if (end >= 0 && ::ftruncate(fd, end) != 0) io::staging::fail(path, "take back half a row", errno);
  io::staging::fail(path, "write a row", code);
}

}  // namespace

StatusFile::StatusFile(const std::filesystem::path& path)
    : path_(path), file_(::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666)) {
  if (file_.fd < 0) io::staging::fail(path, "open this file", errno);
  const FileLock lock(file_.fd, path_);
  read_locked();
  if (lines_ == 0) {
    write_at_end(file_.fd, head, path_);
    read_locked();
  }
}

/// Under the lock nobody is writing: what follows the last line break was never finished.
void StatusFile::read_locked() {
  struct stat status {};
  if (::fstat(file_.fd, &status) != 0) io::staging::fail(path_, "look at this file", errno);
  const std::uint64_t size = status.st_size;
  std::string text(size > read_bytes_ ? size - read_bytes_ : 0, '\0');
  for (std::size_t got = 0; got < text.size();) {
    const ssize_t part = ::pread(file_.fd, text.data() + got, text.size() - got, read_bytes_ + got);
    if (part < 0 && errno == EINTR) continue;
    if (part <= 0) io::staging::fail(path_, "read this file", part < 0 ? errno : EIO);
    got += part;
  }
  read_bytes_ += take_lines(text, path_, lines_, rows_);
  if (read_bytes_ < size && ::ftruncate(file_.fd, read_bytes_) != 0)
    io::staging::fail(path_, "cut off an unfinished row", errno);
}

void StatusFile::read_on() {
  const FileLock lock(file_.fd, path_);
  read_locked();
}

const StudyStatus* StatusFile::find(const std::string& id) const {
  const auto at = rows_.find(id);
  return at == rows_.end() ? nullptr : &at->second;
}

void StatusFile::append(const StudyStatus& row) {
  const std::string line = line_of(row);
  const FileLock lock(file_.fd, path_);
  read_locked();
  write_at_end(file_.fd, line, path_);
  read_locked();
}

std::map<std::string, StudyStatus> read_status(const std::filesystem::path& path) {
  std::map<std::string, StudyStatus> rows;
  std::size_t lines = 0;
  take_lines(io::text_of_file(path), path, lines, rows);
  return rows;
}

}  // namespace dynasurf::cohort
