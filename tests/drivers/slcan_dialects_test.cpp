// What the two dialects of slcan differ in, and what LAWICEL's adapters know besides.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "drivers/slcan_adapter.h"
#include "fake_line.h"

namespace rigwire::drivers {
namespace {

using namespace std::chrono_literals;
using protocols::can::BusError;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::can::Frame;

ControllerReport state(ErrorState state, std::uint16_t receive, std::uint16_t transmit) {
  ControllerReport report;
  report.state = state;
  report.state_changed = true;
  report.receive_errors = receive;
  report.transmit_errors = transmit;
  return report;
}

ControllerReport error(BusError kind) {
  ControllerReport report;
  report.error = kind;
  return report;
}

Frame base(std::uint32_t id, std::uint8_t first) {
  return {id, false, false, 1, {first}};
}

class Dialect : public testing::Test {
 protected:
  void open(SlcanAdapterSettings settings) {
    adapter_ = std::make_unique<SlcanAdapter>(line_, std::move(settings));
    adapter_->start([this](const Frame& frame) { received_.push_back(frame); });
  }
  std::string ask(std::string_view text) {
    line_.feed(text);
    return line_.take();
  }
  FakeLine line_;
  std::unique_ptr<SlcanAdapter> adapter_;
  std::vector<Frame> received_;
};

TEST_F(Dialect, KernelHearsOfStatesAndErrors) {
  open({.dialect = SlcanDialect::kernel});
  ask("C\rS5\rO\r");
  EXPECT_TRUE(adapter_->report(state(ErrorState::warning, 0, 97), 1ms));
  EXPECT_TRUE(adapter_->report(state(ErrorState::passive, 128, 0), 2ms));
  EXPECT_TRUE(adapter_->report(error(BusError::acknowledgement), 3ms));
  EXPECT_TRUE(adapter_->report(state(ErrorState::bus_off, 0, 256), 4ms));
  ControllerReport restarted = state(ErrorState::active, 0, 0);
  restarted.restarted = true;
  EXPECT_TRUE(adapter_->report(restarted, 5ms));
  EXPECT_EQ(line_.take(), "sw000097\rsp128000\re1a\rsb000256\rsa000000\r");
}

TEST_F(Dialect, LawicelMastersAreToldNothingUnasked) {
  open({.dialect = SlcanDialect::lawicel, .kernel_attached = [] { return true; }});
  ask("C\rS5\rO\r");
  EXPECT_TRUE(adapter_->report(state(ErrorState::passive, 128, 0), 1ms));
  EXPECT_TRUE(adapter_->report(error(BusError::stuff), 2ms));
  EXPECT_EQ(line_.take(), "");
}

TEST_F(Dialect, AutomaticAsksWhoIsThere) {
  bool attached = false;
  int asked = 0;
  open({.kernel_attached = [&] { return ++asked, attached; }});
  ask("C\rS5\rO\r");
  EXPECT_EQ(asked, 0);
  adapter_->report(error(BusError::form), 0ms);
  adapter_->report(error(BusError::form), 1ms);  // believed for a while
  EXPECT_EQ(asked, 1);
  EXPECT_EQ(line_.take(), "");
  attached = true;
  adapter_->report(error(BusError::form), 60ms);
  EXPECT_EQ(line_.take(), "e1f\r");
  adapter_->report(error(BusError::form), 200ms);  // remembered while it is there
  EXPECT_EQ(asked, 2);
  line_.take();
  line_.hang_up();
  attached = false;
  ask("O\r");
  adapter_->report(error(BusError::form), 201ms);
  EXPECT_EQ(line_.take(), "");
}

TEST_F(Dialect, ClosedChannelIsToldNothing) {
  open({.dialect = SlcanDialect::kernel});
  EXPECT_TRUE(adapter_->report(state(ErrorState::bus_off, 0, 256), 1ms));
  EXPECT_EQ(line_.take(), "");
}

TEST_F(Dialect, StatusFlagsHoldEventsUntilReadAndStatesWhileTheyLast) {
  open({});
  ask("O\r");
  EXPECT_EQ(ask("F\r"), "F00\r");
  adapter_->report(state(ErrorState::warning, 0, 96), 1ms);
  EXPECT_EQ(ask("F\r"), "F04\r");
  EXPECT_EQ(ask("F\r"), "F04\r");
  ControllerReport passive = state(ErrorState::passive, 0, 128);
  passive.error = BusError::bit;
  passive.arbitration_lost = true;
  adapter_->report(passive, 2ms);
  EXPECT_EQ(ask("F\r"), "FE4\r");
  EXPECT_EQ(ask("F\r"), "F24\r");
  line_.room = 0;
  while (adapter_->send(base(0x123, 1))) {
  }
  line_.room = 100'000;
  EXPECT_EQ(ask("F\r").substr(8), "F2D\r") << "after the tail of the line that was kept";
  adapter_->report(state(ErrorState::active, 0, 0), 3ms);
  EXPECT_EQ(ask("F\r"), "F00\r");
}

TEST_F(Dialect, FramesBeyondTheTransmitQueueAreRefusedAloud) {
  open({.dialect = SlcanDialect::kernel, .transmit_queue_frames = 2});
  EXPECT_EQ(ask("O\rt1230\rt1230\rt1230\r"), "\r\r\re1O\r\a");
  EXPECT_EQ(received_.size(), 2U);
  EXPECT_EQ(ask("F\r"), "F02\r");
  adapter_->confirm(true, 1ms);
  EXPECT_EQ(ask("t1230\r"), "\r");
  adapter_->confirm(false, 2ms);
  adapter_->confirm(true, 3ms);
  adapter_->confirm(true, 4ms);  // more than there are changes nothing
  EXPECT_EQ(ask("t1230\rt1230\rt1230\r"), "\r\re1O\r\a");
  EXPECT_EQ(adapter_->counters().queue_full, 2U);
  EXPECT_EQ(adapter_->counters().unsent, 1U);
}

TEST_F(Dialect, PolledFramesWaitAndOverflowAloud) {
  open({});
  EXPECT_EQ(ask("X0\rO\rP\rA\r"), "\r\r\rA\r");
  for (std::uint8_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(adapter_->send(base(0x100, i)));
  }
  EXPECT_EQ(line_.take(), "");
  EXPECT_EQ(ask("P\r"), "t100100\r");
  EXPECT_EQ(ask("A\r"), "t100101\rt100102\rA\r");
  for (std::size_t i = 0; i < SlcanAdapter::kFetched; ++i) {
    EXPECT_TRUE(adapter_->send(base(0x100, 0)));
  }
  EXPECT_FALSE(adapter_->send(base(0x100, 0)));
  EXPECT_EQ(ask("F\r"), "F09\r");
  EXPECT_EQ(ask("C\rP\r"), "\r\a");
}

TEST_F(Dialect, AcceptanceFilterIsHonoured) {
  open({});
  // Dual filters: identifier 123 with any data, and identifiers 7F0..7FF.
  EXPECT_EQ(ask("W0\rM2460FE00\rm001F01FF\rO\r"), "\r\r\r\r");
  for (const std::uint32_t id : {0x122U, 0x123U, 0x7EFU, 0x7F0U, 0x7FFU}) {
    EXPECT_TRUE(adapter_->send(base(id, 0xA5)));
  }
  EXPECT_EQ(line_.take(), "t1231A5\rt7F01A5\rt7FF1A5\r");
  EXPECT_EQ(adapter_->counters().filtered, 2U);
}

// The order in which SavvyCAN opens a LAWICEL adapter and in which LAWICEL's own terminal examples
// go through it.
TEST_F(Dialect, ConversationsOfLawicelMasters) {
  open({});
  EXPECT_EQ(ask("\r\r\r"), "");
  EXPECT_EQ(ask("C\rV\rS5\rZ1\rO\r"), "\rV1013\r\r\r\r");
  EXPECT_TRUE(adapter_->deliver({0x18FEF327, true, false, 2, {0xAB, 0xCD}}, 1001ms));
  EXPECT_EQ(line_.take(), "T18FEF3272ABCD03E9\r");
  EXPECT_EQ(ask("T18EAFFFE300EE00\rr1234\r"), "\r\r");
  EXPECT_EQ(ask("C\r"), "\r");
  EXPECT_EQ(ask("U1\rX1\rO\rt7DF8020100\r"), "\r\r\r\a");  // the data is short
  EXPECT_EQ(ask("t7DF3020100\r"), "z\r");
  EXPECT_EQ(ask("C\rN\rv\r"), "\rNRW01\rv1014\r");
}

}  // namespace
}  // namespace rigwire::drivers
