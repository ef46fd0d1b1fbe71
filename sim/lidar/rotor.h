// The head's motor: where the mirror or the laser bank points at any instant. Independent of the
// firing clock, as in the real sensors.
#pragma once

#include <cstdint>
#include <string_view>

#include "sim/samples/lidar_sample.h"
#include "sim/samples/time.h"

namespace rigwire::sim {

/// Azimuth and rate of the rotor, clockwise.
struct RotorState {
  double azimuth_rad = 0.0;  ///< [0, 2 pi)
  double rate_radps = 0.0;
};

class Rotor {
 public:
  /// Stands at azimuth 0 at the start of the run, already turning at the commanded rate.
  explicit Rotor(const LidarCommand& command);

  /// From `time` on; `time` must not decrease from call to call. Throws std::invalid_argument when
  /// the rate is not finite.
  void command(SimTime time, const LidarCommand& command);

  /// At an instant not before the last command.
  [[nodiscard]] RotorState at(SimTime time) const;

 private:
  RotorState changed_;
  SimTime changed_at_ = kStart;
};

}  // namespace rigwire::sim
