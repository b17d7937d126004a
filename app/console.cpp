#include "console.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include "dynasurf/core/detail/letters.hpp"
#include "dynasurf/core/error.hpp"

#include "heap.hpp"
#include "slicer.hpp"
#include "utf8.hpp"

namespace dynasurf::app {
namespace {

/// Writes all of `text`; false with errno set when that fails.
bool write_all(int descriptor, std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return false;
    text.remove_prefix(written);
  }
  return true;
}

std::size_t characters_of(const std::string& text) {
  return std::count_if(text.begin(), text.end(), [](char c) { return !continues_character(c); });
}

bool output_was_closed = false;

}  // namespace

void prepare_process() {
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(descriptor, F_GETFD) >= 0 || errno != EBADF) continue;
    if (descriptor == STDOUT_FILENO) output_was_closed = true;
    // The lowest free number is taken: that of the descriptor that lacks. Where that fails, nothing could be told.
    if (::open("/dev/null", O_RDWR) < 0) std::_Exit(2);
  }
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  // A closed pipe and a file at its limit become errors that can be told.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  prepare_heap();
}

void print(std::string_view text) {
  if (output_was_closed) throw IoError("cannot write to standard output: it is closed");
  if (!write_all(STDOUT_FILENO, printable(text)))
    throw IoError(std::string("cannot write to standard output: ") + std::strerror(errno));
}

void print_error(std::string_view message) {
  std::string line = printable("dynasurf: error: " + std::string(message));
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\t'; }, ' ');
  write_all(STDERR_FILENO, line + "\n");
}

void print_live(std::string_view text, bool terminal) {
  const std::string line = printable(text);
  write_all(STDERR_FILENO, terminal ? "\r\033[K" + line : line + "\n");
}

std::string table(const std::vector<std::vector<std::string>>& rows, const std::vector<std::size_t>& left) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t c = 0; c < row.size(); ++c) widths[c] = std::max(widths[c], characters_of(row[c]));
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string padding(widths[c] - characters_of(row[c]), ' ');
      const bool is_left = std::find(left.begin(), left.end(), c) != left.end();
      line += (c == 0 ? "" : "  ") + (is_left ? row[c] + padding : padding + row[c]);
    }
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "-";
  char buffer[64];
  std::snprintf(buffer, sizeof buffer, "%.*f", decimals, value);
  return buffer;
}

std::string line_of(const Note& note) {
  std::string line = std::string(name_of(note.severity)) + ": " + note.message;
  if (note.gate >= 0) line += " (gate " + std::to_string(note.gate + 1);
  if (note.slice >= 0) line += (note.gate >= 0 ? ", slice " : " (slice ") + std::to_string(note.slice + 1);
  if (note.gate >= 0 || note.slice >= 0) line += ")";
  return line + " [" + note.code + "]";
}

ProgressLine::ProgressLine(bool quiet) : quiet_(quiet), terminal_(::isatty(STDERR_FILENO) == 1) {}

ProgressLine::~ProgressLine() { finish(); }

void ProgressLine::operator()(std::string_view stage, int done, int total) {
  tell_slicer(stage, done, total);
  if (quiet_) return;
  print_live(std::string(stage) + " " + std::to_string(done) + "/" + std::to_string(total), terminal_);
  open_ = terminal_;
}

void ProgressLine::finish() {
  if (open_) write_all(STDERR_FILENO, "\r\033[K");
  open_ = false;
}

}  // namespace dynasurf::app
