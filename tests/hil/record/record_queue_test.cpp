#include "hil/record/record_queue.h"

#include <gtest/gtest.h>

#include <thread>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

std::vector<std::uint8_t> bytes(std::size_t size, std::uint8_t value) {
  return std::vector<std::uint8_t>(size, value);
}

TEST(RecordQueue, WhatIsPutIsTakenInItsOrder) {
  RecordQueue queue(4096, 0ms);
  for (std::uint8_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(queue.put({i, static_cast<std::uint8_t>(i + 10), kStart + 1ms * i, bytes(i, i)}));
  }
  const RecordQueue::Taken& taken = queue.take(0ms);
  ASSERT_EQ(taken.entries.size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(taken.entries[i].track, i);
    EXPECT_EQ(taken.entries[i].flags, i + 10);
    EXPECT_EQ(taken.entries[i].at, kStart + 1ms * static_cast<int>(i));
    EXPECT_EQ(taken.entries[i].bytes.size(), i);
  }
  EXPECT_TRUE(queue.take(0ms).entries.empty());
}

TEST(RecordQueue, WhatHasNoRoomIsCountedByTrackAndNobodyWaits) {
  RecordQueue queue(1024, 0ms);
  EXPECT_TRUE(queue.put({0, 0, kStart, bytes(900, 1)}));
  EXPECT_FALSE(queue.put({3, 0, kStart, bytes(900, 1)}));
  EXPECT_FALSE(queue.put({3, 0, kStart, bytes(900, 1)}));
  EXPECT_FALSE(queue.put({1, 0, kStart, bytes(900, 1)}));
  const RecordQueue::Taken& taken = queue.take(0ms);
  EXPECT_EQ(taken.entries.size(), 1U);
  EXPECT_EQ(taken.lost, (std::vector<std::uint64_t>{0, 1, 0, 2}));
  EXPECT_TRUE(queue.put({3, 0, kStart, bytes(900, 1)}));
  EXPECT_TRUE(queue.take(0ms).lost.empty());
}

TEST(RecordQueue, SimulatedTimeMayWaitForTheWriter) {
  RecordQueue queue(1024, 10s);
  EXPECT_TRUE(queue.put({0, 0, kStart, bytes(900, 1)}));
  std::thread writer([&] { EXPECT_EQ(queue.take(1s).entries.size(), 1U); });
  EXPECT_TRUE(queue.put({0, 0, kStart, bytes(900, 2)}));
  writer.join();
  EXPECT_EQ(queue.take(0ms).entries[0].bytes[0], 2);
}

TEST(RecordQueue, AWriterThatDoesNotComeIsWaitedForOnce) {
  RecordQueue queue(1024, 50ms);
  EXPECT_TRUE(queue.put({0, 0, kStart, bytes(900, 1)}));
  EXPECT_FALSE(queue.put({0, 0, kStart, bytes(900, 1)}));
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 100; ++i) {
    EXPECT_FALSE(queue.put({0, 0, kStart, bytes(900, 1)}));
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 2s) << "100 x 50 ms if each waited";
}

TEST(RecordQueue, CloseWakesTheWriter) {
  RecordQueue queue(1024, 0ms);
  std::thread writer([&] { EXPECT_TRUE(queue.take(1h).entries.empty()); });
  queue.close();
  writer.join();
  EXPECT_TRUE(queue.closed());
}

}  // namespace
}  // namespace rigwire::hil
