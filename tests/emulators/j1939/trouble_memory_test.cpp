// Trouble codes: occurrences, what was and what is, when the active ones are due.
#include "emulators/j1939/trouble_memory.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>

#include "protocols/j1939/message.h"

namespace rigwire::emulators {
namespace {

using protocols::vehicle::FailureMode;
using protocols::vehicle::TroubleCode;

constexpr std::array kKinds{TroubleMemory::Kind{695, FailureMode::abnormal_update_rate},
                            TroubleMemory::Kind{525, FailureMode::received_data_in_error}};

TEST(TroubleMemory, EachTimeThatItComesIsAnOccurrence) {
  TroubleMemory memory(kKinds);
  for (int i = 0; i < 3; ++i) {
    memory.set(0, true);
    memory.set(0, true);  // still the same
    memory.set(0, false);
  }
  EXPECT_EQ(memory.active().count, 0U);
  ASSERT_EQ(memory.previous().count, 1U);
  EXPECT_EQ(memory.previous().codes[0], (TroubleCode{695, 9, 3}));
  for (int i = 0; i < 200; ++i) {
    memory.set(0, true);
    memory.set(0, false);
  }
  EXPECT_EQ(memory.previous().codes[0].occurrences, 126) << "127 is not available";
}

TEST(TroubleMemory, ClearingForgetsWhatWasAndKeepsWhatIs) {
  TroubleMemory memory(kKinds);
  memory.set(0, true);
  memory.set(0, false);
  memory.set(0, true);
  memory.set(1, true);
  memory.set(1, false);
  memory.clear_previous();
  EXPECT_EQ(memory.previous().count, 0U);
  ASSERT_EQ(memory.active().count, 1U);
  EXPECT_EQ(memory.active().codes[0].occurrences, 2);
  memory.clear_active();
  EXPECT_EQ(memory.active().codes[0].occurrences, 1);
}

/// A node that holds its address, and what it sends.
class Node final : J1939Application, FrameOutput {
 public:
  Node() { node.advance(now); }

  /// DM1 that leave in ticks up to `end`, without it.
  int reports_until(TroubleMemory& memory, std::uint64_t end) {
    for (; tick_ < end; ++tick_) {
      now += TroubleMemory::kTick;
      node.advance(now);
      memory.send_due(node, now, tick_);
    }
    return reports_;
  }

  SimTime now = kStart + std::chrono::seconds{1};
  J1939Node node{settings(), *this, *this};

 private:
  static J1939NodeSettings settings() {
    J1939NodeSettings settings;
    settings.address.preferred = 0x20;
    settings.address.name = 1;
    settings.address.first_claim = kStart;
    return settings;
  }
  J1939Answer answer(SimTime, std::uint32_t, std::uint8_t) override { return J1939Answer::unknown; }
  J1939Reception take(SimTime, const J1939Message&) override { return J1939Reception::ignored; }
  void send(SimTime, const protocols::can::Frame& frame) override {
    // Itself, or the announcement of its transport: its group closes the frame.
    const std::uint32_t group = (frame.id >> 8U) & 0xFFFFU;
    const bool announced = group == 0xECFF && frame.data[5] == 0xCA && frame.data[6] == 0xFE;
    reports_ += group == protocols::vehicle::kDm1Pgn || announced ? 1 : 0;
  }

  std::uint64_t tick_ = 0;
  int reports_ = 0;
};

TEST(TroubleMemory, AChangeIsDueAtOnceButNotTwiceWithinASecond) {
  TroubleMemory memory(kKinds);
  Node node;
  ASSERT_TRUE(node.node.held());
  EXPECT_EQ(node.reports_until(memory, 60), 1) << "the one of every second";
  memory.set(0, true);
  EXPECT_EQ(node.reports_until(memory, 61), 2) << "at once";
  memory.set(0, false);
  EXPECT_EQ(node.reports_until(memory, 150), 2) << "less than a second after the last change";
  EXPECT_EQ(node.reports_until(memory, 151), 3) << "the one of every second, which tells it";
  EXPECT_EQ(node.reports_until(memory, 200), 3);
}

TEST(TroubleMemory, WhatCouldNotBeSentIsDueAgain) {
  TroubleMemory memory(kKinds);
  Node node;
  EXPECT_EQ(node.reports_until(memory, 49), 0);
  // Another long message is on its way for 100 ms.
  const std::array<std::uint8_t, 9> other{};
  ASSERT_EQ(node.node.send_answer(node.now, 0xFEDA, protocols::j1939::kGlobalAddress, other),
            J1939Answer::sent);
  memory.set(0, true);
  memory.set(1, true);  // two codes do not fit into a frame
  EXPECT_EQ(node.reports_until(memory, 55), 0);
  EXPECT_EQ(node.reports_until(memory, 70), 1) << "as soon as the transport is free";
  EXPECT_EQ(node.reports_until(memory, 140), 1);
}

TEST(TroubleMemory, RequestsAreAnsweredAndClearWhatTheyName) {
  TroubleMemory memory(kKinds);
  Node node;
  memory.set(0, true);
  memory.set(1, true);
  memory.set(1, false);
  const auto ask = [&](std::uint32_t pgn) { return memory.answer(node.node, node.now, pgn, 0xF9); };
  EXPECT_EQ(ask(protocols::vehicle::kDm1Pgn), J1939Answer::sent);
  EXPECT_EQ(ask(protocols::vehicle::kDm3Pgn), J1939Answer::sent);
  EXPECT_EQ(memory.previous().count, 0U);
  EXPECT_EQ(memory.active().count, 1U) << "DM3 clears what was";
  EXPECT_EQ(ask(protocols::vehicle::kDm11Pgn), J1939Answer::sent);
  EXPECT_EQ(memory.active().count, 1U) << "nothing is mended by it";
  EXPECT_FALSE(ask(0xFEE5).has_value());
}

}  // namespace
}  // namespace rigwire::emulators
