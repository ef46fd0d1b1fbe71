// How an OpenIMU gets and keeps its address: as its firmware does it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <vector>

#include "emulators/can/can_bus.h"
#include "rig.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace j1939 = protocols::j1939;
namespace openimu = protocols::openimu;

constexpr std::uint8_t kTester = 0x21;

TEST(OpenImuAddress, LowerOwnNameClaimsAgain) {
  OpenImuRig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x80, std::numeric_limits<std::uint64_t>::max()));
  EXPECT_EQ(rig.imu.address(), 0x80);
  EXPECT_EQ(rig.output.frames.back().second, j1939::make_address_claim(0x80, rig.imu.name()));
  EXPECT_EQ(rig.imu.address_conflicts(), 1U);
}

TEST(OpenImuAddress, HigherOwnNameTakesTheNextFreeAddress) {
  OpenImuRig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x81, 2));
  rig.receive(j1939::make_address_claim(0x80, 1));
  EXPECT_FALSE(rig.imu.address_held());
  rig.run(10ms);  // its delay again
  EXPECT_EQ(rig.imu.address(), 0x82);
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).back(),
            j1939::make_address_claim(0x82, rig.imu.name()));
  rig.run(20ms);
  EXPECT_EQ(j1939::unpack(rig.output.of(openimu::kSlopePgn).back().id).source, 0x82);
}

TEST(OpenImuAddress, AvoidsWhatALowerNameHeldBeforeItsOwnFirstClaim) {
  OpenImuRig rig(settings_with(0x1234F));
  rig.receive(j1939::make_address_claim(0x80, 1));
  rig.run(200ms);
  EXPECT_EQ(rig.imu.address(), 0x81);
  EXPECT_EQ(rig.imu.address_conflicts(), 0U);
}

TEST(OpenImuAddress, The335RiGivesWayBeforeItsOwnClaimEvenToAHigherName) {
  OpenImuRig rig(settings_with(0x1234F));
  rig.receive(j1939::make_address_claim(0x80, std::numeric_limits<std::uint64_t>::max()));
  rig.run(200ms);
  EXPECT_EQ(rig.imu.address(), 0x81);
}

TEST(OpenImuAddress, SerialsOfFullTicksWaitTheLongest) {
  OpenImuRig rig(settings_with(0x12340));
  rig.run(200ms);
  EXPECT_EQ(rig.output.frames.front().first, kStart + 31 * 5ms + 1ms);
}

TEST(OpenImuAddress, FallsSilentWhenThePoolIsFull) {
  OpenImuRig rig;
  rig.run(50ms);
  for (unsigned address = 128; address <= 247; ++address) {
    rig.receive(j1939::make_address_claim(static_cast<std::uint8_t>(address), address));
  }
  EXPECT_FALSE(rig.imu.address_held());
  const std::size_t before = rig.output.frames.size();
  rig.run(100ms);
  rig.receive(j1939::make_request(kTester, j1939::kGlobalAddress, j1939::kAddressClaimedPgn));
  EXPECT_EQ(rig.output.frames.size(), before);
}

protocols::can::ControllerReport back_from_bus_off() {
  protocols::can::ControllerReport report;
  report.restarted = true;
  return report;
}

TEST(OpenImuAddress, The335RiClaimsAgainAfterBusOffBeforeItSendsData) {
  OpenImuRig rig;
  rig.run(100ms);
  rig.output.frames.clear();
  rig.imu.controller(rig.now, back_from_bus_off());
  EXPECT_FALSE(rig.imu.address_held());
  rig.run(200ms);
  ASSERT_FALSE(rig.output.frames.empty());
  EXPECT_EQ(rig.output.frames.front().second, j1939::make_address_claim(0x80, rig.imu.name()));
  EXPECT_EQ(rig.output.of(j1939::kAddressClaimedPgn).size(), 1U);
  EXPECT_FALSE(rig.output.of(openimu::kSlopePgn).empty());
}

TEST(OpenImuAddress, The335RiAvoidsWhoTookItsAddressDuringBusOff) {
  OpenImuRig rig;
  rig.run(100ms);
  rig.imu.controller(rig.now, back_from_bus_off());
  rig.receive(j1939::make_address_claim(0x80, 1));
  rig.run(200ms);
  EXPECT_TRUE(rig.imu.address_held());
  EXPECT_EQ(rig.imu.address(), 0x81);
}

TEST(OpenImuAddress, BusOffWhileSwitchedOffIsNoStart) {
  OpenImuSettings settings = settings_with(0x12341);
  settings.supply.power_on = 1s;
  OpenImuRig rig(settings);
  rig.imu.controller(rig.now, back_from_bus_off());
  rig.run(500ms);
  EXPECT_TRUE(rig.output.frames.empty());
}

TEST(OpenImuAddress, The300RiRepeatsItsClaimEachSecondWhateverHappens) {
  OpenImuRig rig(settings_with(0x12341, OpenImuVariant::openimu300ri));
  rig.run(1500ms);
  rig.imu.controller(rig.now, back_from_bus_off());
  EXPECT_TRUE(rig.imu.address_held());
  rig.run(2s);
  std::vector<SimTime> claims;
  for (const auto& [due, frame] : rig.output.frames) {
    if (frame == j1939::make_address_claim(0x80, rig.imu.name())) {
      claims.push_back(due);
    }
  }
  EXPECT_THAT(claims, testing::ElementsAre(kStart + 1ms, kStart + 1001ms, kStart + 2001ms,
                                           kStart + 3001ms));
}

TEST(OpenImuAddress, TheVerySameNameSilencesIt) {
  OpenImuRig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x80, rig.imu.name()));
  const std::size_t before = rig.output.frames.size();
  rig.run(100ms);
  EXPECT_FALSE(rig.imu.address_held());
  EXPECT_EQ(rig.output.frames.size(), before);
}

TEST(OpenImuAddress, TwoDevicesOnOneBusSortThemselvesOut) {
  test::FrameRecorder outside;
  CanBusModel bus(CanBusSettings{});
  FrameOutput& first_output = bus.add_node(outside);
  FrameOutput& second_output = bus.add_node(outside);
  OpenImu first(settings_with(0x20), first_output);
  OpenImu second(settings_with(0x40), second_output);  // both claim 0x80 at once
  bus.attach(first_output, first);
  bus.attach(second_output, second);
  for (SimTime now = kStart; now < kStart + 400ms; now += 100us) {
    first.advance(now);
    second.advance(now);
    bus.advance(now);
  }
  EXPECT_EQ(first.address(), 0x80);
  EXPECT_EQ(second.address(), 0x81);
  EXPECT_TRUE(first.address_held() && second.address_held());
}

}  // namespace
}  // namespace rigwire::emulators
