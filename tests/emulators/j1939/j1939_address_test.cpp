#include "emulators/j1939/j1939_address.h"

#include <gtest/gtest.h>

#include <limits>

#include "../vehicle_gateway/rig.h"
#include "emulators/can/can_bus.h"

namespace rigwire::emulators {
namespace {

using namespace std::chrono_literals;
namespace j1939 = protocols::j1939;
namespace vehicle = protocols::vehicle;

constexpr std::uint64_t kHighName = std::numeric_limits<std::uint64_t>::max();

VehicleGatewaySettings with_address(std::uint8_t address, bool arbitrary = false) {
  VehicleGatewaySettings settings;
  settings.source_address = address;
  settings.arbitrary_address = arbitrary;
  return settings;
}

TEST(VehicleAddress, LowerOwnNameClaimsAgainAndGoesOn) {
  VehicleRig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x00, kHighName));
  EXPECT_EQ(rig.output.frames.back().second, j1939::make_address_claim(0x00, rig.gateway.name()));
  EXPECT_EQ(rig.gateway.address_conflicts(), 1U);
  EXPECT_TRUE(rig.gateway.address_held());
}

TEST(VehicleAddress, LosesToALowerNameAndFallsSilent) {
  VehicleRig rig;
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x00, 1));
  EXPECT_FALSE(rig.gateway.address_held());
  rig.run(153ms);  // 0 .. 255 times 0.6 ms
  EXPECT_EQ(rig.output.frames.back().second,
            j1939::make_address_claim(j1939::kNullAddress, rig.gateway.name()));
  const std::size_t before = rig.output.frames.size();
  rig.run(1s);
  EXPECT_EQ(rig.output.frames.size(), before);
  rig.receive(j1939::make_request(kController, j1939::kGlobalAddress, vehicle::Eec1::kGroup.pgn));
  EXPECT_EQ(rig.output.frames.size(), before);
  for (int i = 0; i < 10; ++i) {  // one answer, however often it is asked meanwhile
    rig.receive(j1939::make_request(kController, j1939::kGlobalAddress, j1939::kAddressClaimedPgn));
  }
  rig.run(153ms);
  EXPECT_EQ(rig.output.frames.size(), before + 1);
}

TEST(VehicleAddress, LosingTheAddressSilencesItsCommandsToo) {
  VehicleRig rig;
  rig.run(50ms);
  vehicle::Tsc1 request;
  request.override_mode = static_cast<std::uint8_t>(vehicle::OverrideMode::torque);
  request.torque_share = 0.5;
  rig.ask(request);
  rig.receive(j1939::make_address_claim(0x00, 1));
  rig.receive(vehicle::encode(request, kController, 0x00));
  rig.run(200ms);
  EXPECT_TRUE(rig.gateway.control().stopping());
  EXPECT_EQ(rig.command().engine_torque_share, 0.0);
}

TEST(VehicleAddress, ArbitraryAddressMovesAndWaitsAQuarterOfASecond) {
  VehicleRig rig(with_address(0x00, true));
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x80, 2));
  rig.receive(j1939::make_address_claim(0x00, 1));
  EXPECT_EQ(rig.gateway.address(), 0x81);
  EXPECT_FALSE(rig.gateway.address_held());
  rig.output.frames.clear();
  rig.run(240ms);
  EXPECT_TRUE(rig.output.frames.empty());
  rig.run(20ms);
  EXPECT_TRUE(rig.gateway.address_held());
  ASSERT_FALSE(rig.output.frames.empty());
  EXPECT_EQ(j1939::unpack(rig.output.frames.back().second.id).source, 0x81);
}

TEST(VehicleAddress, WhatANodeThatCannotClaimHadIsFree) {
  VehicleRig rig(with_address(0x00, true));
  rig.run(50ms);
  rig.receive(j1939::make_address_claim(0x80, 2));
  rig.receive(j1939::make_address_claim(j1939::kNullAddress, 2));
  rig.receive(j1939::make_address_claim(0x00, 1));
  EXPECT_EQ(rig.gateway.address(), 0x80);
}

TEST(VehicleAddress, AvoidsWhatALowerNameHeldBeforeItsOwnFirstClaim) {
  VehicleGatewaySettings settings = with_address(0x00, true);
  settings.supply.power_on = 100ms;
  VehicleRig rig(settings);
  rig.receive(j1939::make_address_claim(0x00, 1));
  rig.run(500ms);
  EXPECT_EQ(rig.gateway.address(), 0x80);
  EXPECT_EQ(rig.gateway.address_conflicts(), 0U);
}

TEST(VehicleAddress, AddressOutsideTheAssignedOnesIsSilentFirst) {
  VehicleRig rig(with_address(0x90));
  rig.run(240ms);
  EXPECT_EQ(rig.output.frames.size(), 1U);  // the claim
  rig.run(100ms);
  EXPECT_GT(rig.output.frames.size(), 1U);
}

TEST(VehicleAddress, TwoGatewaysOnOneBusSortThemselvesOut) {
  test::FrameRecorder outside;
  CanBusModel bus(CanBusSettings{});
  FrameOutput& first_output = bus.add_node(outside);
  FrameOutput& second_output = bus.add_node(outside);
  VehicleGatewaySettings settings = with_address(0x00, true);
  VehicleGateway first(settings, first_output);
  settings.serial = 2;
  VehicleGateway second(settings, second_output);  // both claim 0x00 at once
  bus.attach(first_output, first);
  bus.attach(second_output, second);
  for (SimTime now = kStart; now < kStart + 500ms; now += 100us) {
    first.advance(now);
    second.advance(now);
    bus.advance(now);
  }
  EXPECT_EQ(first.address(), 0x00);
  EXPECT_EQ(second.address(), 0x80);
  EXPECT_TRUE(first.address_held() && second.address_held());
}

}  // namespace
}  // namespace rigwire::emulators
