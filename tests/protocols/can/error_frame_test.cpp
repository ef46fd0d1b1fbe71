#include "protocols/can/error_frame.h"

#include <gtest/gtest.h>

#include <array>

namespace rigwire::protocols::can {
namespace {

using Bytes = std::array<std::uint8_t, 8>;

// Worked by hand from include/uapi/linux/can/error.h.
TEST(ErrorFrame, NoAcknowledgement) {
  ControllerReport report;
  report.error = BusError::acknowledgement;
  report.transmitting = true;
  report.field = FrameField::acknowledge_slot;
  report.transmit_errors = 8;
  const ErrorFrame frame = to_error_frame(report);
  EXPECT_EQ(frame.id, 0x200002A8U);
  EXPECT_EQ(frame.data, (Bytes{0, 0, 0x80, 0x19, 0, 0, 8, 0}));
}

TEST(ErrorFrame, PassiveByTheTransmitCounter) {
  ControllerReport report;
  report.state = ErrorState::passive;
  report.state_changed = true;
  report.transmit_errors = 128;
  report.receive_errors = 97;
  const ErrorFrame frame = to_error_frame(report);
  EXPECT_EQ(frame.id, 0x20000204U);
  EXPECT_EQ(frame.data, (Bytes{0, 0x20, 0, 0, 0, 0, 128, 97}));
}

TEST(ErrorFrame, WarningByBothCountersAndBackToActive) {
  ControllerReport report;
  report.state = ErrorState::warning;
  report.state_changed = true;
  report.transmit_errors = 96;
  report.receive_errors = 96;
  EXPECT_EQ(to_error_frame(report).data[1], 0x0C);
  report.state = ErrorState::active;
  report.transmit_errors = 95;
  report.receive_errors = 0;
  const ErrorFrame frame = to_error_frame(report);
  EXPECT_EQ(frame.id, 0x20000204U);
  EXPECT_EQ(frame.data, (Bytes{0, 0x40, 0, 0, 0, 0, 95, 0}));
}

TEST(ErrorFrame, BusOffAndRestart) {
  ControllerReport report;
  report.state = ErrorState::bus_off;
  report.state_changed = true;
  report.transmit_errors = 256;
  EXPECT_EQ(to_error_frame(report), (ErrorFrame{0x20000040U, {}}));
  ControllerReport back;
  back.restarted = true;
  back.state_changed = true;
  EXPECT_EQ(to_error_frame(back), (ErrorFrame{0x20000304U, {0, 0x40}}));
}

TEST(ErrorFrame, DominantBitOfTheOwnFrameThatWasNotSent) {
  ControllerReport report;
  report.error = BusError::bit;
  report.transmitting = true;
  report.dominant = true;
  report.field = FrameField::data;
  const ErrorFrame frame = to_error_frame(report);
  EXPECT_EQ(frame.id, 0x20000288U);
  EXPECT_EQ(frame.data, (Bytes{0, 0, 0x88, 0x0A, 0, 0, 0, 0}));
}

TEST(ErrorFrame, ArbitrationLostAndOverflows) {
  ControllerReport report;
  report.arbitration_lost = true;
  report.bit = 7;
  report.transmit_overflow = true;
  const ErrorFrame frame = to_error_frame(report);
  EXPECT_EQ(frame.id, 0x20000206U);
  EXPECT_EQ(frame.data, (Bytes{7, 2}));
}

/// Every error with every field that it can have, in every state, both ways.
TEST(ErrorFrame, RoundTripOfEveryError) {
  constexpr auto kLast = static_cast<unsigned>(FrameField::intermission);
  for (const BusError error :
       {BusError::bit, BusError::stuff, BusError::form, BusError::crc, BusError::acknowledgement}) {
    for (unsigned field = 0; field <= kLast; ++field) {
      for (unsigned flags = 0; flags < 64; ++flags) {
        ControllerReport report;
        report.error = error;
        report.field = static_cast<FrameField>(field);
        report.transmitting = (flags & 1U) != 0;
        report.dominant = error == BusError::bit && (flags & 2U) != 0;
        report.restarted = (flags & 4U) != 0;
        report.receive_overflow = (flags & 8U) != 0;
        report.transmit_overflow = (flags & 16U) != 0;
        report.receive_errors = 3;
        report.transmit_errors = (flags & 32U) != 0 ? 100 : 0;
        report.state = (flags & 32U) != 0 ? ErrorState::warning : ErrorState::active;
        report.state_changed = (flags & 1U) != 0;
        if (error == BusError::crc) {
          report.field = FrameField::crc_sequence;
        }
        if (error == BusError::acknowledgement) {
          report.field = FrameField::acknowledge_slot;
          report.transmitting = true;
        }
        const auto back = from_error_frame(to_error_frame(report));
        ASSERT_TRUE(back.ok());
        EXPECT_EQ(*back, report);
      }
    }
  }
}

TEST(ErrorFrame, OtherFramesAreMalformed) {
  EXPECT_TRUE(from_error_frame({0x123, {}}).malformed());
  EXPECT_TRUE(from_error_frame({0xA0000004U, {}}).malformed());
  EXPECT_TRUE(from_error_frame({0x60000004U, {}}).malformed());
}

TEST(ErrorFrame, WithoutCountersTheNamedStateHolds) {
  const auto passive = from_error_frame({0x20000004U, {0, 0x10}});
  ASSERT_TRUE(passive.ok());
  EXPECT_EQ(passive->state, ErrorState::passive);
  EXPECT_TRUE(passive->state_changed);
  EXPECT_EQ(passive->receive_errors, 0);
  const auto counters = from_error_frame({0x20000200U, {0, 0, 0, 0, 0, 0, 10, 130}});
  ASSERT_TRUE(counters.ok());
  EXPECT_EQ(counters->state, ErrorState::passive);
  EXPECT_FALSE(counters->state_changed);
}

}  // namespace
}  // namespace rigwire::protocols::can
