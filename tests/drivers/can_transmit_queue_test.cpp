#include "drivers/can_transmit_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <vector>

namespace rigwire::drivers {
namespace {

using testing::ElementsAre;

/// An interface that answers what the test says.
class TransmitQueue : public testing::Test {
 protected:
  bool offer(canid_t id) {
    can_frame frame{};
    frame.can_id = id;
    return queue_.offer(frame);
  }
  int answer_ = 0;
  std::vector<canid_t> taken_;
  CanTransmitQueue queue_{3, [this](const can_frame& frame) {
                            if (answer_ == 0) {
                              taken_.push_back(frame.can_id);
                            }
                            return answer_;
                          }};
};

TEST_F(TransmitQueue, FramesWaitWhileTheInterfaceIsFullAndLeaveInOrder) {
  answer_ = ENOBUFS;
  EXPECT_TRUE(offer(1));
  answer_ = 0;
  EXPECT_TRUE(offer(2)) << "behind the first, although there would be room now";
  EXPECT_TRUE(taken_.empty());
  EXPECT_TRUE(queue_.waiting());
  queue_.retry();
  EXPECT_THAT(taken_, ElementsAre(1, 2));
  EXPECT_FALSE(queue_.waiting());
  EXPECT_EQ(queue_.counters().sent, 2U);
  EXPECT_EQ(queue_.counters().waited, 2U);
  EXPECT_EQ(queue_.counters().lost(), 0U);
}

TEST_F(TransmitQueue, WhatDoesNotFitIsLostAndCounted) {
  answer_ = ENOBUFS;
  EXPECT_TRUE(offer(1));
  EXPECT_TRUE(offer(2));
  EXPECT_TRUE(offer(3));
  EXPECT_FALSE(offer(4));
  queue_.retry();
  EXPECT_TRUE(queue_.waiting());
  EXPECT_EQ(queue_.counters().overflown, 1U);
  answer_ = 0;
  queue_.retry();
  EXPECT_THAT(taken_, ElementsAre(1, 2, 3));
}

TEST_F(TransmitQueue, InterfaceThatGoesDownTakesWhatWaitsWithIt) {
  answer_ = ENOBUFS;
  EXPECT_TRUE(offer(1));
  EXPECT_TRUE(offer(2));
  answer_ = ENETDOWN;
  queue_.retry();
  EXPECT_FALSE(queue_.waiting());
  EXPECT_EQ(queue_.link(), CanLink::down);
  EXPECT_FALSE(offer(3));
  EXPECT_EQ(queue_.counters().down, 3U);
  answer_ = 0;
  EXPECT_TRUE(offer(4));
  EXPECT_EQ(queue_.link(), CanLink::up);
  EXPECT_THAT(taken_, ElementsAre(4)) << "nothing stale";
}

TEST_F(TransmitQueue, EveryReasonHasItsCounter) {
  for (const int error : {EPERM, EINVAL, EMSGSIZE, ENXIO, ENODEV, ENETUNREACH}) {
    answer_ = error;
    EXPECT_FALSE(offer(1));
  }
  EXPECT_EQ(queue_.counters().forbidden, 1U);
  EXPECT_EQ(queue_.counters().failed, 2U);
  EXPECT_EQ(queue_.counters().down, 3U);
  EXPECT_EQ(queue_.counters().lost(), 6U);
}

TEST_F(TransmitQueue, RemovedInterfaceIsGone) {
  answer_ = ENXIO;
  EXPECT_FALSE(offer(1));
  EXPECT_EQ(queue_.link(), CanLink::gone);
}

}  // namespace
}  // namespace rigwire::drivers
