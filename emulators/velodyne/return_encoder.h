// From one echo in SI units to a channel of the data packet: distance in the model's counts, and
// the reflectivity byte.
//
// Reflectivity: VLP-16 user's manual 63-9243 Rev. D, section 6.1 "calibrated reflectivity" (0 ..
// 100 diffuse, 101 .. 255 retro-reflectors, 255 ideal); VLS-128 manual (0 .. 110, 111 .. 255). How
// the retro part is divided is this project's choice: linear in how near the reflector is to an
// ideal one.
#pragma once

#include <array>
#include <optional>
#include <span>

#include "emulators/velodyne/raw_ranges.h"
#include "emulators/velodyne/velodyne_settings.h"
#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"
#include "sim/samples/lidar_sample.h"

namespace rigwire::emulators {

/// 0: nothing came back.
using EncodedReturns = std::array<protocols::velodyne::ChannelWord, kBankLasers>;

class ReturnEncoder {
 public:
  /// With a calibration (of an HDL-64E, validated) distances and intensities are raw: its clients
  /// get the true ones from them.
  ReturnEncoder(const protocols::velodyne::Model& model, VelodyneRangeWindow window,
                VelodyneReflectivity scale,
                const std::optional<protocols::velodyne::Hdl64eCalibration>& calibration = {});

  /// Encodes each of `echoes`, the wanted returns of `bank`, into the element of `encoded` with the
  /// same index: 0 for what is nearer or farther than the window, or NaN; otherwise the distance to
  /// the nearest count (off by at most 0.004 through float arithmetic), at least 1.
  void encode(const LidarFiring& bank, std::span<const BankReturns* const> echoes,
              std::span<EncodedReturns> encoded) const;

 private:
  void scale(const BankReturns& echoes, EncodedReturns& encoded) const;
  void take_back_corrections(const RawRanges::Beams& beams, const BankReturns& echoes,
                             EncodedReturns& encoded) const;

  std::optional<RawRanges> raw_ranges_;
  float minimum_m_;
  float maximum_m_;
  float counts_per_metre_;
  float diffuse_top_ = 100.0F;
  float retro_bottom_ = 101.0F;
  float retro_span_ = 154.0F;
};

}  // namespace rigwire::emulators
