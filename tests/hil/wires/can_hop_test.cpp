#include "hil/wires/can_hop.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::hil {
namespace {

using drivers::CanInterface;
using testing::AllOf;
using testing::HasSubstr;

CanHost host_with(std::vector<CanInterface> interfaces, std::string gs_usb_obstacle = "") {
  return {true, std::move(interfaces), std::move(gs_usb_obstacle)};
}

TEST(CanWireChoice, WhatIsWrittenIsTaken) {
  BusConfiguration bus;
  for (const CanWire wire : {CanWire::socketcan, CanWire::gs_usb, CanWire::slcan}) {
    bus.wire = wire;
    EXPECT_EQ(choose_can_wire(bus, {}).wire, wire);
  }
}

TEST(CanWireChoice, AnInterfaceThatIsUpComesFirst) {
  const auto choice = choose_can_wire({}, host_with({{"vcan0", 3, true, "vcan", 0}}));
  EXPECT_EQ(choice.wire, CanWire::socketcan);
  EXPECT_THAT(choice.why, HasSubstr("vcan0"));
}

TEST(CanWireChoice, AnInterfaceThatIsDownOrAnotherIsPassedOverForGsUsb) {
  auto choice = choose_can_wire({}, host_with({{"vcan0", 3, false, "vcan", 0}}));
  EXPECT_EQ(choice.wire, CanWire::gs_usb);
  EXPECT_EQ(choice.why, "vcan0 is down");
  choice = choose_can_wire({}, host_with({{"vcan1", 3, true, "vcan", 0}}));
  EXPECT_EQ(choice.wire, CanWire::gs_usb);
  EXPECT_EQ(choice.why, "there is no interface vcan0");
}

TEST(CanWireChoice, ARealInterfaceMustHaveTheBussRate) {
  BusConfiguration bus;
  bus.interface = "can0";
  EXPECT_EQ(choose_can_wire(bus, host_with({{"can0", 3, true, "can", 250'000}})).wire,
            CanWire::socketcan);
  const auto choice = choose_can_wire(bus, host_with({{"can0", 3, true, "can", 500'000}}));
  EXPECT_EQ(choice.wire, CanWire::gs_usb);
  EXPECT_THAT(choice.why, AllOf(HasSubstr("500000"), HasSubstr("250000")));
}

TEST(CanWireChoice, SlcanNeedsNothingAndTheReasonNamesWhatTheHostLacks) {
  CanHost host;
  host.gs_usb_obstacle = "no vhci";
  const auto choice = choose_can_wire({}, host);
  EXPECT_EQ(choice.wire, CanWire::slcan);
  EXPECT_EQ(choice.why, "the kernel has no CAN sockets; no vhci");
}

}  // namespace
}  // namespace rigwire::hil
