// A gateway fed with any frames, with time going on in between: whatever arrives, its command stays
// within the machine's limits, an unasked machine stays parked, frames leave in order, and every
// frame that came is counted once.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "emulators/vehicle_gateway/vehicle_gateway.h"
#include "frame_output.h"
#include "protocols/bytes.h"

namespace emulators = rigwire::emulators;
using rigwire::protocols::can::Frame;

namespace {

using rigwire::fuzz::Output;
using rigwire::fuzz::require;

void check(const rigwire::VehicleCommand& command, const emulators::VehicleGatewaySettings& limits,
           rigwire::SimTime now) {
  const auto share = [](double value) { require(value >= 0.0 && value <= 1.0); };
  share(command.engine_torque_share);
  share(command.brake_share);
  share(command.edge_cutter_share);
  require(command.time <= now);
  require(command.engine_speed_radps >= 0.0 && command.engine_speed_radps < 1000.0);
  const double travel_mps = command.travel_speed_mps.value_or(0.0);
  require(travel_mps <= limits.maximum_speed_mps &&
          travel_mps >= -limits.maximum_reverse_speed_mps);
  require(command.gear <= limits.gears_forward && command.gear >= -limits.gears_reverse);
  require(std::abs(command.front_steer_rad) <= limits.maximum_front_steer_rad);
  require(std::abs(command.rear_steer_rad) <= limits.maximum_rear_steer_rad);
  require(command.spreader_rate_kgpm2 >= 0.0 &&
          command.spreader_rate_kgpm2 <= limits.maximum_spreader_rate_kgpm2);
  for (const double pressure : command.tyre_pressure_pa) {
    require(pressure == 0.0 || (pressure >= limits.minimum_tyre_pressure_pa &&
                                pressure <= limits.maximum_tyre_pressure_pa));
  }
}

}  // namespace

/// Each record is (identifier, format, length, wait in ms, data).
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::size_t kRecord = 4 + 1 + 1 + 1 + 8;
  emulators::VehicleGatewaySettings settings;
  settings.steering = emulators::SteeringLayout::crab;
  settings.arbitrary_address = true;
  Output output;
  emulators::VehicleGateway gateway(settings, output);
  rigwire::SimTime now = rigwire::kStart;
  gateway.advance(now);
  std::uint64_t fed = 0;
  for (; size >= kRecord; data += kRecord, size -= kRecord) {
    Frame frame;
    frame.id = rigwire::protocols::load_little<std::uint32_t>(std::span(data, size), 0);
    frame.extended = (data[4] & 1U) != 0;
    frame.remote = (data[4] & 2U) != 0;
    frame.length = data[5];
    std::copy_n(data + 7, frame.data.size(), frame.data.begin());
    now += std::chrono::milliseconds(data[6]);
    rigwire::VehicleSample sample;
    sample.time = now;
    sample.odometry.speed_mps = frame.data[0] * 0.01;
    gateway.update(sample);
    gateway.receive(now, frame);
    ++fed;
    require(gateway.next_event() > now);
    check(gateway.command(), settings, now);
    require(gateway.received().accepted > 0 || gateway.command() == rigwire::VehicleCommand{});
  }
  const auto counters = gateway.received();
  require(counters.accepted + counters.ignored + counters.malformed == fed);
  return 0;
}
