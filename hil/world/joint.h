// Rotary encoders on the machine's joints, in the simulated world.
#pragma once

#include <cstddef>
#include <memory>

#include "hil/world/world_sensor.h"
#include "sim/encoder/joint_angle.h"

namespace rigwire::hil {

/// Reads link `moving` against link `base` and puts an EncoderSample on the station's shelf for
/// each instant of its plan.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_joint(StationIndex station, std::size_t base,
                                                            std::size_t moving,
                                                            sim::JointAngle angle);

}  // namespace rigwire::hil
