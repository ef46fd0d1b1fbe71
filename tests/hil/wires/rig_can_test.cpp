#include "hil/wires/rig_can.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "protocols/can/bits.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using protocols::can::ControllerReport;
using protocols::can::ErrorState;
using protocols::can::Frame;
using testing::ElementsAre;

/// The last hop, as the test sees it.
class Endpoint final : public drivers::CanBus {
 public:
  void start(Receiver) override {}
  bool send(const Frame&) override { return false; }
  bool deliver(const Frame& frame, Stamp stamp) override {
    log.push_back("frame " + std::to_string(frame.id));
    stamps.push_back(stamp);
    return true;
  }
  void confirm(bool sent, Stamp stamp) override {
    log.push_back(sent ? "sent" : "unsent");
    stamps.push_back(stamp);
  }
  bool report(const ControllerReport& report, Stamp) override {
    reports.push_back(report);
    return true;
  }
  [[nodiscard]] drivers::EndpointStatus status() const override { return {"endpoint", true}; }

  [[nodiscard]] bool was_in(ErrorState state) const {
    return std::any_of(reports.begin(), reports.end(),
                       [state](const ControllerReport& report) { return report.state == state; });
  }
  std::vector<std::string> log;
  std::vector<Stamp> stamps;
  std::vector<ControllerReport> reports;
};

Frame frame(std::uint32_t id) {
  return {id, false, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
}
Duration length(const Frame& of, int bit_rate_bps = 250'000) {
  return (protocols::can::exact_bits(of) - protocols::can::kInterframeBits) *
         Duration{1'000'000'000 / bit_rate_bps};
}

class Line {
 public:
  explicit Line(RigCanSettings settings = {})
      : line(emulators::CanBusSettings{}, endpoint, settings) {}
  void run_until(SimTime end) {
    for (;;) {
      const SimTime next = std::min(line.next_event(), line.outlet().next_due());
      if (next > end) {
        return;
      }
      if (next == line.outlet().next_due()) {
        line.outlet().transmit_front({});
      } else {
        line.advance(next);
      }
    }
  }
  Endpoint endpoint;
  RigCan line;
  WireStatistics statistics;
};

TEST(RigCan, DevicesFrameIsStampedWithItsEndOnTheBus) {
  Line bus;
  emulators::FrameOutput& node = bus.line.add_node(bus.statistics);
  node.send(kStart + 1ms, frame(0x100));
  bus.run_until(kStart + 10ms);
  EXPECT_THAT(bus.endpoint.log, ElementsAre("frame 256"));
  EXPECT_THAT(bus.endpoint.stamps, ElementsAre(1ms + length(frame(0x100))));
  EXPECT_EQ(bus.statistics.units, 1U);
}

TEST(RigCan, ClientsFramesAreConfirmedWhenTheyHaveWonTheBus) {
  Line bus;
  emulators::FrameOutput& node = bus.line.add_node(bus.statistics);
  node.send(kStart + 1ms, frame(0x100));
  bus.line.receive(kStart + 1ms, frame(0x101));
  bus.line.receive(kStart + 1ms, frame(0x102));
  bus.run_until(kStart + 10ms);
  EXPECT_THAT(bus.endpoint.log, ElementsAre("frame 256", "sent", "sent"));
  EXPECT_TRUE(bus.endpoint.reports.empty());
  EXPECT_EQ(bus.statistics.units, 1U);
}

TEST(RigCan, WithoutClientOrOthersADeviceIsAloneUntilOneComes) {
  Line bus({.client_is_known = true});
  emulators::FrameOutput& node = bus.line.add_node(bus.statistics);
  node.send(kStart + 1ms, frame(0x100));
  bus.run_until(kStart + 100ms);
  EXPECT_TRUE(bus.endpoint.log.empty());
  EXPECT_EQ(bus.line.bus().controller(node).state, ErrorState::passive) << "and not bus-off";
  bus.line.client(kStart + 100ms, {.open = true});
  bus.run_until(kStart + 110ms);
  EXPECT_THAT(bus.endpoint.log, ElementsAre("frame 256"));
}

TEST(RigCan, AnAcknowledgingNodeKeepsADeviceCompany) {
  Line bus({.client_is_known = true, .acknowledging_node = true});
  emulators::FrameOutput& node = bus.line.add_node(bus.statistics);
  node.send(kStart + 1ms, frame(0x100));
  bus.run_until(kStart + 10ms);
  EXPECT_EQ(bus.statistics.units, 1U);
  EXPECT_EQ(bus.line.bus().controller(node).state, ErrorState::active);
}

TEST(RigCan, ClientAtAnotherRateIsToldOfItsErrorsAndThrownOffTheBus) {
  Line bus(
      {.client_restart_after = std::nullopt, .client_is_known = true, .acknowledging_node = true});
  emulators::FrameOutput& node = bus.line.add_node(bus.statistics);
  bus.line.client(kStart, {.open = true, .bit_rate_bps = 500'000});
  bus.line.receive(kStart + 1ms, frame(0x101));
  for (int i = 0; i < 100; ++i) {
    node.send(kStart + 1ms + i * 1ms, frame(0x100));
  }
  bus.run_until(kStart + 300ms);
  EXPECT_TRUE(bus.endpoint.was_in(ErrorState::warning));
  EXPECT_TRUE(bus.endpoint.was_in(ErrorState::passive));
  EXPECT_TRUE(bus.endpoint.was_in(ErrorState::bus_off));
  EXPECT_EQ(std::count(bus.endpoint.log.begin(), bus.endpoint.log.end(), "unsent"), 1);
  EXPECT_EQ(std::count(bus.endpoint.log.begin(), bus.endpoint.log.end(), "sent"), 0);
}

TEST(RigCan, ClientThatClosesLearnsThatItsFramesAreLost) {
  Line bus({.client_is_known = true, .acknowledging_node = true});
  bus.line.client(kStart, {.open = true});
  bus.line.receive(kStart, frame(0x101));
  bus.line.receive(kStart, frame(0x102));
  bus.line.client(kStart, {});
  bus.run_until(kStart + 10ms);
  EXPECT_THAT(bus.endpoint.log, ElementsAre("unsent", "unsent"));
}

TEST(RigCan, FramesBeyondTheQueueAreSettledToo) {
  Line bus({.acknowledging_node = true});
  for (int i = 0; i < 100; ++i) {
    bus.line.receive(kStart, frame(0x101));
  }
  bus.run_until(kStart + 100ms);
  EXPECT_EQ(bus.endpoint.log.size(), 100U);
  EXPECT_GE(std::count(bus.endpoint.log.begin(), bus.endpoint.log.end(), "sent"), 64);
}

TEST(RigCan, FaultsFindADeviceByItsName) {
  Line bus({.acknowledging_node = true});
  bus.line.begin_device("imu");
  emulators::FrameOutput& node = bus.line.add_node(bus.statistics);
  emulators::CanBusFault fault;
  fault.kind = emulators::CanBusFaultKind::disconnected;
  fault.end = 50ms;
  fault.node = "imu";
  bus.line.set_faults({{fault}, 1});
  node.send(kStart + 1ms, frame(0x100));
  bus.run_until(kStart + 49ms);
  EXPECT_EQ(bus.statistics.units, 0U);
  bus.run_until(kStart + 60ms);
  EXPECT_EQ(bus.statistics.units, 1U);
}

}  // namespace
}  // namespace rigwire::hil
