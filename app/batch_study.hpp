#pragma once
#include <chrono>
#include <memory>
#include <optional>

#include "batch_queue.hpp"
#include "child_process.hpp"

namespace dynasurf::app {

/// A study of a batch in its process.
struct RunningStudy {
  using Clock = std::chrono::steady_clock;
  std::size_t study = 0;  // of the queue
  cohort::StudyStatus row;
  Clock::time_point begin;
  std::unique_ptr<ChildProgram> child;             // none where its input cannot be read: the row says why
  std::optional<Clock::time_point> asked_to_stop;  // since when
};

/// Starts study n of the queue. Throws IoError when the program cannot be started.
RunningStudy start_study(StudyQueue& queue, std::size_t n, int attempt, const BatchJob& job);

}  // namespace dynasurf::app
