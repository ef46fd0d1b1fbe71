// Position, velocity and quality of the fix (class 0x01), in wire units; the unit is in each name
// or comment. The older messages, one quantity each; NAV-PVT has a header of its own.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.17 "UBX-NAV"; lengths and
// ids checked against recordings of u-blox 7 receivers.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"
#include "protocols/ubx/navigation_values.h"

namespace rigwire::protocols::ubx {

/// Flags of NAV-STATUS and NAV-SOL.
inline constexpr std::uint8_t kFlagFixOk = 0x01;
inline constexpr std::uint8_t kFlagDifferential = 0x02;
inline constexpr std::uint8_t kFlagWeekSet = 0x04;
inline constexpr std::uint8_t kFlagTimeOfWeekSet = 0x08;

/// NAV-POSECEF: position, earth-centred earth-fixed.
struct NavPosecef {
  static constexpr MessageId kId{0x01, 0x01};
  static constexpr std::size_t kLength = 4 /*time*/ + 12 /*position*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> position_cm{};
  std::uint32_t position_accuracy_cm = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavPosecef::time_of_week_ms), at(4, &NavPosecef::position_cm),
                           at(16, &NavPosecef::position_accuracy_cm));
  }
  friend bool operator==(const NavPosecef&, const NavPosecef&) = default;
};

/// NAV-POSLLH: geodetic position.
struct NavPosllh {
  static constexpr MessageId kId{0x01, 0x02};
  static constexpr std::size_t kLength = 4 /*time*/ + 16 /*position*/ + 8 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int32_t longitude_e7deg = 0;
  std::int32_t latitude_e7deg = 0;
  std::int32_t ellipsoid_height_mm = 0;
  std::int32_t mean_sea_level_height_mm = 0;
  std::uint32_t horizontal_accuracy_mm = 0;
  std::uint32_t vertical_accuracy_mm = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavPosllh::time_of_week_ms), at(4, &NavPosllh::longitude_e7deg),
        at(8, &NavPosllh::latitude_e7deg), at(12, &NavPosllh::ellipsoid_height_mm),
        at(16, &NavPosllh::mean_sea_level_height_mm), at(20, &NavPosllh::horizontal_accuracy_mm),
        at(24, &NavPosllh::vertical_accuracy_mm));
  }
  friend bool operator==(const NavPosllh&, const NavPosllh&) = default;
};

/// NAV-STATUS.
struct NavStatus {
  static constexpr MessageId kId{0x01, 0x03};
  static constexpr std::size_t kLength = 4 /*time*/ + 4 /*states*/ + 8 /*times since start*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t fix_type = 0;
  std::uint8_t flags = 0;
  std::uint8_t fix_status = 0;
  std::uint8_t flags2 = 0;
  std::uint32_t time_to_first_fix_ms = 0;
  std::uint32_t since_start_ms = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavStatus::time_of_week_ms), at(4, &NavStatus::fix_type),
                           at(5, &NavStatus::flags), at(6, &NavStatus::fix_status),
                           at(7, &NavStatus::flags2), at(8, &NavStatus::time_to_first_fix_ms),
                           at(12, &NavStatus::since_start_ms));
  }
  friend bool operator==(const NavStatus&, const NavStatus&) = default;
};

/// NAV-DOP: dilutions of precision, hundredths.
struct NavDop {
  static constexpr MessageId kId{0x01, 0x04};
  static constexpr std::size_t kLength = 4 /*time*/ + 7 * 2 /*dilutions*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint16_t geometric_e2 = kNoDilution;
  std::uint16_t position_e2 = kNoDilution;
  std::uint16_t time_e2 = kNoDilution;
  std::uint16_t vertical_e2 = kNoDilution;
  std::uint16_t horizontal_e2 = kNoDilution;
  std::uint16_t northing_e2 = kNoDilution;
  std::uint16_t easting_e2 = kNoDilution;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavDop::time_of_week_ms), at(4, &NavDop::geometric_e2),
                           at(6, &NavDop::position_e2), at(8, &NavDop::time_e2),
                           at(10, &NavDop::vertical_e2), at(12, &NavDop::horizontal_e2),
                           at(14, &NavDop::northing_e2), at(16, &NavDop::easting_e2));
  }
  friend bool operator==(const NavDop&, const NavDop&) = default;
};

/// NAV-SOL: the whole solution, earth-centred earth-fixed.
struct NavSol {
  static constexpr MessageId kId{0x01, 0x06};
  static constexpr std::size_t kLength =
      4 + 4 /*time*/ + 2 /*week*/ + 2 /*fix*/ + 16 /*position*/ + 16 /*velocity*/ + 8 /*rest*/;

  std::uint32_t time_of_week_ms = 0;      ///< GPS time of week of the navigation epoch.
  std::int32_t time_of_week_rest_ns = 0;  ///< Add to time_of_week_ms.
  std::int16_t week = 0;                  ///< Not rolled over.
  std::uint8_t fix_type = 0;
  std::uint8_t flags = 0;
  std::array<std::int32_t, 3> position_cm{};
  std::uint32_t position_accuracy_cm = 0;
  std::array<std::int32_t, 3> velocity_cmps{};
  std::uint32_t speed_accuracy_cmps = 0;
  std::uint16_t position_dilution_e2 = kNoDilution;
  std::uint8_t satellites_used = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSol::time_of_week_ms), at(4, &NavSol::time_of_week_rest_ns),
                           at(8, &NavSol::week), at(10, &NavSol::fix_type), at(11, &NavSol::flags),
                           at(12, &NavSol::position_cm), at(24, &NavSol::position_accuracy_cm),
                           at(28, &NavSol::velocity_cmps), at(40, &NavSol::speed_accuracy_cmps),
                           at(44, &NavSol::position_dilution_e2), at(47, &NavSol::satellites_used));
  }
  friend bool operator==(const NavSol&, const NavSol&) = default;
};

/// NAV-VELECEF.
struct NavVelecef {
  static constexpr MessageId kId{0x01, 0x11};
  static constexpr std::size_t kLength = 4 /*time*/ + 12 /*velocity*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> velocity_cmps{};
  std::uint32_t speed_accuracy_cmps = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavVelecef::time_of_week_ms), at(4, &NavVelecef::velocity_cmps),
                           at(16, &NavVelecef::speed_accuracy_cmps));
  }
  friend bool operator==(const NavVelecef&, const NavVelecef&) = default;
};

/// NAV-ODO: ground distance. u-blox 8 and later.
struct NavOdo {
  static constexpr MessageId kId{0x01, 0x09};
  static constexpr std::size_t kLength = 4 /*version*/ + 4 /*time*/ + 12 /*distances*/;

  std::uint8_t version = 0;
  std::uint32_t time_of_week_ms = 0;   ///< GPS time of week of the navigation epoch.
  std::uint32_t distance_m = 0;        ///< Since NAV-RESETODO.
  std::uint32_t total_distance_m = 0;  ///< Since the last cold start.
  std::uint32_t accuracy_m = 0;        ///< Of distance_m.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavOdo::version), at(4, &NavOdo::time_of_week_ms),
                           at(8, &NavOdo::distance_m), at(12, &NavOdo::total_distance_m),
                           at(16, &NavOdo::accuracy_m));
  }
  friend bool operator==(const NavOdo&, const NavOdo&) = default;
};

/// NAV-RESETODO, a command without payload that is acknowledged.
inline constexpr MessageId kNavResetodo{0x01, 0x10};

/// NAV-VELNED.
struct NavVelned {
  static constexpr MessageId kId{0x01, 0x12};
  static constexpr std::size_t kLength =
      4 /*time*/ + 12 /*velocity*/ + 12 /*speed, heading*/ + 8 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> velocity_ned_cmps{};
  std::uint32_t speed_cmps = 0;  ///< Three-dimensional.
  std::uint32_t ground_speed_cmps = 0;
  std::int32_t heading_e5deg = 0;
  std::uint32_t speed_accuracy_cmps = 0;
  std::uint32_t heading_accuracy_e5deg = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavVelned::time_of_week_ms), at(4, &NavVelned::velocity_ned_cmps),
                           at(16, &NavVelned::speed_cmps), at(20, &NavVelned::ground_speed_cmps),
                           at(24, &NavVelned::heading_e5deg),
                           at(28, &NavVelned::speed_accuracy_cmps),
                           at(32, &NavVelned::heading_accuracy_e5deg));
  }
  friend bool operator==(const NavVelned&, const NavVelned&) = default;
};

}  // namespace rigwire::protocols::ubx
