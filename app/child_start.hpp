#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include <sys/types.h>

namespace dynasurf::app {

/// Throws IoError with the system's word for `code`.
[[noreturn]] void fail_to_start(const std::string& program, int code);

/// `variables`, and those of this process that are not named among them.
std::vector<std::string> environment_with(std::vector<std::string> variables);

/// Starts a program in a process group of its own; returns when the new process runs it. `errors`: what becomes its
/// standard error; below 0: none. Throws IoError when it cannot.
pid_t start_child(const std::vector<std::string>& words, const std::vector<std::string>& variables, int errors,
                  std::uint64_t memory_bytes);

}  // namespace dynasurf::app
