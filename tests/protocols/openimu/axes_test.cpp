#include "protocols/openimu/axes.h"

#include <gtest/gtest.h>

namespace rigwire::protocols::openimu {
namespace {

using Triad = std::array<double, 3>;

Triad rates(const Triad& forward_left_up) {
  return map_axes(rate_axes(Behaviour::kDefault),
                  map_axes(kForwardLeftUpToDevice, forward_left_up));
}
Triad accelerations(const Triad& forward_left_up) {
  return map_axes(acceleration_axes(Behaviour::kDefault),
                  map_axes(kForwardLeftUpToDevice, forward_left_up));
}

TEST(Axes, NoseGoingUpIsPositivePitchRate) {
  // About the left axis a positive turn lowers the nose.
  EXPECT_EQ(rates({0.0, -1.0, 0.0}), (Triad{1.0, 0.0, 0.0}));
}

TEST(Axes, RightSideGoingDownIsPositiveRollRate) {
  EXPECT_EQ(rates({1.0, 0.0, 0.0}), (Triad{0.0, 1.0, 0.0}));
}

TEST(Axes, ClockwiseFromAboveIsPositiveYawRate) {
  EXPECT_EQ(rates({0.0, 0.0, -1.0}), (Triad{0.0, 0.0, 1.0}));
}

TEST(Axes, AccelerationsAreLeftForwardUp) {
  EXPECT_EQ(accelerations({1.0, 2.0, 9.81}), (Triad{2.0, 1.0, 9.81}));
}

TEST(Axes, ClearedBehaviourIsDownRightForwardInOrder) {
  const Triad device = map_axes(kForwardLeftUpToDevice, Triad{1.0, 2.0, 9.81});
  EXPECT_EQ(map_axes(acceleration_axes(0), device), (Triad{1.0, -2.0, -9.81}));
  EXPECT_EQ(map_axes(rate_axes(0), device), (Triad{1.0, -2.0, -9.81}));
}

TEST(Orientation, HasExactly24WordsAndTheLastIs016C) {
  unsigned legal = 0;
  unsigned last = 0;
  for (unsigned word = 0; word <= 0xFFFF; ++word) {
    if (orientation_axes(static_cast<std::uint16_t>(word))) {
      ++legal;
      last = word;
    }
  }
  EXPECT_EQ(legal, 24U);
  EXPECT_EQ(last, 0x016CU);
}

TEST(Orientation, KnownWords) {
  EXPECT_EQ(orientation_axes(0x0000), (AxisMap{{{0, 1.0}, {1, 1.0}, {2, 1.0}}}));
  EXPECT_EQ(orientation_axes(0x0009), (AxisMap{{{0, -1.0}, {1, -1.0}, {2, 1.0}}}));
  EXPECT_EQ(orientation_axes(0x0023), (AxisMap{{{1, -1.0}, {0, 1.0}, {2, 1.0}}}));
  EXPECT_FALSE(orientation_axes(0x0001));
}

}  // namespace
}  // namespace rigwire::protocols::openimu
