#include "emulators/can/can_controller.h"

#include <gtest/gtest.h>

namespace rigwire::emulators {
namespace {

using protocols::can::ErrorState;

TEST(CanFaultConfinement, StatesBeginAtTheirLimits) {
  CanFaultConfinement counters;
  EXPECT_EQ(counters.state(), ErrorState::active);
  for (int i = 0; i < 95; ++i) {
    counters.receive_error();
  }
  EXPECT_EQ(counters.state(), ErrorState::active);
  counters.receive_error();
  EXPECT_EQ(counters.state(), ErrorState::warning);
  for (int i = 96; i < 127; ++i) {
    counters.receive_error();
  }
  EXPECT_EQ(counters.state(), ErrorState::warning);
  EXPECT_FALSE(counters.passive());
  counters.receive_error();
  EXPECT_EQ(counters.state(), ErrorState::passive);
  EXPECT_TRUE(counters.passive());
}

TEST(CanFaultConfinement, ReceiversNeverGoOff) {
  CanFaultConfinement counters;
  for (int i = 0; i < 1000; ++i) {
    counters.severe_receive_error();
  }
  EXPECT_EQ(counters.receive_errors(), 255);
  EXPECT_EQ(counters.state(), ErrorState::passive);
}

TEST(CanFaultConfinement, ThirtyTwoTransmitErrorsAreBusOff) {
  CanFaultConfinement counters;
  for (int i = 0; i < 31; ++i) {
    counters.transmit_error();
  }
  EXPECT_EQ(counters.transmit_errors(), 248);
  EXPECT_FALSE(counters.bus_off());
  counters.transmit_error();
  EXPECT_EQ(counters.transmit_errors(), 256);
  EXPECT_EQ(counters.state(), ErrorState::bus_off);
  counters.transmitted();
  EXPECT_TRUE(counters.bus_off());  // Only recovery leads back.
  counters.reset();
  EXPECT_EQ(counters.state(), ErrorState::active);
}

TEST(CanFaultConfinement, SuccessCountsDownToZeroAndNotBeyond) {
  CanFaultConfinement counters;
  counters.transmit_error();
  for (int i = 0; i < 9; ++i) {
    counters.transmitted();
    counters.received();
  }
  EXPECT_EQ(counters.transmit_errors(), 0);
  EXPECT_EQ(counters.receive_errors(), 0);
}

TEST(CanFaultConfinement, OneReceptionEndsAPassiveReceiver) {
  CanFaultConfinement counters;
  for (int i = 0; i < 30; ++i) {
    counters.severe_receive_error();
  }
  EXPECT_EQ(counters.receive_errors(), 240);
  counters.received();
  EXPECT_EQ(counters.receive_errors(), 127);
  counters.received();
  EXPECT_EQ(counters.receive_errors(), 126);
}

}  // namespace
}  // namespace rigwire::emulators
