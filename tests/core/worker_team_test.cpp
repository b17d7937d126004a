#include "dynasurf/core/detail/worker_team.hpp"

#include <atomic>
#include <latch>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dynasurf::detail {
namespace {

/// A team with helpers that have come.
struct Helped {
  explicit Helped(int helpers) {
    for (int n = 0; n < helpers; ++n) threads.emplace_back([this] { team.help(); });
    while (team.helpers() < helpers) std::this_thread::yield();
  }
  ~Helped() { team.dismiss(); }

  WorkerTeam team{};
  std::vector<std::jthread> threads{};
};

TEST(WorkerTeam, WithoutHelpersTakesThePiecesInTheirOrder) {
  WorkerTeam team;
  std::vector<std::size_t> order;
  team.run(5, [&](std::size_t p) { order.push_back(p); });
  EXPECT_THAT(order, testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THROW(team.run(2, [](std::size_t) { throw std::runtime_error("piece"); }), std::runtime_error);
}

TEST(WorkerTeam, TakesEachPieceOnceAtTheSameTime) {
  Helped helped(3);
  std::vector<std::atomic<int>> taken(4096);
  for (int loop = 0; loop < 50; ++loop) helped.team.run(taken.size(), [&](std::size_t p) { ++taken[p]; });
  for (const std::atomic<int>& t : taken) ASSERT_EQ(t, 50);
  // Pieces that wait for each other end only where four threads are at them.
  std::latch all(4);
  helped.team.run(4, [&](std::size_t) { all.arrive_and_wait(); });
}

TEST(WorkerTeam, TakesLoopsWithinPieces) {
  Helped helped(3);
  for (int loop = 0; loop < 20; ++loop) {
    std::vector<long> sums(7);
    helped.team.run(sums.size(), [&](std::size_t outer) {
      std::atomic<long> sum = 0;
      helped.team.run(100, [&](std::size_t inner) { sum += outer * inner; });
      sums[outer] = sum;
    });
    for (std::size_t outer = 0; outer < sums.size(); ++outer) ASSERT_EQ(sums[outer], 4950 * outer);
  }
}

TEST(WorkerTeam, ThrowsTheFailureOfAPieceToItsCallerOnceNoPieceRuns) {
  Helped helped(3);
  for (int loop = 0; loop < 50; ++loop) {
    std::atomic<int> running = 0;
    std::atomic<int> taken = 0;
    const auto fails_once = [&](std::size_t p) {
      ++running, ++taken;
      if (p == 5) {
        --running;
        throw std::runtime_error("piece 5");
      }
      std::this_thread::yield();
      --running;
    };
    EXPECT_THROW(helped.team.run(100000, fails_once), std::runtime_error);
    EXPECT_EQ(running, 0);
    EXPECT_LT(taken, 100000);
  }
  std::latch all(4);
  helped.team.run(4, [&](std::size_t) { all.arrive_and_wait(); });
}

TEST(WorkerTeam, KeepsToItsLimit) {
  Helped helped(3);
  const auto threads_of_a_loop = [&] {
    std::mutex guard;
    std::set<std::thread::id> seen;
    helped.team.run(64, [&](std::size_t) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      const std::lock_guard lock(guard);
      seen.insert(std::this_thread::get_id());
    });
    return seen.size();
  };
  EXPECT_EQ(helped.team.limit(1), 0);
  EXPECT_EQ(threads_of_a_loop(), 1);
  EXPECT_EQ(helped.team.limit(2), 1);
  EXPECT_LE(threads_of_a_loop(), 2);
  std::latch two(2);
  helped.team.run(2, [&](std::size_t) { two.arrive_and_wait(); });
  EXPECT_EQ(helped.team.limit(0), 2);
  std::latch all(4);
  helped.team.run(4, [&](std::size_t) { all.arrive_and_wait(); });
}

}  // namespace
}  // namespace dynasurf::detail
