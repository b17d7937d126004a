#include "dynasurf/core/detail/trace.hpp"

#include <map>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "dynasurf/core/detail/stage_clock.hpp"
#include "dynasurf/core/parallel.hpp"

namespace dynasurf {
namespace {

using nlohmann::json;

std::map<std::string, std::vector<json>> by_kind(const Trace& trace) {
  std::map<std::string, std::vector<json>> kinds;
  const json all = json::parse(trace.json());
  for (const json& event : all["traceEvents"]) kinds[event["cat"]].push_back(event);
  return kinds;
}
double end_of(const json& event) { return event["ts"].get<double>() + event["dur"].get<double>(); }

// Times are written to the nanosecond.
constexpr double rounding_us = 0.002;

TEST(Trace, NotesEveryPieceWithinItsLoopAndStage) {
  const Trace trace;
  std::vector<std::pair<std::string, double>> seconds;
  StageClock clock(seconds);
  clock("outer", [] {
    parallel_for(20, 5, [](std::size_t, std::size_t) {
      parallel_for(3, 1, [](std::size_t, std::size_t) { std::this_thread::sleep_for(std::chrono::milliseconds(1)); });
    });
    return 0;
  });
  auto kinds = by_kind(trace);
  ASSERT_EQ(kinds["stage"].size(), 1U);
  const json& stage = kinds["stage"].front();
  EXPECT_EQ(stage["name"], "outer");
  ASSERT_EQ(kinds["loop"].size(), 1U + 4U);
  std::map<int, std::size_t> pieces;
  for (const json& piece : kinds["piece"]) {
    ++pieces[piece["args"]["loop"]];
    EXPECT_GE(piece["ts"].get<double>(), stage["ts"].get<double>() - rounding_us);
    EXPECT_LE(end_of(piece), end_of(stage) + rounding_us);
    EXPECT_GE(piece["dur"].get<double>(), 1000);
  }
  for (const json& loop : kinds["loop"]) EXPECT_EQ(pieces[loop["args"]["loop"]], loop["args"]["pieces"]);
}

TEST(Trace, TellsThePiecesOfOneThreadOneAfterTheOther) {
  const ThreadLimit limit(4);
  const Trace trace;
  parallel_for(64, 1, [](std::size_t, std::size_t) { std::this_thread::sleep_for(std::chrono::microseconds(200)); });
  std::map<int, std::map<double, double>> spans;
  const auto kinds = by_kind(trace);
  for (const json& piece : kinds.at("piece")) spans[piece["tid"]][piece["ts"]] = end_of(piece);
  std::size_t count = 0;
  for (const auto& [thread, times] : spans) {
    double last = 0;
    for (const auto& [begin, end] : times) {
      EXPECT_GE(begin, last - rounding_us) << "thread " << thread;
      last = end;
      ++count;
    }
  }
  EXPECT_EQ(count, 64U);
}

TEST(Trace, NotesTheWalkFromStageToStage) {
  const Trace trace;
  std::vector<std::pair<std::string, double>> seconds;
  StageClock clock(seconds);
  for (const char* stage : {"read", "read", "fit", "write"}) clock.enter(stage);
  clock.stop();
  std::vector<std::string> names;
  const auto kinds = by_kind(trace);
  for (const json& stage : kinds.at("stage")) names.push_back(stage["name"]);
  EXPECT_EQ(names, (std::vector<std::string>{"read", "fit", "write"}));
}

TEST(Trace, IsOverWhenItEnds) {
  { const Trace first; }
  parallel_for(4, 1, [](std::size_t, std::size_t) {});
  const Trace second;
  EXPECT_TRUE(by_kind(second).empty());
}

}  // namespace
}  // namespace dynasurf
