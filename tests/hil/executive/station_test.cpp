#include "hil/executive/station.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

TEST(SampleInbox, KeepsOrderAndGivesTheNextInstant) {
  SampleInbox<ImuSample> inbox;
  EXPECT_EQ(inbox.next(), kNever);
  inbox.put({kStart + 1ms, {}, {}, 0.0});
  inbox.put({kStart + 2ms, {}, {}, 0.0});
  EXPECT_EQ(inbox.take().time, kStart + 1ms);
  inbox.put({kStart + 3ms, {}, {}, 0.0});
  EXPECT_EQ(inbox.take().time, kStart + 2ms);
  EXPECT_EQ(inbox.next(), kStart + 3ms);
}

TEST(SampleInbox, DoesNotGrowWhileItIsNeverQuiteEmpty) {
  SampleInbox<ImuSample> inbox;
  for (int i = 0; i < 5; ++i) {
    inbox.put({kStart + i * 1ms, {}, {}, 0.0});
  }
  for (int i = 5; i < 1'000'000; ++i) {
    inbox.put({kStart + i * 1ms, {}, {}, 0.0});
    ASSERT_EQ(inbox.take().time, kStart + (i - 5) * 1ms);
  }
  EXPECT_LE(inbox.capacity(), 32U);
}

}  // namespace
}  // namespace rigwire::hil
