// An engine with hydraulic pumps: what its controller may ask of it, and what its sensors read.
#pragma once

#include <optional>

#include "sim/samples/engine_sample.h"
#include "sim/samples/time.h"

namespace rigwire {

/// Holds until the next. The default leaves the engine to the machine's own dial.
struct PowerUnitCommand {
  SimTime time{};                     ///< When it was asked.
  std::optional<double> speed_radps;  ///< In place of the dial's.
  double torque_limit_share = 1.0;    ///< 0 .. 1 of EngineData's reference torque.

  /// Whether both ask for the same, whatever their time.
  friend bool operator==(const PowerUnitCommand& a, const PowerUnitCommand& b) {
    return a.speed_radps == b.speed_radps && a.torque_limit_share == b.torque_limit_share;
  }
};

struct PowerUnitSample {
  SimTime time{};
  EngineSample engine;
  double dial_radps = 0.0;  ///< Speed set at the machine's own dial.
  double dial_share = 0.0;  ///< The dial, 0 idle .. 1 maximum speed.
  double pump_pressure_pa = 0.0;
  double pump_flow_m3ps = 0.0;
  double pump_torque_nm = 0.0;
};

}  // namespace rigwire
