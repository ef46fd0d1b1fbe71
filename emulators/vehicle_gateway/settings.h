// Settings of the vehicle gateway: its node, its machine and its time-outs.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "emulators/j1939/identity.h"
#include "emulators/supply.h"
#include "sim/samples/engine_sample.h"
#include "sim/samples/time.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire::emulators {

/// Steering modes that the machine offers (protocols/vehicle/machine.h, SteeringMode).
enum class SteeringLayout : std::uint8_t {
  front_only,  ///< Front.
  counter,     ///< Front and counter.
  crab,        ///< Front, counter and crab.
};

/// What displays shall write.
enum class DisplayUnits : std::uint8_t { metric, imperial, us };

/// How long a command stays in force without being repeated. Figures of this project, each some
/// periods of its message: the available standards do not give them.
struct VehicleTimeouts {
  Duration engine = std::chrono::milliseconds{100};     ///< TSC1, every 10 ms.
  Duration gearbox = std::chrono::milliseconds{500};    ///< TC1, every 50 ms.
  Duration brake = std::chrono::milliseconds{200};      ///< XBR, every 40 ms.
  Duration guidance = std::chrono::milliseconds{150};   ///< Guidance command, every 100 ms.
  Duration speed = std::chrono::milliseconds{300};      ///< Speed command, every 100 ms.
  Duration implement = std::chrono::milliseconds{300};  ///< Hitch and PTO command, every 100 ms.
};

void visit(fields::Visitor& v, VehicleTimeouts& p);

struct VehicleGatewaySettings {
  // The node.
  std::uint8_t source_address = 0x00;  ///< Preferred; 0 .. 253.
  std::uint32_t serial = 1;            ///< 1 .. 2097151; identity in the NAME, unique on a bus.
  J1939NameSettings name{.function = kTractorEcu, .industry_group = kAgriculture};
  bool arbitrary_address = false;  ///< Takes another address when it loses its own.
  SupplySettings supply;           ///< When it comes it claims its address.
  Duration sensor_start_up = std::chrono::milliseconds{200};   ///< From there to the first sample.
  Duration processing_delay = std::chrono::microseconds{500};  ///< From an event to the frame; 0
                                                               ///< .. 5 ms.
  IdentificationSettings identification{.model = "vehicle gateway",
                                        .type = "tractor ECU",
                                        .vehicle_identification_number = "RGWRE0SM000000001"};
  // Sent to displays until one of them sends its own.
  std::string language = "en";  ///< ISO 639.
  std::string country = "DE";   ///< ISO 3166.
  DisplayUnits units = DisplayUnits::metric;
  // The key.
  Duration key_off{0};  ///< From the start of the run; 0: never.
  Duration maximum_power_time = std::chrono::minutes{3};
  // The machine.
  // Data of the machine's engine; no keys.
  EngineData engine;
  bool has_ground_radar = false;  ///< Ground-based speed.
  std::array<bool, kImplementEnds> has_hitch{};
  std::array<bool, kImplementEnds> has_power_take_off{};
  Duration engine_hours{0};   ///< Hours of the engine when the run begins; 0 .. 200 000 h.
  bool has_position = false;  ///< A satellite receiver is wired to it: VP, VDS and VP2.
  int gears_forward = 8;      ///< 0 .. 125; the numbers that TC1 may ask for.
  int gears_reverse = 6;      ///< 0 .. 125.
  SteeringLayout steering = SteeringLayout::front_only;
  double wheelbase_m = 3.25;                  ///< Estimate. Drum axle to drum axle for a roller.
  double maximum_front_steer_rad = 0.61;      ///< Estimate. Below pi/2.
  double maximum_rear_steer_rad = 0.61;       ///< Estimate.
  double steering_ratio = 20.0;               ///< Estimate. Steering wheel to equivalent wheel.
  double maximum_speed_mps = 25.0;            ///< Max of the speed command.
  double maximum_reverse_speed_mps = 8.0;     ///< Max of the speed command in reverse.
  double full_brake_deceleration_mps2 = 6.0;  ///< Estimate. Deceleration at brake share 1.
  double minimum_tyre_pressure_pa = 50e3;     ///< Estimates; set points beyond are refused.
  double maximum_tyre_pressure_pa = 600e3;
  double maximum_spreader_rate_kgpm2 = 20.0;
  // Timeouts.
  VehicleTimeouts timeouts;
  /// Losing guidance while it steers stops the machine too: no operator is aboard to take over.
  bool stop_without_guidance = true;
  double stop_brake_share = 0.4;       ///< Estimate. Applied when the machine stops by itself.
  double standstill_speed_mps = 0.05;  ///< Below it the machine is at rest.
  Duration park_delay = std::chrono::milliseconds{500};  ///< At rest for this long: parked.
};

void visit(fields::Visitor& v, VehicleGatewaySettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const VehicleGatewaySettings& settings);

}  // namespace rigwire::emulators
