#pragma once
#include <chrono>
#include <filesystem>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace dynasurf::app {

/// Runs a program silently, in a process group of its own, until it ends; its temporary files go to `temporary`.
/// Returns its exit code; nothing when it was killed: by a signal, or from here after `patience`, with all of its
/// group. Throws Cancelled when `stop` is requested, after killing the group, and IoError when the program cannot be
/// started. Call it from the main thread: the system kills the program when the thread ends that started it, so that it
/// does not outlive this process, however that dies.
std::optional<int> run_quietly(const std::vector<std::string>& words, const std::filesystem::path& temporary,
                               std::chrono::seconds patience, const std::stop_token& stop);

/// Kills what `run_quietly` runs at this moment. For the moment before the program ends itself.
void kill_children() noexcept;

}  // namespace dynasurf::app
