#include "emulators/openimu/address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <limits>

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

TEST(OpenImuAddress, TwoDevicesOnOneBusSortThemselvesOut) {
  OpenImuBus outside;
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
