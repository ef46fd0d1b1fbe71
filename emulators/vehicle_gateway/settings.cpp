#include "emulators/vehicle_gateway/settings.h"

#include <algorithm>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string_view>

namespace rigwire::emulators {
namespace {

template <class Value>
void refuse(std::string_view key, Value value, std::string_view allowed) {
  std::ostringstream text;
  text << "vehicle gateway: " << key << " is " << value << ", allowed is " << allowed;
  throw std::invalid_argument(text.str());
}

void in_range(std::string_view key, double value, double lower, double upper) {
  if (!(value >= lower && value <= upper)) {
    std::ostringstream allowed;
    allowed << lower << " .. " << upper;
    refuse(key, value, allowed.str());
  }
}

void in_range(std::string_view key, Duration value, Duration lower, Duration upper) {
  if (value < lower || value > upper) {
    std::ostringstream allowed;
    allowed << to_seconds(lower) << " .. " << to_seconds(upper) << " s";
    refuse(key, to_seconds(value), allowed.str());
  }
}

void readable(std::string_view key, const std::string& value) {
  constexpr std::size_t kGreatest = 32;
  const bool plain =
      std::ranges::all_of(value, [](char c) { return c >= ' ' && c <= '~' && c != '*'; });
  if (!plain || value.size() > kGreatest) {
    refuse(key, "'" + value + "'", "up to 32 printable ASCII characters without *");
  }
}

}  // namespace

void validate(const VehicleGatewaySettings& s) {
  using namespace std::chrono_literals;
  constexpr double kRightAngle_rad = std::numbers::pi / 2.0;
  in_range("source_address", s.source_address, 0, 253);
  in_range("serial", s.serial, 1, 0x1FFFFF);
  in_range("manufacturer", s.manufacturer, 0, 0x7FF);
  in_range("power_on", s.power_on, 0s, 24h);
  in_range("sensor_start_up", s.sensor_start_up, 0s, 1h);
  in_range("processing_delay", s.processing_delay, 0s, 5ms);
  readable("make", s.make);
  readable("model", s.model);
  readable("unit_number", s.unit_number);
  readable("software", s.software);
  in_range("engine_hours", s.engine_hours, 0s, 200'000h);
  in_range("gears_forward", s.gears_forward, 0, 125);
  in_range("gears_reverse", s.gears_reverse, 0, 125);
  in_range("wheelbase", s.wheelbase_m, 0.1, 100.0);
  in_range("maximum_front_steer", s.maximum_front_steer_rad, 1e-3, kRightAngle_rad - 1e-3);
  in_range("maximum_rear_steer", s.maximum_rear_steer_rad, 1e-3, kRightAngle_rad - 1e-3);
  in_range("steering_ratio", s.steering_ratio, 0.1, 100.0);
  in_range("maximum_speed", s.maximum_speed_mps, 0.0, 64.255);
  in_range("maximum_reverse_speed", s.maximum_reverse_speed_mps, 0.0, 64.255);
  in_range("full_brake_deceleration", s.full_brake_deceleration_mps2, 0.1, 15.0);
  in_range("minimum_tyre_pressure", s.minimum_tyre_pressure_pa, 0.0, 2e6);
  in_range("maximum_tyre_pressure", s.maximum_tyre_pressure_pa, s.minimum_tyre_pressure_pa, 2e6);
  in_range("maximum_spreader_rate", s.maximum_spreader_rate_kgpm2, 0.0, 64.255);
  in_range("timeouts.engine", s.timeouts.engine, 10ms, 10s);
  in_range("timeouts.gearbox", s.timeouts.gearbox, 10ms, 10s);
  in_range("timeouts.brake", s.timeouts.brake, 10ms, 10s);
  in_range("timeouts.guidance", s.timeouts.guidance, 10ms, 10s);
  in_range("timeouts.speed", s.timeouts.speed, 10ms, 10s);
  in_range("stop_brake_share", s.stop_brake_share, 0.0, 1.0);
  in_range("standstill_speed", s.standstill_speed_mps, 1e-3, 1.0);
  in_range("park_delay", s.park_delay, 0s, 1h);
}

}  // namespace rigwire::emulators
