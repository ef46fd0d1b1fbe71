#include "hil/wires/emission_queue.h"

#include <gtest/gtest.h>

#include <deque>
#include <random>
#include <vector>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using Bytes = std::vector<std::uint8_t>;

Bytes copy(std::span<const std::uint8_t> bytes) {
  return {bytes.begin(), bytes.end()};
}

TEST(EmissionQueue, KeepsOrderDueTimeAndTag) {
  EmissionQueue queue(4, 64);
  WireStatistics statistics;
  EXPECT_EQ(queue.next_due(), kNever);
  ASSERT_TRUE(queue.push(kStart + 1ms, 7, statistics, Bytes{1, 2, 3}));
  ASSERT_TRUE(queue.push(kStart + 2ms, 8, statistics, Bytes{}));
  EXPECT_EQ(queue.next_due(), kStart + 1ms);
  EXPECT_EQ(queue.front().tag, 7U);
  EXPECT_EQ(copy(queue.front().bytes), (Bytes{1, 2, 3}));
  queue.pop();
  EXPECT_EQ(queue.front().due, kStart + 2ms);
  EXPECT_TRUE(queue.front().bytes.empty());
}

TEST(EmissionQueue, CountsAsDroppedWhatDoesNotFit) {
  EmissionQueue queue(2, 8);
  WireStatistics statistics;
  EXPECT_FALSE(queue.push(kStart, 0, statistics, Bytes(9)));
  EXPECT_TRUE(queue.push(kStart, 0, statistics, Bytes(8)));
  EXPECT_FALSE(queue.push(kStart, 0, statistics, Bytes(1)));
  EXPECT_EQ(statistics.dropped, 2U);
  queue.pop();
  EXPECT_TRUE(queue.push(kStart, 0, statistics, Bytes(8)));
}

TEST(EmissionQueue, BehavesAsADequeUnderAMillionRandomOperations) {
  EmissionQueue queue(16, 200);
  WireStatistics statistics;
  std::deque<Bytes> model;
  std::mt19937 random(1);
  std::uint8_t next = 0;
  std::size_t pushed = 0;
  for (int i = 0; i < 1'000'000; ++i) {
    if (random() % 2 == 0) {
      Bytes bytes(random() % 40);
      for (auto& byte : bytes) {
        byte = next++;
      }
      if (queue.push(kStart, 0, statistics, bytes)) {
        model.push_back(bytes);
        ++pushed;
      }
    } else if (!model.empty()) {
      ASSERT_EQ(copy(queue.front().bytes), model.front()) << "operation " << i;
      queue.pop();
      model.pop_front();
    }
    ASSERT_EQ(queue.empty(), model.empty());
  }
  EXPECT_GT(pushed, 100'000U);
  EXPECT_GT(statistics.dropped, 1000U);
}

}  // namespace
}  // namespace rigwire::hil
