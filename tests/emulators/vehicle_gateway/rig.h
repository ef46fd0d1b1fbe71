// A vehicle gateway under test: its samples, the controller that talks to it, and what it sends.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
#include <vector>

#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "protocols/j1939/message.h"

namespace rigwire::emulators {

constexpr std::uint8_t kController = 0x27;
constexpr double kRpm = protocols::vehicle::kRevolutionPerMinute_radps;

/// Records the frames that a node sends, and holds that they are due in order.
struct VehicleBus final : FrameOutput {
  void send(SimTime due, const protocols::can::Frame& frame) override {
    EXPECT_GE(due, last);
    last = due;
    frames.emplace_back(due, frame);
  }
  /// When frames of one group were due.
  [[nodiscard]] std::vector<SimTime> times(std::uint32_t pgn) const {
    std::vector<SimTime> result;
    for (const auto& [due, frame] : frames) {
      if (protocols::j1939::unpack(frame.id).pgn == pgn) {
        result.push_back(due);
      }
    }
    return result;
  }
  /// Frames of one group, oldest first.
  [[nodiscard]] std::vector<protocols::can::Frame> of(std::uint32_t pgn) const {
    std::vector<protocols::can::Frame> result;
    for (const auto& [due, frame] : frames) {
      if (protocols::j1939::unpack(frame.id).pgn == pgn) {
        result.push_back(frame);
      }
    }
    return result;
  }
  /// The latest message of its kind; everything not available when there is none.
  template <class Message>
  [[nodiscard]] Message latest() const {
    const auto found = of(Message::kGroup.pgn);
    if (found.empty()) {
      ADD_FAILURE() << "no " << Message::kGroup.name;
      return {};
    }
    const auto decoded = protocols::vehicle::decode<Message>(found.back());
    EXPECT_TRUE(decoded.ok());
    return decoded.ok() ? *decoded : Message{};
  }
  SimTime last = kStart;
  std::vector<std::pair<SimTime, protocols::can::Frame>> frames;
};

/// A machine that stands with its engine at idle.
inline VehicleSample standing() {
  VehicleSample sample;
  sample.engine.speed_radps = 800.0 * kRpm;
  sample.wheel_radius_m.fill(0.565);
  sample.tyre_pressure_pa.fill(300e3);
  return sample;
}

/// A gateway with its samples every 10 ms.
struct VehicleRig {
  explicit VehicleRig(const VehicleGatewaySettings& settings = {}) : gateway(settings, output) {}

  void run(Duration span, VehicleSample sample = standing()) {
    const SamplePlan plan = gateway.sample_plan();
    const SimTime end = now + span;
    for (SimTime t = plan.next_after(now - Duration{1}); t < end; t = plan.next_after(t)) {
      sample.time = t;
      gateway.update(sample);
    }
    gateway.advance(end);
    now = end;
  }
  void receive(const protocols::can::Frame& frame) { gateway.receive(now, frame); }
  template <class Message>
  void ask(const Message& message) {
    receive(protocols::vehicle::encode(message, kController, gateway.address()));
  }
  [[nodiscard]] const VehicleCommand& command() const { return gateway.command(); }

  VehicleBus output;
  VehicleGateway gateway;
  SimTime now = kStart;
};

}  // namespace rigwire::emulators
