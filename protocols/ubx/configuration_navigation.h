// Navigation (configuration, class 0x06), in wire units: rate, model, masks, systems, datum.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.10 "UBX-CFG"; lengths and
// defaults checked against a complete poll of a NEO-7P. A poll is a frame of the same class and id
// with an empty payload.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// CFG-RATE.
struct CfgRate {
  static constexpr MessageId kId{0x06, 0x08};
  static constexpr std::size_t kLength = 3 * 2 /*fields*/;

  std::uint16_t measurement_period_ms = 0;
  std::uint16_t navigation_ratio = 0;
  std::uint16_t time_reference = 0;  ///< 0 UTC, 1 GPS.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgRate::measurement_period_ms),
                           at(2, &CfgRate::navigation_ratio), at(4, &CfgRate::time_reference));
  }
  friend bool operator==(const CfgRate&, const CfgRate&) = default;
};

/// CFG-NAV5.
struct CfgNav5 {
  static constexpr MessageId kId{0x06, 0x24};
  static constexpr std::size_t kLength = 36 /*with reserved bytes*/;

  std::uint16_t mask = 0;          ///< Which fields a set applies.
  std::uint8_t dynamic_model = 0;  ///< 0 portable, 4 automotive, ...
  std::uint8_t fix_mode = 0;       ///< 1 2D only, 2 3D only, 3 automatic.
  std::int32_t fixed_altitude_cm = 0;
  std::uint32_t fixed_altitude_variance_e4m2 = 0;
  std::int8_t minimum_elevation_deg = 0;
  std::uint8_t dead_reckoning_limit_s = 0;
  std::uint16_t position_dilution_mask_e1 = 0;
  std::uint16_t time_dilution_mask_e1 = 0;
  std::uint16_t position_accuracy_mask_m = 0;
  std::uint16_t time_accuracy_mask_m = 0;
  std::uint8_t static_hold_cmps = 0;
  std::uint8_t differential_timeout_s = 0;
  std::uint8_t cn0_satellites = 0;
  std::uint8_t cn0_threshold_dbhz = 0;
  std::uint16_t static_hold_distance_m = 0;
  std::uint8_t utc_standard = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &CfgNav5::mask), at(2, &CfgNav5::dynamic_model), at(3, &CfgNav5::fix_mode),
        at(4, &CfgNav5::fixed_altitude_cm), at(8, &CfgNav5::fixed_altitude_variance_e4m2),
        at(12, &CfgNav5::minimum_elevation_deg), at(13, &CfgNav5::dead_reckoning_limit_s),
        at(14, &CfgNav5::position_dilution_mask_e1), at(16, &CfgNav5::time_dilution_mask_e1),
        at(18, &CfgNav5::position_accuracy_mask_m), at(20, &CfgNav5::time_accuracy_mask_m),
        at(22, &CfgNav5::static_hold_cmps), at(23, &CfgNav5::differential_timeout_s),
        at(24, &CfgNav5::cn0_satellites), at(25, &CfgNav5::cn0_threshold_dbhz),
        at(28, &CfgNav5::static_hold_distance_m), at(30, &CfgNav5::utc_standard));
  }
  friend bool operator==(const CfgNav5&, const CfgNav5&) = default;
};

/// CFG-NAVX5: the fields that protocols 14 and 18 document, but for dead reckoning.
struct CfgNavx5 {
  static constexpr MessageId kId{0x06, 0x23};
  static constexpr std::size_t kLength = 40 /*with reserved bytes*/;

  std::uint16_t version = 0;
  std::uint16_t mask1 = 0;
  std::uint32_t mask2 = 0;
  std::uint8_t minimum_satellites = 0;
  std::uint8_t maximum_satellites = 0;
  std::uint8_t minimum_cn0_dbhz = 0;
  std::uint8_t initial_fix_3d = 0;
  std::uint8_t acknowledge_aiding = 0;
  std::uint16_t week_rollover = 0;
  std::uint8_t attenuation_compensation = 0;  ///< u-blox 8: 0 off, 255 automatic, else dBHz.
  std::uint8_t precise_point_positioning = 0;
  std::uint8_t autonomous_orbits = 0;
  std::uint16_t maximum_orbit_error_m = 0;
  // Not zero as delivered.
  std::array<std::uint8_t, 2> reserved1{};
  std::uint8_t reserved2 = 0;
  std::array<std::uint8_t, 2> reserved3{};
  std::array<std::uint8_t, 5> reserved4{};
  std::array<std::uint8_t, 2> reserved5{};
  std::array<std::uint8_t, 8> reserved6{};

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &CfgNavx5::version), at(2, &CfgNavx5::mask1), at(4, &CfgNavx5::mask2),
        at(8, &CfgNavx5::reserved1), at(10, &CfgNavx5::minimum_satellites),
        at(11, &CfgNavx5::maximum_satellites), at(12, &CfgNavx5::minimum_cn0_dbhz),
        at(13, &CfgNavx5::reserved2), at(14, &CfgNavx5::initial_fix_3d),
        at(15, &CfgNavx5::reserved3), at(17, &CfgNavx5::acknowledge_aiding),
        at(18, &CfgNavx5::week_rollover), at(20, &CfgNavx5::attenuation_compensation),
        at(21, &CfgNavx5::reserved4), at(26, &CfgNavx5::precise_point_positioning),
        at(27, &CfgNavx5::autonomous_orbits), at(28, &CfgNavx5::reserved5),
        at(30, &CfgNavx5::maximum_orbit_error_m), at(32, &CfgNavx5::reserved6));
  }
  friend bool operator==(const CfgNavx5&, const CfgNavx5&) = default;
};

/// CfgOdo::flags.
inline constexpr std::uint8_t kOdoUse = 0x01;
inline constexpr std::uint8_t kOdoLowSpeedCourse = 0x02;
inline constexpr std::uint8_t kOdoFilteredSpeed = 0x04;
inline constexpr std::uint8_t kOdoFilteredCourse = 0x08;

/// CFG-ODO: odometer and low-pass filters of speed and course. u-blox 8 and later.
struct CfgOdo {
  static constexpr MessageId kId{0x06, 0x1E};
  static constexpr std::size_t kLength =
      4 /*version*/ + 8 /*flags, profile, reserved*/ + 4 /*low speed*/ + 4 /*gains*/;

  std::uint8_t version = 0;
  std::uint8_t flags = 0;                  ///< kOdoUse, ...
  std::uint8_t profile = 0;                ///< 0 running, 1 cycling, 2 swimming, 3 car, 4 custom.
  std::array<std::uint8_t, 6> reserved{};  ///< Not zero as delivered.
  std::uint8_t course_speed_dmps = 0;      ///< Greatest of the low-speed course filter.
  std::uint8_t course_accuracy_m = 0;      ///< Greatest of the low-speed course filter.
  std::uint8_t speed_gain = 0;             ///< 0 heavy .. 255 weak filtering.
  std::uint8_t course_gain = 0;            ///< The same for the course.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgOdo::version), at(4, &CfgOdo::flags), at(5, &CfgOdo::profile),
                           at(6, &CfgOdo::reserved), at(12, &CfgOdo::course_speed_dmps),
                           at(13, &CfgOdo::course_accuracy_m), at(16, &CfgOdo::speed_gain),
                           at(17, &CfgOdo::course_gain));
  }
  friend bool operator==(const CfgOdo&, const CfgOdo&) = default;
};

/// CFG-SBAS.
struct CfgSbas {
  static constexpr MessageId kId{0x06, 0x16};
  static constexpr std::size_t kLength = 4 /*use*/ + 4 /*satellites*/;

  std::uint8_t mode = 0;
  std::uint8_t usage = 0;
  std::uint8_t maximum_satellites = 0;
  std::uint8_t scan_mode2 = 0;
  std::uint32_t scan_mode1 = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgSbas::mode), at(1, &CfgSbas::usage),
                           at(2, &CfgSbas::maximum_satellites), at(3, &CfgSbas::scan_mode2),
                           at(4, &CfgSbas::scan_mode1));
  }
  friend bool operator==(const CfgSbas&, const CfgSbas&) = default;
};

/// CFG-GNSS: the head, followed by `blocks` blocks.
struct CfgGnssHead {
  static constexpr MessageId kId{0x06, 0x3E};
  static constexpr std::size_t kLength = 4 /*fields*/;

  std::uint8_t version = 0;
  std::uint8_t hardware_channels = 0;
  std::uint8_t used_channels = 0;
  std::uint8_t blocks = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgGnssHead::version), at(1, &CfgGnssHead::hardware_channels),
                           at(2, &CfgGnssHead::used_channels), at(3, &CfgGnssHead::blocks));
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return blocks; }
  friend bool operator==(const CfgGnssHead&, const CfgGnssHead&) = default;
};

/// CFG-GNSS: one system.
struct CfgGnssBlock {
  static constexpr std::size_t kLength = 4 /*channels*/ + 4 /*flags*/;

  std::uint8_t system = 0;  ///< 0 GPS, 1 SBAS, 5 QZSS, 6 GLONASS.
  std::uint8_t reserved_channels = 0;
  std::uint8_t maximum_channels = 0;
  std::uint32_t flags = 0;  ///< b0 enabled.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgGnssBlock::system), at(1, &CfgGnssBlock::reserved_channels),
                           at(2, &CfgGnssBlock::maximum_channels), at(4, &CfgGnssBlock::flags));
  }
  friend bool operator==(const CfgGnssBlock&, const CfgGnssBlock&) = default;
};

/// CFG-DAT as it is answered: the datum with its number and name.
struct CfgDat {
  static constexpr MessageId kId{0x06, 0x06};
  static constexpr std::size_t kLength =
      2 /*number*/ + 6 /*name*/ + 2 * 8 /*ellipsoid*/ + 7 * 4 /*shift, rotation, scale*/;

  std::uint16_t number = 0;            ///< 0 WGS-84, 0xFFFF set by the user.
  std::array<std::uint8_t, 6> name{};  ///< Text, padded with zeros.
  double major_axis_m = 0.0;
  double inverse_flattening = 0.0;
  std::array<float, 3> shift_m{};
  std::array<float, 3> rotation_arcsec{};
  float scale_ppm = 0.0F;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgDat::number), at(2, &CfgDat::name),
                           at(8, &CfgDat::major_axis_m), at(16, &CfgDat::inverse_flattening),
                           at(24, &CfgDat::shift_m), at(36, &CfgDat::rotation_arcsec),
                           at(48, &CfgDat::scale_ppm));
  }
  friend bool operator==(const CfgDat&, const CfgDat&) = default;
};

/// CFG-DAT as it is set.
struct CfgDatSet {
  static constexpr MessageId kId{0x06, 0x06};
  static constexpr std::size_t kLength = 2 * 8 /*ellipsoid*/ + 7 * 4 /*shift, rotation, scale*/;

  double major_axis_m = 0.0;
  double inverse_flattening = 0.0;
  std::array<float, 3> shift_m{};
  std::array<float, 3> rotation_arcsec{};
  float scale_ppm = 0.0F;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &CfgDatSet::major_axis_m), at(8, &CfgDatSet::inverse_flattening),
                           at(16, &CfgDatSet::shift_m), at(28, &CfgDatSet::rotation_arcsec),
                           at(40, &CfgDatSet::scale_ppm));
  }
  friend bool operator==(const CfgDatSet&, const CfgDatSet&) = default;
};

}  // namespace rigwire::protocols::ubx
