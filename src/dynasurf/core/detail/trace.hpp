#pragma once
#include <memory>
#include <string>
#include <string_view>

namespace dynasurf {

struct TraceState;

/// While it lives, stages and the pieces of parallel loops note when they begin and end, and on which thread. One at a
/// time; loops that began before it are not in it.
class Trace {
 public:
  Trace();
  ~Trace();
  Trace(const Trace&) = delete;
  Trace& operator=(const Trace&) = delete;

  /// What was noted so far, as trace events that ui.perfetto.dev and chrome://tracing open: `cat` is stage, loop (with
  /// its number of pieces) or piece (with its loop), `ts` and `dur` are microseconds of the steady clock. No loop may
  /// run.
  std::string json() const;

 private:
  std::unique_ptr<TraceState> state_;
};

/// Notes its lifetime as a stage of the trace that is there, if any.
class TraceStage {
 public:
  explicit TraceStage(std::string_view name);
  ~TraceStage();
  TraceStage(const TraceStage&) = delete;
  TraceStage& operator=(const TraceStage&) = delete;

 private:
  std::string name_;
  double begin_us_ = 0;
};

}  // namespace dynasurf
