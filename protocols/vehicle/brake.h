// Brakes: their state (EBC1) and the request to them (XBR).
#pragma once

#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// Electronic Brake Controller 1.
struct Ebc1 {
  static constexpr Group kGroup{"EBC1", 61441, 6, std::chrono::milliseconds{100}};

  Switch slip_control_engine = Switch::not_available;
  Switch slip_control_brake = Switch::not_available;
  Switch anti_lock_active = Switch::not_available;
  double pedal_share = kNotAvailable;
  Switch off_road_switch = Switch::not_available;
  Switch anti_lock_operational = Switch::not_available;

  static constexpr auto parameters() {
    return std::array{
        state("anti-slip engine control", 561, {1, 1}, &Ebc1::slip_control_engine),
        state("anti-slip brake control", 562, {1, 3}, &Ebc1::slip_control_brake),
        state("anti-lock braking active", 563, {1, 5}, &Ebc1::anti_lock_active),
        number("brake pedal position", 521, {2}, 8, kShare, &Ebc1::pedal_share),
        state("anti-slip off-road switch", 576, {3, 3}, &Ebc1::off_road_switch),
        state("anti-lock fully operational", 1243, {6, 1}, &Ebc1::anti_lock_operational),
    };
  }
};

/// How an external demand joins the driver's.
enum class BrakeControlMode : std::uint8_t { disabled = 0, addition = 1, maximum = 2 };

/// External Brake Request, addressed. Layout from memory of SAE J1939-71 (not in the annex
/// extract). Counter and checksum are sent as ones (not used).
struct Xbr {
  static constexpr Group kGroup{"XBR", 1024, 3, std::chrono::milliseconds{40}};

  double acceleration_mps2 = kNotAvailable;  ///< Demanded; negative slows down.
  std::uint8_t endurance_integration = 3;    ///< 2 bits: use of retarders.
  std::uint8_t priority = 3;                 ///< 2 bits: 0 highest .. 3 lowest.
  std::uint8_t control_mode = 0;             ///< BrakeControlMode.
  double urgency_share = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("external acceleration demand", 2920, {1}, 16, {1.0 / 2048.0, -15.687, "m/s2"},
               &Xbr::acceleration_mps2),
        code("endurance brake integration", 2914, {3, 1}, 2, &Xbr::endurance_integration),
        code("priority", 2915, {3, 3}, 2, &Xbr::priority),
        code("control mode", 2916, {3, 5}, 2, &Xbr::control_mode),
        number("urgency", 4099, {4}, 8, kShare, &Xbr::urgency_share),
    };
  }
};

}  // namespace rigwire::protocols::vehicle
