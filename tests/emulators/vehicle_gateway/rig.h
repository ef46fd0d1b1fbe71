// A vehicle gateway under test: its samples, the controller that talks to it, and what it sends.
#pragma once

#include <cstdint>

#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "recorder.h"

namespace rigwire::emulators {

constexpr std::uint8_t kController = 0x27;
constexpr double kRpm = protocols::vehicle::kRevolutionPerMinute_radps;

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

  test::FrameRecorder output;
  VehicleGateway gateway;
  SimTime now = kStart;
};

}  // namespace rigwire::emulators
