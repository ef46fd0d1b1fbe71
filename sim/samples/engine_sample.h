// A combustion engine as its controller knows it: what it is, and how it is doing. Whatever machine
// it drives.
//
// Torques are at the crank: what the flywheel gets, negative when the engine drags. What the
// cylinders make (J1939's "indicated" torque) is that and the engine's own friction. SI units.
#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <numbers>

namespace rigwire {

/// What a machine has no sensor for.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// Revolutions per minute in rad/s, rounded as a file's "n rpm" is.
[[nodiscard]] constexpr double rpm(double value) {
  return value * std::numbers::pi / 30.0;
}

/// A point of the full-load curve with the friction that goes with it.
struct EnginePoint {
  double speed_radps = 0.0;
  double torque_nm = 0.0;
  double friction_nm = 0.0;  ///< Never negative.
};

/// What does not change: an engine's data sheet.
struct EngineData {
  /// At idle first, at the end of full load last; speeds rise.
  static constexpr std::size_t kPoints = 5;
  std::array<EnginePoint, kPoints> full_load{};
  double high_idle_radps = 0.0;      ///< Governed out, without load.
  double reference_torque_nm = 0.0;  ///< 100 % of all torque shares: the maximum indicated one.
  double governor_nmsprad = 0.0;     ///< End-speed governor: torque per missing speed.
  double inertia_kgm2 = 0.0;         ///< Crank and flywheel.
};

/// How it is doing at one instant.
struct EngineSample {
  double speed_radps = 0.0;
  double torque_nm = 0.0;
  double friction_nm = 0.0;             ///< Its own at this speed, never negative.
  double full_load_nm = 0.0;            ///< Most that it could give at this speed.
  double desired_radps = kNotMeasured;  ///< Speed towards which its governor works.
  double coolant_c = kNotMeasured;
  double oil_c = kNotMeasured;
  double oil_pressure_pa = kNotMeasured;
  double fuel_pressure_pa = kNotMeasured;  ///< Delivery.
  double coolant_level_share = kNotMeasured;
  double oil_level_share = kNotMeasured;
  double fuel_level_share = kNotMeasured;
  double fuel_rate_m3ps = kNotMeasured;
  double fuel_used_m3 = kNotMeasured;  ///< Since the start of the run.
  double battery_v = kNotMeasured;
  double battery_a = kNotMeasured;  ///< Into the battery.
  double alternator_a = kNotMeasured;
};

}  // namespace rigwire
