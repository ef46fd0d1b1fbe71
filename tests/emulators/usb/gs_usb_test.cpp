#include "emulators/usb/gs_usb.h"

#include <gtest/gtest.h>

#include "gs_usb_workbench.h"
#include "protocols/can/bits.h"

namespace rigwire::emulators {
namespace {

using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::gs_usb::kReceived;

ControllerReport bus_off() {
  ControllerReport report;
  report.state = ErrorState::bus_off;
  report.state_changed = true;
  report.transmit_errors = 256;
  return report;
}

TEST(GsUsbTransmit, EchoComesWhenTheBusHasConfirmed) {
  GsUsbWorkbench bench;
  bench.start(Feature::kTimeStamp);
  const UsbTransfer read = bench.read();
  const UsbTransfer written = bench.transmit(7);
  ASSERT_NE(bench.host.find(written), nullptr);
  EXPECT_EQ(bench.host.find(written)->taken, 20U);
  ASSERT_EQ(bench.wire.sent.size(), 1U);
  EXPECT_EQ(bench.wire.sent[0], kFrame);
  EXPECT_EQ(bench.host.find(read), nullptr);

  bench.adapter.confirmed(at_us(564), true);
  const auto echo = bench.frame_of(read, true);
  ASSERT_TRUE(echo.has_value());
  EXPECT_EQ(echo->echo, 7U);
  EXPECT_EQ(echo->time_stamp_us, 564U);
  EXPECT_EQ(protocols::gs_usb::to_can(*echo), kFrame);
}

// The kernel keeps ten frames in flight; the controller has three mailboxes.
TEST(GsUsbTransmit, TenInFlightLeaveInOrderThreeAtATime) {
  GsUsbWorkbench bench;
  bench.start();
  for (std::uint32_t echo = 0; echo < 10; ++echo) {
    bench.transmit(echo, {0x100 + echo, false, false, 0, {}});
  }
  EXPECT_EQ(bench.wire.sent.size(), 3U);
  for (std::uint32_t echo = 0; echo < 10; ++echo) {
    const UsbTransfer read = bench.read();
    EXPECT_EQ(bench.host.find(read), nullptr);
    bench.adapter.confirmed(bench.now, true);
    ASSERT_TRUE(bench.frame_of(read).has_value());
    EXPECT_EQ(bench.frame_of(read)->echo, echo);
  }
  ASSERT_EQ(bench.wire.sent.size(), 10U);
  for (std::uint32_t i = 0; i < 10; ++i) {
    EXPECT_EQ(bench.wire.sent[i].id, 0x100 + i);
  }
}

TEST(GsUsbTransmit, AnAbandonedFrameIsReturnedToo) {
  GsUsbWorkbench bench;
  bench.start(Feature::kOneShot);
  const UsbTransfer read = bench.read();
  bench.transmit(4);
  bench.adapter.confirmed(bench.now, false);
  ASSERT_TRUE(bench.frame_of(read).has_value());
  EXPECT_EQ(bench.frame_of(read)->echo, 4U);
  EXPECT_EQ(bench.adapter.counters().abandoned, 1U);
}

TEST(GsUsbTransmit, NothingIsSentWhileListeningOrClosed) {
  GsUsbWorkbench bench;
  bench.transmit(0);
  EXPECT_EQ(bench.adapter.counters().unsent, 1U);
  bench.start(Feature::kListenOnly);
  bench.transmit(0);
  EXPECT_TRUE(bench.wire.sent.empty());
}

TEST(GsUsbTransmit, ConfirmationWithoutAFrameIsIgnored) {
  GsUsbWorkbench bench;
  bench.start();
  bench.adapter.confirmed(bench.now, true);
  EXPECT_EQ(bench.adapter.counters().echoed, 0U);
}

TEST(GsUsbTransmit, PacketsOfOddSizes) {
  GsUsbWorkbench bench;
  bench.start();
  const Bytes frame = [] {
    HostFrame host_frame = protocols::gs_usb::from_can(kFrame);
    host_frame.echo = 1;
    const auto encoded = protocols::gs_usb::encode_frame(host_frame);
    return Bytes(encoded.span().begin(), encoded.span().end());
  }();
  struct Case {
    std::size_t size;
    std::size_t frames;
  };
  // One frame a packet, from the packet's beginning; what is shorter than a frame is none.
  for (const auto& [size, frames] : {Case{0, 0},
                                     {1, 0},
                                     {19, 0},
                                     {20, 1},
                                     {24, 1},
                                     {32, 1},
                                     {33, 1},
                                     {51, 1},
                                     {52, 2},
                                     {64, 2}}) {
    bench.stop();
    bench.start();
    bench.wire.sent.clear();
    Bytes bytes(64);
    std::ranges::copy(frame, bytes.begin());
    std::ranges::copy(frame, bytes.begin() + 32);
    bytes.resize(size);
    const UsbTransfer written = bench.write(bytes);
    ASSERT_NE(bench.host.find(written), nullptr) << size;
    EXPECT_EQ(bench.host.find(written)->taken, size);
    EXPECT_EQ(bench.wire.sent.size(), frames) << size;
  }
}

TEST(GsUsbTransmit, FramesThatAreNoneAreCounted) {
  GsUsbWorkbench bench;
  bench.start();
  Bytes bytes(20);
  bytes[9] = 1;  // channel
  bench.write(bytes);
  bytes[9] = 0;
  bytes[10] = 2;  // CAN FD
  bench.write(bytes);
  bytes[10] = 0;
  bytes[7] = 0x20;  // error frame
  bench.write(bytes);
  EXPECT_EQ(bench.adapter.counters().malformed_frames, 3U);
  EXPECT_TRUE(bench.wire.sent.empty());
}

TEST(GsUsbReceive, ThirtyReadsWaitForFrames) {
  GsUsbWorkbench bench;
  bench.start(Feature::kTimeStamp);
  std::vector<UsbTransfer> reads(30);
  std::ranges::generate(reads, [&] { return bench.read(); });
  for (std::uint32_t i = 0; i < 30; ++i) {
    EXPECT_TRUE(bench.adapter.received(at_us(1000 + i), {i, false, false, 0, {}}));
  }
  for (std::uint32_t i = 0; i < 30; ++i) {
    const auto frame = bench.frame_of(reads[i], true);
    ASSERT_TRUE(frame.has_value());
    EXPECT_EQ(frame->echo, kReceived);
    EXPECT_EQ(frame->identifier, i);
    EXPECT_EQ(frame->time_stamp_us, 1000 + i);
    EXPECT_EQ(bench.host.find(reads[i])->data.size(), 24U);
  }
}

TEST(GsUsbReceive, StampsWrapAfter71Minutes) {
  GsUsbWorkbench bench;
  bench.start(Feature::kTimeStamp);
  constexpr std::int64_t kWrap_us = std::int64_t{1} << 32;
  const UsbTransfer before = bench.read();
  const UsbTransfer after = bench.read();
  bench.adapter.received(at_us(kWrap_us - 1), kFrame);
  bench.adapter.received(at_us(kWrap_us + 1), kFrame);
  EXPECT_EQ(bench.frame_of(before, true)->time_stamp_us, 0xFFFFFFFFU);
  EXPECT_EQ(bench.frame_of(after, true)->time_stamp_us, 1U);
}

TEST(GsUsbReceive, UnstampedAndPaddedForms) {
  GsUsbWorkbench bench;
  bench.start();
  const UsbTransfer plain = bench.read();
  bench.adapter.received(bench.now, kFrame);
  EXPECT_EQ(bench.host.find(plain)->data.size(), 20U);
  bench.start(Feature::kTimeStamp | Feature::kPadded);
  const UsbTransfer padded = bench.read(32);
  bench.adapter.received(bench.now, kFrame);
  EXPECT_EQ(bench.host.find(padded)->data.size(), 32U);
}

TEST(GsUsbReceive, ARequestThatIsTooShortOverflows) {
  GsUsbWorkbench bench;
  bench.start();
  const UsbTransfer read = bench.read(19);
  bench.adapter.received(bench.now, kFrame);
  ASSERT_NE(bench.host.find(read), nullptr);
  EXPECT_EQ(bench.host.find(read)->outcome, Outcome::overflow);
  EXPECT_EQ(bench.host.find(read)->data.size(), 19U);
}

TEST(GsUsbReceive, AHostThatDoesNotReadLosesFramesAndIsTold) {
  GsUsbWorkbench bench;
  bench.start();
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_TRUE(bench.adapter.received(bench.now, {i, false, false, 0, {}}));
  }
  EXPECT_FALSE(bench.adapter.received(bench.now, {64, false, false, 0, {}}));
  EXPECT_FALSE(bench.adapter.received(bench.now, {65, false, false, 0, {}}));
  EXPECT_EQ(bench.adapter.counters().lost, 2U);
  for (std::uint32_t i = 0; i < 64; ++i) {
    EXPECT_EQ(bench.frame_of(bench.read())->identifier, i);
  }
  for (const std::uint8_t flags : {HostFrame::kOverflow, std::uint8_t{0}}) {
    const UsbTransfer read = bench.read();
    EXPECT_TRUE(bench.adapter.received(bench.now, kFrame));
    EXPECT_EQ(bench.frame_of(read)->flags, flags);
  }
}

TEST(GsUsbReceive, AFullMemoryMakesTheHostWait) {
  GsUsbWorkbench bench;
  bench.start();
  for (std::uint32_t i = 0; i < 64; ++i) {
    bench.adapter.received(bench.now, {i, false, false, 0, {}});
  }
  const UsbTransfer written = bench.transmit(0);
  EXPECT_EQ(bench.host.find(written), nullptr);
  EXPECT_TRUE(bench.wire.sent.empty());
  bench.read();
  EXPECT_NE(bench.host.find(written), nullptr);
  EXPECT_EQ(bench.wire.sent.size(), 1U);
}

TEST(GsUsbReceive, OpenTransfersAreBounded) {
  GsUsbWorkbench bench;
  bench.start();
  for (std::size_t i = 0; i < GsUsbAdapter::kReadsMax; ++i) {
    bench.read();
  }
  EXPECT_EQ(bench.host.find(bench.read())->outcome, Outcome::stalled);
}

TEST(GsUsbReceive, NothingIsHeardWhileClosed) {
  GsUsbWorkbench bench;
  const UsbTransfer read = bench.read();
  EXPECT_TRUE(bench.adapter.received(bench.now, kFrame));
  EXPECT_EQ(bench.host.find(read), nullptr);
}

TEST(GsUsbErrors, EveryChangeOfStateAsTheFirmwareWritesIt) {
  GsUsbWorkbench bench;
  bench.start();
  ControllerReport warning;
  warning.state = ErrorState::warning;
  warning.state_changed = true;
  warning.transmit_errors = 96;
  warning.error = BusError::bit;
  warning.dominant = true;
  const UsbTransfer first = bench.read();
  bench.adapter.reported(bench.now, warning);
  // Controller, protocol, bus error, counters; transmit warning; dominant bit not sent.
  EXPECT_EQ(bench.frame_of(first)->identifier, 0x2000028CU);
  EXPECT_EQ(bench.frame_of(first)->length_code, 8);
  EXPECT_EQ(bench.frame_of(first)->data,
            (std::array<std::uint8_t, 8>{0, 0x08, 0x08, 0, 0, 0, 96, 0}));

  ControllerReport passive;
  passive.state = ErrorState::passive;
  passive.state_changed = true;
  passive.receive_errors = 128;
  passive.error = BusError::stuff;
  const UsbTransfer second = bench.read();
  bench.adapter.reported(bench.now, passive);
  EXPECT_EQ(bench.frame_of(second)->data,
            (std::array<std::uint8_t, 8>{0, 0x10, 0x04, 0, 0, 0, 0, 128}));

  ControllerReport active;
  active.state_changed = true;
  const UsbTransfer third = bench.read();
  bench.adapter.reported(bench.now, active);
  EXPECT_EQ(bench.frame_of(third)->identifier, 0x20000204U);
  EXPECT_EQ(bench.frame_of(third)->data[1], 0x40);
}

TEST(GsUsbErrors, SingleErrorsOnlyWhenAskedFor) {
  ControllerReport report;
  report.error = BusError::acknowledgement;
  report.transmitting = true;
  report.transmit_errors = 8;
  GsUsbWorkbench bench;
  bench.start();
  const UsbTransfer silent = bench.read();
  bench.adapter.reported(bench.now, report);
  EXPECT_EQ(bench.host.find(silent), nullptr);
  bench.start(Feature::kBusErrors);
  bench.adapter.reported(bench.now, report);
  ASSERT_TRUE(bench.frame_of(silent).has_value());
  EXPECT_EQ(bench.frame_of(silent)->identifier, 0x200002A8U);
}

TEST(GsUsbErrors, BusOffEndsByItselfAfterATenthOfASecond) {
  GsUsbWorkbench bench;
  bench.start();
  for (std::uint32_t echo = 0; echo < 5; ++echo) {
    bench.transmit(echo);
  }
  std::vector<UsbTransfer> reads(8);
  std::ranges::generate(reads, [&] { return bench.read(); });
  bench.adapter.reported(at_us(5000), bus_off());
  EXPECT_EQ(bench.frame_of(reads[0])->identifier, 0x20000040U);
  EXPECT_EQ(bench.adapter.next_event(), at_us(105'000));
  bench.adapter.advance(at_us(104'999));
  EXPECT_EQ(bench.host.find(reads[1]), nullptr);
  EXPECT_EQ(bench.wire.sent.size(), 3U);

  bench.adapter.advance(at_us(105'000));
  for (std::uint32_t echo = 0; echo < 3; ++echo) {  // the mailboxes' content is lost
    EXPECT_EQ(bench.frame_of(reads[1 + echo])->echo, echo);
  }
  EXPECT_EQ(bench.frame_of(reads[4])->identifier, 0x20000300U);
  EXPECT_EQ(bench.wire.sent.size(), 5U);  // the other two go on their way
  ASSERT_EQ(bench.wire.controllers.size(), 3U);
  EXPECT_FALSE(bench.wire.controllers[1].present);
  EXPECT_EQ(bench.wire.controllers[2], opened(250'000));
  EXPECT_EQ(bench.adapter.next_event(), kNever);
}

TEST(GsUsbErrors, AHostThatRecoversByItselfIsWaitedFor) {
  GsUsbWorkbench bench;
  bench.start(Feature::kBusOffRecovery);
  bench.adapter.reported(at_us(5000), bus_off());
  EXPECT_EQ(bench.adapter.next_event(), kNever);
  bench.now = at_us(900'000);
  EXPECT_EQ(bench.request({0x41, 32, 0, 0, 0}).outcome, Outcome::done);
  bench.adapter.advance(bench.now);
  EXPECT_EQ(bench.wire.controllers.size(), 3U);
  EXPECT_EQ(bench.adapter.counters().restarts, 1U);
}

TEST(GsUsbLoopBack, TakesTheFramesTimeAndNotTheBus) {
  GsUsbWorkbench bench;
  bench.start(Feature::kLoopBack | Feature::kTimeStamp);
  EXPECT_TRUE(bench.wire.controllers.empty());
  const UsbTransfer echo = bench.read();
  const UsbTransfer copy = bench.read();
  bench.transmit(3);
  bench.transmit(4);
  EXPECT_EQ(protocols::can::exact_bits(kFrame), 144U);
  EXPECT_EQ(bench.adapter.next_event(), at_us(141 * 4));
  bench.adapter.advance(at_us(141 * 4));
  EXPECT_EQ(bench.frame_of(echo, true)->echo, 3U);
  EXPECT_EQ(bench.frame_of(copy, true)->echo, kReceived);
  EXPECT_EQ(bench.frame_of(copy, true)->time_stamp_us, 564U);
  EXPECT_EQ(bench.adapter.next_event(), at_us((144 + 141) * 4));
  EXPECT_TRUE(bench.wire.sent.empty());
}

TEST(GsUsbPlug, UnplugForgetsEverything) {
  GsUsbWorkbench bench;
  bench.start();
  bench.read();
  bench.transmit(0);
  const auto completions = bench.host.completions.size();
  bench.adapter.unplugged(bench.now);
  EXPECT_FALSE(bench.wire.controllers.back().present);
  bench.adapter.confirmed(bench.now, true);
  bench.adapter.received(bench.now, kFrame);
  EXPECT_EQ(bench.host.completions.size(), completions);

  bench.adapter.plugged(bench.now, bench.host);
  bench.tell(Request::mode, Mode{Mode::kStart, 0});  // the bit timing is gone as well
  EXPECT_FALSE(bench.wire.controllers.back().present);
}

TEST(GsUsbPlug, CancelTakesBackWhatIsOpen) {
  GsUsbWorkbench bench;
  bench.start();
  const UsbTransfer first = bench.read();
  const UsbTransfer second = bench.read();
  EXPECT_TRUE(bench.adapter.cancel(bench.now, first));
  bench.adapter.received(bench.now, kFrame);
  EXPECT_EQ(bench.host.find(first), nullptr);
  EXPECT_NE(bench.host.find(second), nullptr);
  EXPECT_FALSE(bench.adapter.cancel(bench.now, second));
}

TEST(GsUsbPlug, ResetDropsWhatWasNotSent) {
  GsUsbWorkbench bench;
  bench.start();
  bench.transmit(0);
  bench.transmit(1);
  bench.stop();
  bench.start();
  const UsbTransfer read = bench.read();
  bench.transmit(2);
  bench.adapter.confirmed(bench.now, true);   // 0, which was on the wire
  bench.adapter.confirmed(bench.now, false);  // 1
  EXPECT_EQ(bench.host.find(read), nullptr);
  bench.adapter.confirmed(bench.now, true);
  EXPECT_EQ(bench.frame_of(read)->echo, 2U);
}

}  // namespace
}  // namespace rigwire::emulators
