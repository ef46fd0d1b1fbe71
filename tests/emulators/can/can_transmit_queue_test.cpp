#include "emulators/can/can_transmit_queue.h"

#include <gtest/gtest.h>

#include <vector>

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;

protocols::can::Frame frame(std::uint32_t id) {
  return {id, false, false, 0, {}};
}

std::vector<std::uint32_t> drained(CanTransmitQueue& queue, SimTime now) {
  std::vector<std::uint32_t> ids;
  while (queue.ready() <= now) {
    EXPECT_EQ(queue.front(now).frame.id, queue.front(now).frame.id);
    ids.push_back(queue.take(now).frame.id);
  }
  return ids;
}

TEST(CanTransmitQueue, FifoKeepsTheOrderOfArrival) {
  CanTransmitQueue queue(4, CanQueueOrder::fifo);
  for (const std::uint32_t id : {3U, 1U, 2U}) {
    ASSERT_TRUE(queue.push(kStart, frame(id)));
  }
  EXPECT_EQ(drained(queue, kStart), (std::vector<std::uint32_t>{3, 1, 2}));
}

TEST(CanTransmitQueue, PriorityGivesTheMostUrgentOfThoseThatAreDue) {
  CanTransmitQueue queue(8, CanQueueOrder::priority);
  ASSERT_TRUE(queue.push(kStart, frame(3)));
  ASSERT_TRUE(queue.push(kStart, frame(2)));
  ASSERT_TRUE(queue.push(kStart + 1ms, frame(1)));
  EXPECT_EQ(queue.front(kStart).frame.id, 2U);
  EXPECT_EQ(drained(queue, kStart + 1ms), (std::vector<std::uint32_t>{1, 2, 3}));
  EXPECT_EQ(queue.ready(), kNever);
}

TEST(CanTransmitQueue, EqualIdentifiersKeepTheirOrderAlsoAfterAFailure) {
  CanTransmitQueue queue(4, CanQueueOrder::priority);
  for (std::uint8_t i = 0; i < 3; ++i) {
    protocols::can::Frame any = frame(7);
    any.length = i;
    ASSERT_TRUE(queue.push(kStart, any));
  }
  const CanWaitingFrame first = queue.take(kStart);
  queue.put_back(first);
  for (std::uint8_t i = 0; i < 3; ++i) {
    EXPECT_EQ(queue.take(kStart).frame.length, i);
  }
}

TEST(CanTransmitQueue, HoldsItsCapacityBesidesTheOneThatWasTaken) {
  for (const auto order : {CanQueueOrder::fifo, CanQueueOrder::priority}) {
    CanTransmitQueue queue(2, order);
    EXPECT_TRUE(queue.push(kStart, frame(1)));
    EXPECT_TRUE(queue.push(kStart, frame(2)));
    EXPECT_FALSE(queue.push(kStart, frame(3)));
    const CanWaitingFrame taken = queue.take(kStart);
    EXPECT_TRUE(queue.push(kStart, frame(4)));
    queue.put_back(taken);
    EXPECT_FALSE(queue.push(kStart, frame(5)));
    EXPECT_EQ(drained(queue, kStart), (std::vector<std::uint32_t>{1, 2, 4}));
  }
}

TEST(CanTransmitQueue, IsReadyWhenItsFirstFrameIsDue) {
  for (const auto order : {CanQueueOrder::fifo, CanQueueOrder::priority}) {
    CanTransmitQueue queue(2, order);
    EXPECT_EQ(queue.ready(), kNever);
    ASSERT_TRUE(queue.push(kStart + 5ms, frame(1)));
    EXPECT_EQ(queue.ready(), kStart + 5ms);
  }
}

}  // namespace
}  // namespace rigwire::emulators
