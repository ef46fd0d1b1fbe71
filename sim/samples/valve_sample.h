// Hydraulic valves: what the driver commands, and what the machine's sensors report back to it.
#pragma once

#include <array>
#include <cstddef>

#include "sim/samples/time.h"

namespace rigwire {

/// Sections of one valve block.
inline constexpr std::size_t kValveSections = 8;

/// Spool set points, the actuator command that leaves a valve driver.
struct ValveCommand {
  SimTime time{};                                ///< When the driver's output changed.
  std::array<double, kValveSections> opening{};  ///< -1 .. 1 of full spool travel; 0 = neutral.
  std::array<bool, kValveSections> floating{};   ///< Both ports to tank; opening is ignored.

  /// Whether both ask for the same, whatever their time.
  friend bool operator==(const ValveCommand& a, const ValveCommand& b) {
    return a.opening == b.opening && a.floating == b.floating;
  }
};

/// What the transducers on the valve block and on the machine measure.
struct ValveSample {
  SimTime time{};
  std::array<double, kValveSections> spool_position{};  ///< -1 .. 1 of full travel.
  std::array<double, kValveSections>
      port_a_pressure_pa{};  ///< Cylinder bottom side, or motor port A.
  std::array<double, kValveSections> port_b_pressure_pa{};  ///< Cylinder rod side, or motor port B.
  double supply_pressure_pa = 0.0;
  double tank_pressure_pa = 0.0;
  double swing_angle_rad = 0.0;  ///< Upper structure against undercarriage, left positive.
  double swing_rate_radps = 0.0;
  double oil_temperature_c = 50.0;
};

}  // namespace rigwire
