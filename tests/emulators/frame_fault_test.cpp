// What becomes of a node's frames while a fault of theirs holds, and that nothing does before and
// after.
#include "emulators/frame_fault.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <vector>

#include "recorder.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
using protocols::can::Frame;
using rigwire::test::FrameRecorder;
using Sent = std::vector<std::pair<SimTime, Frame>>;

Frame numbered(int i) {
  Frame frame;
  frame.id = 0x100U + static_cast<unsigned>(i % 2);
  frame.length = 8;
  frame.data[0] = static_cast<std::uint8_t>(i);
  return frame;
}

/// 100 frames, each 10 ms; what came out.
Sent through(const std::vector<FrameFault>& faults) {
  FrameRecorder output;
  FaultyFrames frames(faults, 1, output);
  for (int i = 0; i < 100; ++i) {
    frames.send(kStart + i * 10ms, numbered(i));
  }
  return output.frames;
}

const FaultPeriod kThirdToSixth{.at = 300ms, .length = 300ms};

Sent within(const Sent& all, Duration begin, Duration end) {
  Sent some;
  std::ranges::copy_if(all, std::back_inserter(some), [&](const auto& one) {
    return one.first >= kStart + begin && one.first < kStart + end;
  });
  return some;
}

TEST(FrameFault, LostFramesAreLostWhileItHolds) {
  const Sent sent = through({{kThirdToSixth, LostFramesFault{}}});
  EXPECT_EQ(sent.size(), 70U);
  EXPECT_TRUE(within(sent, 300ms, 600ms).empty());
}

TEST(FrameFault, AShareIsLost) {
  const std::size_t left = through({{FaultPeriod{}, LostFramesFault{{.share = 0.5}}}}).size();
  EXPECT_GT(left, 30U);
  EXPECT_LT(left, 70U);
}

TEST(FrameFault, RepeatedFramesComeTwice) {
  EXPECT_EQ(through({{kThirdToSixth, RepeatedFramesFault{}}}).size(), 130U);
}

TEST(FrameFault, OneBitOfACorruptedFrameIsTurnedOver) {
  const Sent sent = through({{kThirdToSixth, CorruptedFramesFault{}}});
  ASSERT_EQ(sent.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    const Frame& frame = sent[static_cast<std::size_t>(i)].second;
    int turned = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      turned += std::popcount(static_cast<unsigned>(frame.data[k] ^ numbered(i).data[k]));
    }
    EXPECT_EQ(turned, i >= 30 && i < 60 ? 1 : 0) << i;
  }
}

TEST(FrameFault, DelayedFramesLeaveLaterAndInTheirOrder) {
  const Sent sent = through({{kThirdToSixth, DelayedFramesFault{.delay = 50ms}}});
  ASSERT_EQ(sent.size(), 100U);
  EXPECT_EQ(sent[29].first, kStart + 290ms);
  EXPECT_EQ(sent[30].first, kStart + 350ms);
  EXPECT_TRUE(std::ranges::is_sorted(sent, {}, &std::pair<SimTime, Frame>::first));
  EXPECT_EQ(sent[99].first, kStart + 990ms) << "it caught up";
}

TEST(FrameFault, FrozenFramesRepeatTheFirstOfEachIdentifierInEachRepetition) {
  const Sent sent = through({{{.length = 200ms, .every = 500ms}, FrozenFramesFault{}}});
  ASSERT_EQ(sent.size(), 100U);
  for (int i = 0; i < 100; ++i) {
    const int first = i % 50 < 20 ? i / 50 * 50 + i % 2 : i;
    EXPECT_EQ(sent[static_cast<std::size_t>(i)].second, numbered(first)) << i;
  }
}

TEST(FrameFault, WhatDoesNotHoldDrawsNothing) {
  const Sent alone = through({{kThirdToSixth, CorruptedFramesFault{}}});
  const Sent beside = through(
      {{kThirdToSixth, CorruptedFramesFault{}}, {{.at = 5s}, LostFramesFault{{.share = 0.5}}}});
  EXPECT_EQ(alone, beside);
}

}  // namespace
}  // namespace rigwire::emulators
