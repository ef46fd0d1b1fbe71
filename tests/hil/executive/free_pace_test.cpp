#include "hil/executive/free_pace.h"

#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

class FreePaceTest : public testing::Test {
 protected:
  /// The wall time from `wall_` on at which it lets go of that instant, looked at every 0.1 ms.
  Duration let_go_after(SimTime now) {
    for (Duration waited{0}; waited < 10s; waited += 100us) {
      if (pace_.lets_go(now, wall_ + waited)) {
        wall_ += waited;
        return waited;
      }
    }
    ADD_FAILURE() << "never";
    return 10s;
  }

  FreePace pace_{2.0};
  WallTime wall_{1h};
};

TEST_F(FreePaceTest, ASliceTakesItsLengthOverTheFactor) {
  EXPECT_TRUE(pace_.lets_go(kStart, wall_));
  let_go_after(kStart + 100ms);  // the start is made up
  EXPECT_EQ(let_go_after(kStart + 110ms), 5ms);
  EXPECT_EQ(let_go_after(kStart + 130ms), 10ms);
  pace_.set_factor(0.5);
  EXPECT_EQ(let_go_after(kStart + 140ms), 20ms);
}

TEST_F(FreePaceTest, ManySlicesTakeNoLongerThanTheirSum) {
  EXPECT_TRUE(pace_.lets_go(kStart, wall_));
  let_go_after(kStart + 100ms);
  const WallTime begin = wall_;
  for (int i = 1; i <= 1000; ++i) {
    let_go_after(kStart + 100ms + i * 1234us);  // looks are never at the deadline itself
  }
  EXPECT_GE(wall_ - begin, 617ms);
  EXPECT_LE(wall_ - begin, 617ms + 100us);
}

TEST_F(FreePaceTest, TimeThatStoodIsNotMadeUp) {
  EXPECT_TRUE(pace_.lets_go(kStart, wall_));
  let_go_after(kStart + 100ms);
  wall_ += 1h;
  const WallTime begin = wall_;
  for (int i = 1; i <= 100; ++i) {
    let_go_after(kStart + 100ms + i * 10ms);
  }
  EXPECT_GE(wall_ - begin, 500ms - FreePace::kMadeUp - 5ms);
}

TEST_F(FreePaceTest, WhatIsHastenedTakesNoTimeAndWhatFollowsItsOwn) {
  EXPECT_TRUE(pace_.lets_go(kStart, wall_));
  pace_.hasten(kStart + 1h);
  EXPECT_EQ(let_go_after(kStart + 10min), 0s);
  EXPECT_EQ(let_go_after(kStart + 1h - 10ms), 0s);
  EXPECT_EQ(let_go_after(kStart + 1h), 5ms);
  EXPECT_EQ(let_go_after(kStart + 1h + 10ms), 5ms);
}

}  // namespace
}  // namespace rigwire::hil
