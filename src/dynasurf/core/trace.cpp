#include "dynasurf/core/detail/trace.hpp"

#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

#include "dynasurf/core/detail/format.hpp"
#include "dynasurf/core/detail/run_pieces.hpp"
#include "dynasurf/core/error.hpp"

namespace dynasurf {
namespace {

double now_us() {
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

struct TraceState {
  struct Event {
    std::string stage{};  // empty for loops and pieces
    std::size_t loop = 0, pieces = 0;
    bool is_piece = false;
    int thread = 0;
    double begin_us = 0, end_us = 0;
  };
  std::mutex mutex;
  std::map<std::thread::id, int> threads;  // numbered from 1 as they come
  std::vector<Event> events;
  std::atomic<std::size_t> loops{0};

  void note(Event event) {
    // Before the lock: to wait for it is no part of the event.
    event.end_us = now_us();
    const std::lock_guard lock(mutex);
    event.thread = threads.emplace(std::this_thread::get_id(), threads.size() + 1).first->second;
    events.push_back(std::move(event));
  }
};

namespace {
std::atomic<TraceState*> current_trace{nullptr};
}

Trace::Trace() : state_(std::make_unique<TraceState>()) {
  TraceState* none = nullptr;
  [[maybe_unused]] const bool first = current_trace.compare_exchange_strong(none, state_.get());
  DYNASURF_ASSERT(first);
}

Trace::~Trace() { current_trace = nullptr; }

std::string Trace::json() const {
  std::string text = "{\"displayTimeUnit\": \"ms\", \"traceEvents\": [";
  const char* separator = "\n";
  for (const TraceState::Event& e : state_->events) {
    const std::string loop = std::to_string(e.loop);
    const std::string words = !e.stage.empty() ? R"("cat": "stage", "name": ")" + e.stage + "\""
                              : e.is_piece     ? R"("cat": "piece", "name": "piece", "args": {"loop": )" + loop + "}"
                                               : R"("cat": "loop", "name": "loop", "args": {"loop": )" + loop +
                                                 ", \"pieces\": " + std::to_string(e.pieces) + "}";
    text += separator + std::string(R"({"ph": "X", "pid": 1, "tid": )") + std::to_string(e.thread) +
            ", \"ts\": " + format("%.3f", e.begin_us) + ", \"dur\": " + format("%.3f", e.end_us - e.begin_us) + ", " +
            words + "}";
    separator = ",\n";
  }
  return text + "\n]}\n";
}

TraceStage::TraceStage(std::string_view name) {
  if (!current_trace.load(std::memory_order_acquire)) return;
  name_ = name;
  begin_us_ = now_us();
}

TraceStage::~TraceStage() {
  TraceState* trace = current_trace.load(std::memory_order_acquire);
  if (trace && !name_.empty()) trace->note({.stage = name_, .begin_us = begin_us_});
}

void detail::run_noted_pieces(std::size_t pieces, const std::function<void(std::size_t)>& piece) {
  TraceState* trace = current_trace.load(std::memory_order_acquire);
  if (!trace) {
    run_pieces(pieces, piece);
    return;
  }
  const std::size_t loop = ++trace->loops;
  const double begin_us = now_us();
  run_pieces(pieces, [&](std::size_t p) {
    const double piece_begin_us = now_us();
    piece(p);
    trace->note({.loop = loop, .is_piece = true, .begin_us = piece_begin_us});
  });
  trace->note({.loop = loop, .pieces = pieces, .begin_us = begin_us});
}

}  // namespace dynasurf
