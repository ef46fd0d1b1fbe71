// From one echo in SI units to a channel of the data packet: distance in the model's counts, and
// the reflectivity byte.
//
// Reflectivity: VLP-16 user's manual 63-9243 Rev. D, section 6.1 "calibrated reflectivity" (0 ..
// 100 diffuse, 101 .. 255 retro-reflectors, 255 ideal); VLS-128 manual (0 .. 110, 111 .. 255). How
// the retro part is divided is ours: linear in how near the reflector is to an ideal one.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/model.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::emulators {

class ReturnEncoder {
 public:
  ReturnEncoder(const protocols::velodyne::Model& model, VelodyneRangeWindow window,
                VelodyneReflectivity scale);

  /// An empty channel for what is nearer or farther than the window, or not a number. Distance to
  /// the nearest count, at least 1.
  [[nodiscard]] protocols::velodyne::Channel operator()(const LidarReturn& echo) const {
    if (!(echo.range_m >= minimum_m_ && echo.range_m <= maximum_m_)) {
      return {};
    }
    const auto counts =
        static_cast<std::uint32_t>(static_cast<double>(echo.range_m) * counts_per_metre_ + 0.5);
    return {static_cast<std::uint16_t>(std::clamp<std::uint32_t>(counts, 1, 65535)),
            reflectivity_byte(echo.reflectivity)};
  }

  [[nodiscard]] std::uint8_t reflectivity_byte(float reflectivity) const {
    if (!(reflectivity > 0.0F)) {
      return 0;  // also what is not a number
    }
    const float byte = reflectivity <= 1.0F ? reflectivity * diffuse_top_
                                            : retro_bottom_ + (reflectivity - 1.0F) * retro_span_;
    return static_cast<std::uint8_t>(std::min(byte, 255.0F) + 0.5F);
  }

 private:
  float minimum_m_;
  float maximum_m_;
  double counts_per_metre_;
  float diffuse_top_ = 100.0F;
  float retro_bottom_ = 101.0F;
  float retro_span_ = 154.0F;
};

}  // namespace rigwire::emulators
