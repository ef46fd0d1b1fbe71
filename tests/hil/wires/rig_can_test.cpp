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
  bus.line.set_faults({{{{0ms, 50ms}, emulators::DisconnectedFault{"imu"}}}, 1});
  node.send(kStart + 1ms, frame(0x100));
  bus.run_until(kStart + 49ms);
  EXPECT_EQ(bus.statistics.units, 0U);
  bus.run_until(kStart + 60ms);
  EXPECT_EQ(bus.statistics.units, 1U);
}

// ---- Further ports.

/// A bus with one further port.
class TwoPorts {
 public:
  explicit TwoPorts(RigCanSettings settings = {.client_is_known = true}) : first(settings) {}
  /// Both ways outside, in order of time.
  void run_until(SimTime end) {
    for (;;) {
      Outlet* const outlet = first.line.outlet().next_due() <= port.outlet().next_due()
                                 ? &first.line.outlet()
                                 : &port.outlet();
      const SimTime next = std::min(first.line.next_event(), outlet->next_due());
      if (next > end) {
        return;
      }
      if (next == outlet->next_due()) {
        outlet->transmit_front({});
      } else {
        first.line.advance(next);
      }
    }
  }
  Line first;
  Endpoint second;
  RigCan::Port& port = first.line.add_port("client.1", second, true);
};

TEST(RigCanPorts, EveryPortHearsTheDevicesAndWhatTheOthersSend) {
  TwoPorts bus;
  emulators::FrameOutput& node = bus.first.line.add_node(bus.first.statistics);
  bus.first.line.client(kStart, {.open = true});
  bus.port.client(kStart, {.open = true});
  node.send(kStart + 1ms, frame(0x100));
  bus.first.line.receive(kStart + 1ms, frame(0x101));
  bus.port.receive_from_client(kStart + 1ms, frame(0x102));
  bus.run_until(kStart + 10ms);
  EXPECT_THAT(bus.first.endpoint.log, ElementsAre("frame 256", "sent", "frame 258"));
  EXPECT_THAT(bus.second.log, ElementsAre("frame 256", "frame 257", "sent"));
  EXPECT_EQ(bus.second.stamps[0], bus.first.endpoint.stamps[0]) << "at one instant";
  EXPECT_EQ(bus.first.statistics.units, 1U) << "of the device alone";
}

TEST(RigCanPorts, APortThatNobodyHasOpenIsNotOnTheBus) {
  TwoPorts bus;
  emulators::FrameOutput& node = bus.first.line.add_node(bus.first.statistics);
  node.send(kStart + 1ms, frame(0x100));
  bus.run_until(kStart + 100ms);
  EXPECT_TRUE(bus.second.log.empty());
  EXPECT_EQ(bus.first.line.bus().controller(node).state, ErrorState::passive)
      << "nobody acknowledges";
  bus.port.client(kStart + 100ms, {.open = true});
  bus.run_until(kStart + 110ms);
  EXPECT_THAT(bus.second.log, ElementsAre("frame 256"));
  EXPECT_THAT(bus.first.endpoint.log, ElementsAre("frame 256")) << "closed: taken and forgotten";
}

TEST(RigCanPorts, APortHasItsOwnBitRateAndItsOwnErrors) {
  TwoPorts bus;
  emulators::FrameOutput& node = bus.first.line.add_node(bus.first.statistics);
  bus.first.line.client(kStart, {.open = true});
  bus.port.client(kStart, {.open = true, .bit_rate_bps = 500'000});
  for (int i = 0; i < 40; ++i) {
    node.send(kStart + i * 10ms, frame(0x100));
  }
  bus.run_until(kStart + 400ms);
  EXPECT_TRUE(bus.second.was_in(ErrorState::passive)) << "who is at the wrong rate is told";
  EXPECT_TRUE(bus.second.log.empty());
  EXPECT_FALSE(bus.first.endpoint.log.empty()) << "once it is passive the others go on";
}

TEST(RigCanPorts, APortThatListensOnlySendsNothing) {
  TwoPorts bus;
  bus.first.line.client(kStart, {.open = true});
  bus.port.client(kStart, {.open = true, .listen_only = true});
  bus.port.receive_from_client(kStart + 1ms, frame(0x102));
  bus.run_until(kStart + 10ms);
  EXPECT_THAT(bus.second.log, ElementsAre("unsent"));
  EXPECT_TRUE(bus.first.endpoint.log.empty());
}

TEST(RigCanPorts, AFaultMayMeanAPort) {
  TwoPorts bus;
  emulators::FrameOutput& node = bus.first.line.add_node(bus.first.statistics);
  bus.first.line.set_faults({{{{0ms, 50ms}, emulators::DisconnectedFault{"client.1"}}}, 1});
  bus.first.line.client(kStart, {.open = true});
  bus.port.client(kStart, {.open = true});
  node.send(kStart + 10ms, frame(0x100));
  node.send(kStart + 60ms, frame(0x101));
  bus.run_until(kStart + 100ms);
  EXPECT_THAT(bus.first.endpoint.log, ElementsAre("frame 256", "frame 257"));
  EXPECT_THAT(bus.second.log, ElementsAre("frame 257"));
}

TEST(RigCanPorts, StatusCountsPortsAndTheirClients) {
  TwoPorts bus;
  EXPECT_EQ(bus.first.line.endpoint().further_ports, 1U);
  EXPECT_EQ(bus.first.line.endpoint().address, "endpoint");
}

}  // namespace
}  // namespace rigwire::hil
