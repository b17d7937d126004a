#include "dynasurf/core/detail/stage_clock.hpp"

#include <thread>

#include <gtest/gtest.h>

namespace dynasurf {
namespace {

void rest_ms(int ms) { std::this_thread::sleep_for(std::chrono::milliseconds(ms)); }

TEST(StageClock, AddsUpAStageThatIsEnteredTwiceInTheOrderOfFirstAppearance) {
  std::vector<std::pair<std::string, double>> seconds;
  StageClock clock(seconds);
  const auto begin = std::chrono::steady_clock::now();
  clock.enter("read"), rest_ms(4);
  clock.enter("fit"), rest_ms(2);
  clock.enter("fit"), rest_ms(2);
  clock.enter("read"), rest_ms(4);
  clock.stop();
  const std::chrono::duration<double> walked = std::chrono::steady_clock::now() - begin;
  rest_ms(50);  // belongs to no stage
  clock.stop();
  ASSERT_EQ(seconds.size(), 2u);
  EXPECT_EQ(seconds[0].first, "read");
  EXPECT_EQ(seconds[1].first, "fit");
  EXPECT_GE(seconds[0].second, 0.008);  // sleeps last no shorter than asked for
  EXPECT_GE(seconds[1].second, 0.004);
  EXPECT_LE(seconds[0].second + seconds[1].second, walked.count());
}

TEST(StageClock, AddsUpTheWorkOfSeveralThreadsAndHandsItsResultOn) {
  std::vector<std::pair<std::string, double>> seconds;
  StageClock clock(seconds);
  std::vector<std::jthread> threads;
  for (int n = 0; n < 3; ++n) threads.emplace_back([&] { clock("fit", [] { return rest_ms(10), 0; }); });
  threads.clear();
  EXPECT_EQ(clock("edges", [] { return 7; }), 7);
  ASSERT_EQ(seconds.size(), 2u);
  EXPECT_GE(seconds[0].second, 0.03);
}

}  // namespace
}  // namespace dynasurf
