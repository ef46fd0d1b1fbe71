// What CAN devices send by themselves, from their configuration alone.
#pragma once

#include "hil/devices/device_types.h"

namespace rigwire::hil {

/// Frames per second. Throws std::invalid_argument for settings that make no device.
[[nodiscard]] double frame_rate_hz(const OpenImuDeviceConfiguration& device);
[[nodiscard]] double frame_rate_hz(const XsensMtiConfiguration& device);
/// As if a master had started it.
[[nodiscard]] double frame_rate_hz(const EncoderDeviceConfiguration& device);
[[nodiscard]] double frame_rate_hz(const StarFireConfiguration& device);
[[nodiscard]] double frame_rate_hz(const VehicleGatewayDeviceConfiguration& device);
[[nodiscard]] double frame_rate_hz(const IsoValvesConfiguration& device);

}  // namespace rigwire::hil
