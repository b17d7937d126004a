#pragma once
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include <sys/types.h>

namespace dynasurf::app {

// Programs are started by the main thread alone: the system kills one when the thread ends that started it, so that it
// does not outlive this process, however that dies.

/// How a child program ended, and what it took.
struct ChildEnd {
  std::optional<int> code;  // its exit code; absent when a signal killed it
  int signal = 0;           // that killed it
  double cpu_s = 0, peak_mb = 0;
};

/// A program that runs beside this one, in a process group of its own, without input and output; the end of what it
/// says on standard error is kept.
class ChildProgram {
 public:
  /// `variables` ("NAME=VALUE") come before those of this process. `memory_bytes`: most memory it may take for data; 0:
  /// no limit. Throws IoError when it cannot be started.
  ChildProgram(const std::vector<std::string>& words, const std::vector<std::string>& variables,
               std::uint64_t memory_bytes);
  /// Kills the group where it still runs.
  ~ChildProgram();
  ChildProgram(const ChildProgram&) = delete;
  ChildProgram& operator=(const ChildProgram&) = delete;

  /// Its end, from then on; nothing while it runs.
  std::optional<ChildEnd> end();
  /// Asks it to stop (SIGTERM), which it may clean up after.
  void ask_to_stop() const;
  /// Kills its group (SIGKILL) and waits briefly until no process of it is left that could write to a file.
  void kill();
  /// The last 4 kB of its standard error.
  const std::string& words() const { return words_; }
  /// Readable when it has said something or ended.
  int descriptor() const { return errors_; }

 private:
  void listen();
  pid_t child_ = 0;
  int errors_ = -1;
  std::optional<ChildEnd> ended_;
  std::string words_;
};

/// Runs a program silently, in a process group of its own, until it ends; its temporary files go to `temporary`.
/// Returns its exit code; nothing when it was killed: by a signal, or from here after `patience`, with all of its
/// group. Throws Cancelled when `stop` is requested, after killing the group, and IoError when the program cannot be
/// started.
std::optional<int> run_quietly(const std::vector<std::string>& words, const std::filesystem::path& temporary,
                               std::chrono::seconds patience, const std::stop_token& stop);

/// Kills every child program that runs at this moment. For the moment before the program ends itself.
void kill_children() noexcept;

}  // namespace dynasurf::app
