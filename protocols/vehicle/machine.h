// What the standards have no message for: parking brake, crawler group and the functions of a
// roller, in one proprietary message each way. Both layouts are this project's own. Also here: the
// hydraulic pressure governor (HPG).
#pragma once

#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/message.h"

namespace rigwire::protocols::vehicle {

/// Hydraulic Pressure Governor Info.
struct Hpg {
  static constexpr Group kGroup{"HPG", 61448, 6, std::chrono::milliseconds{50}};

  double pressure_pa = kNotAvailable;

  static constexpr auto parameters() {
    return std::array{
        number("hydraulic pressure", 1762, {1}, 16, {2000.0, 0.0, "Pa", kInKilopascal},
               &Hpg::pressure_pa),
    };
  }
};

/// Steering axles (or drums), and how they steer.
enum class SteeringMode : std::uint8_t {
  front = 0,    ///< Front axle only.
  counter = 1,  ///< Both axles in opposite directions: the smallest circle.
  /// Both by the crab angle in one direction, and in opposite directions for the curvature.
  crab = 2,
  not_available = 0xF,
};

/// One count of 1/256 degree, from -125 degrees.
inline constexpr Scale kMachineAngle{kDegree_rad / 256.0, -125.0 * kDegree_rad, "rad", kInDegree};
/// One count of 1 g/m2.
inline constexpr Scale kSpreaderRate{0.001, 0.0, "kg/m2"};

/// Machine function command: Proprietary A (61184), addressed. A value that is not available
/// changes nothing. On change; repeating it is harmless.
struct MachineFunctionCommand {
  static constexpr Group kGroup{"MFC", 61184, 6, std::chrono::milliseconds{0}};

  Switch parking_brake = Switch::not_available;
  Switch crawler_group = Switch::not_available;
  Switch vibration_front = Switch::not_available;
  Switch vibration_rear = Switch::not_available;
  std::uint8_t steering_mode = 0xF;       ///< SteeringMode; 4 bits.
  double crab_angle_rad = kNotAvailable;  ///< Crab angle of both drums, left positive.
  double edge_cutter_share = kNotAvailable;
  double spreader_rate_kgpm2 = kNotAvailable;

  static constexpr auto parameters() {
    using M = MachineFunctionCommand;
    return std::array{
        state("parking brake", 0, {1, 1}, &M::parking_brake),
        state("crawler group", 0, {1, 3}, &M::crawler_group),
        state("vibration, front", 0, {1, 5}, &M::vibration_front),
        state("vibration, rear", 0, {1, 7}, &M::vibration_rear),
        code("steering mode", 0, {2, 1}, 4, &M::steering_mode),
        number("crab angle", 0, {3}, 16, kMachineAngle, &M::crab_angle_rad),
        number("edge cutter", 0, {5}, 8, kShare, &M::edge_cutter_share),
        number("spreader rate", 0, {6}, 16, kSpreaderRate, &M::spreader_rate_kgpm2),
    };
  }
};

/// Machine function state: Proprietary B (65408), to everybody.
struct MachineFunctionState {
  static constexpr Group kGroup{"MFS", 65408, 6, std::chrono::milliseconds{100}};

  Switch parking_brake = Switch::not_available;
  Switch crawler_group = Switch::not_available;
  Switch vibration_front = Switch::not_available;
  Switch vibration_rear = Switch::not_available;
  double edge_cutter_share = kNotAvailable;
  double spreader_rate_kgpm2 = kNotAvailable;
  double hopper_mass_kg = kNotAvailable;
  double slip_angle_rad = kNotAvailable;  ///< Slip angle of the odometry, left positive.

  static constexpr auto parameters() {
    using M = MachineFunctionState;
    return std::array{
        state("parking brake", 0, {1, 1}, &M::parking_brake),
        state("crawler group", 0, {1, 3}, &M::crawler_group),
        state("vibration, front", 0, {1, 5}, &M::vibration_front),
        state("vibration, rear", 0, {1, 7}, &M::vibration_rear),
        number("edge cutter", 0, {2}, 8, kShare, &M::edge_cutter_share),
        number("spreader rate", 0, {3}, 16, kSpreaderRate, &M::spreader_rate_kgpm2),
        number("hopper mass", 0, {5}, 16, {1.0, 0.0, "kg"}, &M::hopper_mass_kg),
        number("slip angle", 0, {7}, 16, kMachineAngle, &M::slip_angle_rad),
    };
  }
};

}  // namespace rigwire::protocols::vehicle
