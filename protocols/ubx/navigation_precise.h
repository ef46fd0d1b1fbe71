// High-precision and relative positions and covariances (class 0x01), in wire units: what carrier
// phase receivers (M8P, F9) add.
//
// Source: ZED-F9P interface description HPG 1.50, UBXDOC-963802114-12815, section 3.15;
// NAV-RELPOSNED of 40 bytes: u-blox M8 receiver description, UBX-13003221 R28, section 32.17.18.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// NAV-HPPOSECEF: position_cm + position_rest_e4m * 0.01 cm. precise_position.h splits.
struct NavHpposecef {
  static constexpr MessageId kId{0x01, 0x13};
  static constexpr std::size_t kLength =
      4 /*version*/ + 4 /*time*/ + 12 /*position*/ + 3 /*rest*/ + 1 /*flags*/ + 4 /*accuracy*/;

  std::uint8_t version = 0;
  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> position_cm{};
  std::array<std::int8_t, 3> position_rest_e4m{};  ///< -99..99.
  std::uint8_t flags = 0;                          ///< b0 invalid.
  std::uint32_t position_accuracy_e4m = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavHpposecef::version), at(4, &NavHpposecef::time_of_week_ms),
                           at(8, &NavHpposecef::position_cm),
                           at(20, &NavHpposecef::position_rest_e4m), at(23, &NavHpposecef::flags),
                           at(24, &NavHpposecef::position_accuracy_e4m));
  }
  friend bool operator==(const NavHpposecef&, const NavHpposecef&) = default;
};

/// NAV-HPPOSLLH: longitude_e7deg + longitude_rest_e9deg * 0.01e-7 deg, and so on.
/// precise_position.h splits.
struct NavHpposllh {
  static constexpr MessageId kId{0x01, 0x14};
  static constexpr std::size_t kLength =
      4 /*version, flags*/ + 4 /*time*/ + 16 /*position*/ + 4 /*rest*/ + 8 /*accuracy*/;

  std::uint8_t version = 0;
  std::uint8_t flags = 0;             ///< b0 invalid.
  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int32_t longitude_e7deg = 0;
  std::int32_t latitude_e7deg = 0;
  std::int32_t ellipsoid_height_mm = 0;
  std::int32_t mean_sea_level_height_mm = 0;
  std::int8_t longitude_rest_e9deg = 0;            ///< -99..99.
  std::int8_t latitude_rest_e9deg = 0;             ///< -99..99.
  std::int8_t ellipsoid_height_rest_e4m = 0;       ///< -9..9.
  std::int8_t mean_sea_level_height_rest_e4m = 0;  ///< -9..9.
  std::uint32_t horizontal_accuracy_e4m = 0;
  std::uint32_t vertical_accuracy_e4m = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavHpposllh::version), at(3, &NavHpposllh::flags),
        at(4, &NavHpposllh::time_of_week_ms), at(8, &NavHpposllh::longitude_e7deg),
        at(12, &NavHpposllh::latitude_e7deg), at(16, &NavHpposllh::ellipsoid_height_mm),
        at(20, &NavHpposllh::mean_sea_level_height_mm), at(24, &NavHpposllh::longitude_rest_e9deg),
        at(25, &NavHpposllh::latitude_rest_e9deg), at(26, &NavHpposllh::ellipsoid_height_rest_e4m),
        at(27, &NavHpposllh::mean_sea_level_height_rest_e4m),
        at(28, &NavHpposllh::horizontal_accuracy_e4m), at(32, &NavHpposllh::vertical_accuracy_e4m));
  }
  friend bool operator==(const NavHpposllh&, const NavHpposllh&) = default;
};

/// NAV-COV: covariances in the north, east, down frame.
struct NavCov {
  static constexpr MessageId kId{0x01, 0x36};
  static constexpr std::size_t kLength =
      4 /*time*/ + 3 /*version, validity*/ + 9 /*reserved*/ + 24 /*position*/ + 24 /*velocity*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 0;
  std::uint8_t position_valid = 0;
  std::uint8_t velocity_valid = 0;
  std::array<float, 6> position_covariance_ned_m2{};     ///< NN, NE, ND, EE, ED, DD.
  std::array<float, 6> velocity_covariance_ned_m2ps2{};  ///< The same order.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavCov::time_of_week_ms), at(4, &NavCov::version),
                           at(5, &NavCov::position_valid), at(6, &NavCov::velocity_valid),
                           at(16, &NavCov::position_covariance_ned_m2),
                           at(40, &NavCov::velocity_covariance_ned_m2ps2));
  }
  friend bool operator==(const NavCov&, const NavCov&) = default;
};

/// NAV-SVIN: survey-in of a base station.
struct NavSvin {
  static constexpr MessageId kId{0x01, 0x3B};
  static constexpr std::size_t kLength =
      4 /*version*/ + 8 /*time, duration*/ + 16 /*position*/ + 8 /*accuracy, number*/ + 4 /*state*/;

  std::uint8_t version = 0;
  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint32_t duration_s = 0;
  std::array<std::int32_t, 3> mean_cm{};       ///< Earth-centred earth-fixed.
  std::array<std::int8_t, 3> mean_rest_e4m{};  ///< -99..99.
  std::uint32_t mean_accuracy_e4m = 0;
  std::uint32_t observations = 0;
  std::uint8_t valid = 0;
  std::uint8_t active = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSvin::version), at(4, &NavSvin::time_of_week_ms),
                           at(8, &NavSvin::duration_s), at(12, &NavSvin::mean_cm),
                           at(24, &NavSvin::mean_rest_e4m), at(28, &NavSvin::mean_accuracy_e4m),
                           at(32, &NavSvin::observations), at(36, &NavSvin::valid),
                           at(37, &NavSvin::active));
  }
  friend bool operator==(const NavSvin&, const NavSvin&) = default;
};

/// Flags of NAV-RELPOSNED. The last three are of version 1 only.
inline constexpr std::uint32_t kRelativeFixOk = 0x001;
inline constexpr std::uint32_t kRelativeDifferential = 0x002;
inline constexpr std::uint32_t kRelativeValid = 0x004;
inline constexpr std::uint32_t kRelativeCarrierFloat = 0x008;
inline constexpr std::uint32_t kRelativeCarrierFixed = 0x010;
inline constexpr std::uint32_t kRelativeMovingBase = 0x020;
inline constexpr std::uint32_t kRelativeReferencePositionMissing = 0x040;
inline constexpr std::uint32_t kRelativeReferenceObservationsMissing = 0x080;
inline constexpr std::uint32_t kRelativeHeadingValid = 0x100;
inline constexpr std::uint32_t kRelativeNormalised = 0x200;

/// NAV-RELPOSNED version 0 (M8P): from the reference station, north, east, down.
struct NavRelposned40 {
  static constexpr MessageId kId{0x01, 0x3C};
  static constexpr std::size_t kLength = 4 /*version, station*/ + 4 /*time*/ + 12 /*position*/ +
                                         4 /*rest*/ + 12 /*accuracy*/ + 4 /*flags*/;

  std::uint8_t version = 0;
  std::uint16_t station = 0;
  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> relative_ned_cm{};
  std::array<std::int8_t, 3> relative_ned_rest_e4m{};  ///< -99..99.
  std::array<std::uint32_t, 3> accuracy_ned_e4m{};
  std::uint32_t flags = 0;  ///< kRelativeFixOk, ...

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavRelposned40::version), at(2, &NavRelposned40::station),
        at(4, &NavRelposned40::time_of_week_ms), at(8, &NavRelposned40::relative_ned_cm),
        at(20, &NavRelposned40::relative_ned_rest_e4m), at(24, &NavRelposned40::accuracy_ned_e4m),
        at(36, &NavRelposned40::flags));
  }
  friend bool operator==(const NavRelposned40&, const NavRelposned40&) = default;
};

/// NAV-RELPOSNED version 1 (F9).
struct NavRelposned {
  static constexpr MessageId kId{0x01, 0x3C};
  static constexpr std::size_t kLength = 4 /*version, station*/ + 4 /*time*/ + 12 /*position*/ +
                                         12 /*length, heading, reserved*/ + 4 /*rest*/ +
                                         20 /*accuracy*/ + 8 /*reserved, flags*/;

  std::uint8_t version = 1;
  std::uint16_t station = 0;
  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> relative_ned_cm{};
  std::int32_t length_cm = 0;
  std::int32_t heading_e5deg = 0;
  std::array<std::int8_t, 3> relative_ned_rest_e4m{};  ///< -99..99.
  std::int8_t length_rest_e4m = 0;                     ///< -99..99.
  std::array<std::uint32_t, 3> accuracy_ned_e4m{};
  std::uint32_t length_accuracy_e4m = 0;
  std::uint32_t heading_accuracy_e5deg = 0;
  std::uint32_t flags = 0;  ///< kRelativeFixOk, ...

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavRelposned::version), at(2, &NavRelposned::station),
        at(4, &NavRelposned::time_of_week_ms), at(8, &NavRelposned::relative_ned_cm),
        at(20, &NavRelposned::length_cm), at(24, &NavRelposned::heading_e5deg),
        at(32, &NavRelposned::relative_ned_rest_e4m), at(35, &NavRelposned::length_rest_e4m),
        at(36, &NavRelposned::accuracy_ned_e4m), at(48, &NavRelposned::length_accuracy_e4m),
        at(52, &NavRelposned::heading_accuracy_e5deg), at(60, &NavRelposned::flags));
  }
  friend bool operator==(const NavRelposned&, const NavRelposned&) = default;
};

}  // namespace rigwire::protocols::ubx
