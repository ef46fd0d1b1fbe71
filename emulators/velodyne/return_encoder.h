// From one echo in SI units to a channel of the data packet: distance in the model's counts, and
// the reflectivity byte.
//
// Reflectivity: VLP-16 user's manual 63-9243 Rev. D, section 6.1 "calibrated reflectivity" (0 ..
// 100 diffuse, 101 .. 255 retro-reflectors, 255 ideal); VLS-128 manual (0 .. 110, 111 .. 255). How
// the retro part is divided is ours: linear in how near the reflector is to an ideal one.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "emulators/velodyne/raw_ranges.h"
#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::emulators {

/// Distance counts in bits 0 .. 15, reflectivity in bits 16 .. 23; 0: nothing came back.
using EncodedReturns = std::array<std::uint32_t, kBankLasers>;

[[nodiscard]] constexpr protocols::velodyne::Channel channel_of(std::uint32_t encoded) {
  return {static_cast<std::uint16_t>(encoded & 0xFFFFU), static_cast<std::uint8_t>(encoded >> 16U)};
}

class ReturnEncoder {
 public:
  /// With a calibration (of an HDL-64E, validated) distances and intensities are raw: its clients
  /// get the true ones from them.
  ReturnEncoder(const protocols::velodyne::Model& model, VelodyneRangeWindow window,
                VelodyneReflectivity scale,
                const std::optional<protocols::velodyne::Hdl64eCalibration>& calibration = {});

  /// Nothing for what is nearer or farther than the window, or not a number. Distance to the
  /// nearest count (and at most 0.004 beside, for the float), at least 1. `echoes` are those of
  /// `bank` that are wanted.
  void encode(const LidarFiring& bank, const BankReturns& echoes, EncodedReturns& encoded) const {
    scale(echoes, encoded);
    if (raw_ranges_) {
      take_back_corrections(bank, echoes, encoded);
    }
  }

 private:
  void scale(const BankReturns& echoes, EncodedReturns& encoded) const;
  void take_back_corrections(const LidarFiring& bank, const BankReturns& echoes,
                             EncodedReturns& encoded) const;

  std::optional<protocols::velodyne::Hdl64eCalibration> calibration_;
  std::optional<RawRanges> raw_ranges_;
  float minimum_m_;
  float maximum_m_;
  float counts_per_metre_;
  float diffuse_top_ = 100.0F;
  float retro_bottom_ = 101.0F;
  float retro_span_ = 154.0F;
};

}  // namespace rigwire::emulators
