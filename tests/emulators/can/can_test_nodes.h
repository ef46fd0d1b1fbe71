// What the tests of the CAN bus put on it and listen with.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "emulators/can/can_bus.h"
#include "recorder.h"

namespace rigwire::emulators::test {

using protocols::can::ControllerReport;
using protocols::can::Frame;

/// An exit that only counts.
struct Counter final : FrameOutput {
  void send(SimTime, const Frame&) override { ++frames; }
  std::uint64_t frames = 0;
};

using Reports = std::vector<std::pair<SimTime, ControllerReport>>;

/// A node that records what it hears, and understands one identifier.
class Listener final : public CanDevice {
 public:
  [[nodiscard]] std::vector<protocols::can::OwnedMessage> messages(
      std::string_view /*name*/) const override {
    return {};
  }
  void advance(SimTime) override {}
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SamplePlan sample_plan() const override { return {}; }
  [[nodiscard]] ReceiveCounters received() const override { return counters; }
  [[nodiscard]] double nominal_rate_hz() const override { return 0.0; }
  [[nodiscard]] std::span<const Quantity> quantities() const override { return {}; }
  void receive(SimTime now, const Frame& frame) override {
    heard.emplace_back(now, frame);
    counters.accepted += frame.id == understood ? 1U : 0U;
  }
  void controller(SimTime now, const ControllerReport& report) override {
    reports.emplace_back(now, report);
  }
  std::vector<std::pair<SimTime, Frame>> heard;
  Reports reports;
  std::uint32_t understood = 0xFFFFFFFF;
  ReceiveCounters counters;
};

/// The client.
struct Client final : CanOutside {
  void confirm(SimTime now, bool sent) override { confirmed.emplace_back(now, sent); }
  void report(SimTime now, const ControllerReport& report) override {
    reports.emplace_back(now, report);
  }
  std::vector<std::pair<SimTime, bool>> confirmed;
  Reports reports;
};

/// The first report of that state as a change; kNever without one.
inline SimTime time_of(const Reports& reports, protocols::can::ErrorState state) {
  for (const auto& [time, report] : reports) {
    if (report.state_changed && report.state == state) {
      return time;
    }
  }
  return kNever;
}

inline bool conserved(const CanNodeCounters& counters) {
  return counters.offered ==
         counters.sent + counters.overflowed + counters.abandoned + counters.queued;
}

inline Frame standard(std::uint32_t id) {
  return {id, false, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
}
inline Frame extended(std::uint32_t id) {
  return {id, true, false, 8, {1, 2, 3, 4, 5, 6, 7, 8}};
}

/// Worked by hand, bit by bit:
///
///   number   0   1 .. 11       12 13 14  15 16 17 18 19  20 .. 27
///   bit      0   01010101010    0  0  0   0  s  0  0  1  10101010
///            SOF identifier   RTR IDE r0  length 0001    data
///
/// s, a recessive stuff bit, follows five dominant ones (11 .. 15).
inline Frame worked_frame() {
  return {0x2AA, false, false, 1, {0xAA}};
}

}  // namespace rigwire::emulators::test
