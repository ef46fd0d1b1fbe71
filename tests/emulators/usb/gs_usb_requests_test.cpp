#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/emulators/usb/gs_usb_workbench.h"

namespace rigwire::emulators {
namespace {

using protocols::gs_usb::BitTimingLimits;
using protocols::gs_usb::ControllerState;
using protocols::gs_usb::decode;
using protocols::gs_usb::DeviceConfiguration;
using protocols::gs_usb::HostFormat;
using protocols::gs_usb::TimeStamp;

TEST(GsUsbAdapter, IsACandleLightByItsDescription) {
  GsUsbWorkbench bench;
  const auto& device = bench.adapter.description();
  EXPECT_EQ(device.vendor, 0x1D50);
  EXPECT_EQ(device.product, 0x606F);
  EXPECT_EQ(device.maximum_power_2ma * 2, 150);
  ASSERT_EQ(device.interfaces.size(), 2U);
  ASSERT_EQ(device.interfaces[0].endpoints.size(), 2U);
  EXPECT_EQ(device.interfaces[0].endpoints[0].address, 0x81);
  EXPECT_EQ(device.interfaces[0].endpoints[1].address, 0x02);
  EXPECT_EQ(device.interfaces[0].endpoints[0].packet_bytes, 32);
  EXPECT_EQ(device.interfaces[1].device_class, 0xFE);
  EXPECT_EQ(device.interfaces[1].extra.size(), 9U);
}

TEST(GsUsbAdapter, ProbeOfTheKernelDriver) {
  GsUsbWorkbench bench;
  EXPECT_EQ(bench.tell(Request::host_format, HostFormat{}, 1).outcome, Outcome::done);
  const auto configuration =
      decode<DeviceConfiguration>(bench.ask(Request::device_configuration, 12, 1).data);
  ASSERT_TRUE(configuration.ok());
  EXPECT_EQ(configuration->channels(), 1U);
  EXPECT_EQ(configuration->software_version, 2U);
  const auto limits = decode<BitTimingLimits>(bench.ask(Request::bit_timing_limits, 40).data);
  ASSERT_TRUE(limits.ok());
  EXPECT_EQ(limits->clock_hz, 48'000'000U);
  EXPECT_EQ(limits->features & Feature::kFlexibleDataRate, 0U);
  EXPECT_NE(limits->features & Feature::kTimeStamp, 0U);
  EXPECT_TRUE(bench.wire.controllers.empty());
}

TEST(GsUsbAdapter, BitTimingAndModeOpenTheController) {
  GsUsbWorkbench bench;
  bench.start();
  ASSERT_EQ(bench.wire.controllers.size(), 1U);
  EXPECT_EQ(bench.wire.controllers.back(), opened(250'000));
  bench.stop();
  EXPECT_EQ(bench.wire.controllers.back(), kClosed);
  bench.start(Feature::kListenOnly | Feature::kOneShot, {6, 7, 2, 1, 6});
  EXPECT_EQ(bench.wire.controllers.back(), opened(500'000, true, true));
}

// The kernel sends the bit timing when it is configured, and not again at each `ip link set up`.
TEST(GsUsbAdapter, BitTimingOutlivesTheReset) {
  GsUsbWorkbench bench;
  bench.start();
  bench.stop();
  bench.tell(Request::mode, Mode{Mode::kStart, 0});
  EXPECT_EQ(bench.wire.controllers.back().bit_rate_bps, 250'000U);
}

TEST(GsUsbAdapter, ImpossibleBitTimingIsTakenWithoutEffect) {
  GsUsbWorkbench bench;
  for (const BitTiming& timing :
       {BitTiming{}, BitTiming{60, 7, 2, 1, 12}, BitTiming{6, 7, 9, 1, 12},
        BitTiming{6, 7, 2, 5, 12}, BitTiming{6, 7, 2, 1, 0}}) {
    EXPECT_EQ(bench.tell(Request::bit_timing, timing).outcome, Outcome::done);
  }
  EXPECT_EQ(bench.adapter.counters().refused_requests, 5U);
  bench.tell(Request::mode, Mode{Mode::kStart, 0});
  EXPECT_TRUE(bench.wire.controllers.empty());
}

TEST(GsUsbAdapter, StartsOnlyWithABitTiming) {
  GsUsbWorkbench bench;
  EXPECT_EQ(bench.tell(Request::mode, Mode{Mode::kStart, 0}).outcome, Outcome::done);
  EXPECT_TRUE(bench.wire.controllers.empty());
  EXPECT_EQ(bench.adapter.counters().refused_requests, 1U);
}

TEST(GsUsbAdapter, FlexibleDataRateIsRefused) {
  GsUsbWorkbench bench;
  bench.start(Feature::kFlexibleDataRate);
  EXPECT_TRUE(bench.wire.controllers.empty());
  EXPECT_EQ(bench.tell(Request::data_bit_timing, k250kbps).outcome, Outcome::stalled);
  EXPECT_EQ(bench.ask(Request::extended_bit_timing_limits, 72).outcome, Outcome::stalled);
}

TEST(GsUsbAdapter, RequestsThatItDoesNotKnowStall) {
  GsUsbWorkbench bench;
  EXPECT_EQ(bench.ask(Request{3}, 64).outcome, Outcome::stalled);
  EXPECT_EQ(bench.ask(Request{200}, 64).outcome, Outcome::stalled);
  EXPECT_EQ(bench.ask(Request::bit_timing, 20).outcome, Outcome::stalled);            // direction
  EXPECT_EQ(bench.ask(Request::bit_timing_limits, 40, 1).outcome, Outcome::stalled);  // channel 1
  EXPECT_EQ(bench.ask(Request::bit_timing_limits, 39).outcome, Outcome::stalled);
  EXPECT_EQ(bench.ask(Request::bit_timing_limits, 255).data.size(), 40U);
  EXPECT_EQ(bench.request({0x41, 1, 0, 0, 19}, Bytes(19)).outcome, Outcome::stalled);
  EXPECT_EQ(bench.request({0x41, 2, 0, 0, 0}).outcome, Outcome::stalled);
  EXPECT_EQ(bench.request({0xA1, 4, 0, 0, 40}).outcome, Outcome::stalled);  // class request
}

TEST(GsUsbAdapter, TimeStampIsThatOfTheLastStartOfFrameAndWraps) {
  GsUsbWorkbench bench;
  const auto stamp = [&] {
    return decode<TimeStamp>(bench.ask(Request::time_stamp, 4).data)->microseconds;
  };
  bench.now = at_us(12'345'678);
  EXPECT_EQ(stamp(), 12'345'000U);
  constexpr std::int64_t kWrap_us = std::int64_t{1} << 32;  // 71 min 35 s
  bench.now = at_us(kWrap_us + 1500);
  EXPECT_EQ(stamp(), static_cast<std::uint32_t>((kWrap_us + 1500) / 1000 * 1000 - kWrap_us));
}

TEST(GsUsbAdapter, StateOfTheController) {
  GsUsbWorkbench bench;
  const auto state = [&] {
    return *decode<ControllerState>(bench.ask(Request::controller_state, 12).data);
  };
  EXPECT_EQ(state().state, ControllerState::kStopped);
  bench.start();
  EXPECT_EQ(state(), (ControllerState{ControllerState::kActive, 0, 0}));
  protocols::can::ControllerReport report;
  report.state = protocols::can::ErrorState::passive;
  report.transmit_errors = 136;
  report.receive_errors = 3;
  report.state_changed = true;
  bench.adapter.reported(bench.now, report);
  EXPECT_EQ(state(), (ControllerState{ControllerState::kPassive, 3, 136}));
}

TEST(GsUsbAdapter, BlinksWhenAsked) {
  GsUsbWorkbench bench;
  bench.tell(Request::identify, protocols::gs_usb::Identify{1});
  EXPECT_TRUE(bench.adapter.identifying());
  bench.tell(Request::identify, protocols::gs_usb::Identify{0});
  EXPECT_FALSE(bench.adapter.identifying());
}

TEST(GsUsbAdapter, UpgradeInterfaceIsIdle) {
  GsUsbWorkbench bench;
  const auto status = bench.request({0xA1, 3, 0, 1, 6});
  EXPECT_EQ(status.data, (Bytes{0, 0, 0, 0, 0, 0xFF}));
  EXPECT_EQ(bench.request({0x21, 0, 1000, 1, 0}).outcome, Outcome::done);
  EXPECT_EQ(bench.request({0x21, 1, 0, 1, 0}).outcome, Outcome::stalled);
}

TEST(GsUsbSettingsCheck, SerialNumberHas24Digits) {
  EXPECT_NO_THROW(validate(GsUsbSettings{}));
  for (const char* serial : {"", "123", "52494757495245474B55534G", "52494757495245474B5553420"}) {
    EXPECT_THROW(validate({.serial_number = serial}), std::invalid_argument) << serial;
  }
}

TEST(GsUsbSettingsCheck, MemoryHasItsLimits) {
  for (const std::size_t frames : {16U, 1024U}) {
    EXPECT_NO_THROW(validate({.memory_frames = frames}));
  }
  for (const std::size_t frames : {0U, 15U, 1025U}) {
    EXPECT_THROW(validate({.memory_frames = frames}), std::invalid_argument) << frames;
  }
}

}  // namespace
}  // namespace rigwire::emulators
