#include "sim/lidar/worker_pool.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace rigwire::sim {
namespace {

TEST(WorkerPool, EveryTaskRunsOnceWhateverTheThreadsAndTheirPriority) {
  for (const PoolPriority priority : {PoolPriority::as_starter, PoolPriority::spare_time}) {
    for (const int threads : {1, 2, 5}) {
      WorkerPool pool(threads, priority);
      for (int round = 0; round < 300; ++round) {
        std::array<std::atomic<int>, 97> times{};
        pool.run(times.size(), [&times](std::size_t i) { ++times[i]; });
        for (const std::atomic<int>& count : times) {
          ASSERT_EQ(count, 1);
        }
      }
      pool.run(0, [](std::size_t) { FAIL(); });
    }
  }
}

TEST(WorkerPool, SpareTimeThreadsThatGetNoneDoNotStopIt) {
  // There are as many threads that never rest as processors.
  std::atomic<bool> over{false};
  std::vector<std::thread> others;
  for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i) {
    others.emplace_back([&over] {
      while (!over) {
      }
    });
  }
  WorkerPool pool(3, PoolPriority::spare_time);
  std::atomic<int> sum{0};
  for (int round = 0; round < 100; ++round) {
    pool.run(50, [&sum](std::size_t) {
      ++sum;
      std::this_thread::yield();
    });
  }
  over = true;
  for (std::thread& other : others) {
    other.join();
  }
  EXPECT_EQ(sum, 5000);
}

}  // namespace
}  // namespace rigwire::sim
