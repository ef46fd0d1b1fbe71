// Rocks over pictures: numbers stay, what flickers is not believed.
#include "find_rocks/rock_tracker.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::find_rocks {
namespace {

SeenRock rock(double x_m, double y_m) {
  return {x_m, y_m, -1.0, 0.5, 0.3, 100, 1.0, {}};
}

TEST(FindRocksTracker, ARockIsBelievedAfterThreePicturesAndKeepsItsNumber) {
  RockTracker tracker;
  tracker.update({rock(6.0, 1.0)});
  tracker.update({rock(6.1, 1.05)});
  EXPECT_TRUE(tracker.rocks().empty());
  for (int i = 0; i < 20; ++i) {
    tracker.update({rock(6.0 + 0.1 * (i % 2), 1.0), rock(9.0, -2.0)});
  }
  const auto rocks = tracker.rocks();
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_EQ(rocks[0].number, 1U);
  EXPECT_NEAR(rocks[0].x_m, 6.05, 0.05);
  EXPECT_EQ(rocks[0].confidence(), 1.0);
  EXPECT_EQ(rocks[1].number, 2U);
}

TEST(FindRocksTracker, WhatIsSeenOnceInAWhileIsNotBelieved) {
  RockTracker tracker;
  for (int i = 0; i < 60; ++i) {
    tracker.update(i % 6 == 0 ? std::vector{rock(7.0, 0.0)} : std::vector<SeenRock>{});
    EXPECT_TRUE(tracker.rocks().empty());
  }
  EXPECT_EQ(tracker.numbers(), 0U);
}

TEST(FindRocksTracker, ARockThatIsGoneIsForgotten) {
  RockTracker tracker;
  for (int i = 0; i < 10; ++i) {
    tracker.update({rock(6.0, 0.0)});
  }
  for (int i = 0; i < 7; ++i) {
    tracker.update({});
  }
  ASSERT_EQ(tracker.rocks().size(), 1U);
  EXPECT_NEAR(tracker.rocks()[0].confidence(), 0.3, 1e-9);
  tracker.update({});
  EXPECT_TRUE(tracker.rocks().empty());
}

TEST(FindRocksTracker, NeighboursAreNotMixedUp) {
  RockTracker tracker;
  for (int i = 0; i < 10; ++i) {
    tracker.update({rock(6.0, 0.3), rock(6.0, -0.3)});
  }
  const auto rocks = tracker.rocks();
  ASSERT_EQ(rocks.size(), 2U);
  EXPECT_NEAR(std::abs(rocks[0].y_m - rocks[1].y_m), 0.6, 1e-9);
}

}  // namespace
}  // namespace rigwire::find_rocks
