// What an HDL-64E measures, bank by bank: raw counts and intensities from which calibrated clients
// get the true ones. The fast way of raw_counts() in hdl_64e_calibration.h.
//
// The near correction is linear in the distance, so its inverse is one division. Two things are
// left out, each far below half a count (1 mm): the fold of the formula where a beam crosses the x
// or the y axis within the horizontal offset (0.1 mm), and that the rotor turns while the bank
// fires at another speed than told to set_rotor_rate() (0.1 mm for 10 %).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/velodyne/data_packet.h"
#include "protocols/velodyne/hdl_64e_calibration.h"
#include "protocols/velodyne/model.h"

namespace rigwire::protocols::velodyne {

class Hdl64eEncoder {
 public:
  static constexpr std::size_t kBankLasers = 32;

  /// Validates, throws as validate() does.
  Hdl64eEncoder(const Model& model, const Hdl64eCalibration& calibration,
                NearCorrection near = NearCorrection::everywhere);

  /// For the azimuths of lasers that fire later than the first. Set it when the speed is changed.
  void set_rotor_rate(double rate_degps);

  /// `ranges_m`: from the beams' exits, 0 where nothing came back. `intensities`: as clients are to
  /// see them, 0 .. 255. Channels are empty where the range is nearer than the unit's own zero, or
  /// farther than the field tells. Without allocation.
  void encode(std::size_t first_laser, double rotor_azimuth_deg,
              std::span<const float, kBankLasers> ranges_m,
              std::span<const float, kBankLasers> intensities,
              std::span<Channel, kBankLasers> channels) const;

 private:
  using PerLaser = std::array<float, kHdl64eLasers>;

  NearCorrection near_;
  std::array<double, kHdl64eLasers> ahead_deg_{};  ///< Of the rotor's azimuth, standing.
  std::array<std::int32_t, kHdl64eLasers> time_offset_ns_{};
  PerLaser cos_ahead_{}, sin_ahead_{};
  PerLaser cos_elevation_{};
  PerLaser horizontal_m_{};
  PerLaser far_m_{};
  PerLaser near_x_m_{}, slope_x_{};  ///< Correction at the near point, its change per metre.
  PerLaser near_y_m_{}, slope_y_{};
  PerLaser at_focus_{}, intensity_slope_{};
};

}  // namespace rigwire::protocols::velodyne
