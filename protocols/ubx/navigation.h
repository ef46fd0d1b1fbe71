// Navigation messages (class 0x01) of protocol 14, in wire units; the unit is in each name or
// comment.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.17 "UBX-NAV", with the
// lengths of protocol 14 (NAV-PVT 84 bytes); lengths and ids checked against recordings of u-blox 7
// receivers, NAV-PVT excepted.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// gpsFix / fixType.
inline constexpr std::uint8_t kFixNone = 0;
inline constexpr std::uint8_t kFix2d = 2;
inline constexpr std::uint8_t kFix3d = 3;
/// Flags of NAV-STATUS and NAV-SOL.
inline constexpr std::uint8_t kFlagFixOk = 0x01;
inline constexpr std::uint8_t kFlagWeekSet = 0x04;
inline constexpr std::uint8_t kFlagTimeOfWeekSet = 0x08;
/// A dilution that is not known, in hundredths.
inline constexpr std::uint16_t kNoDilution = 9999;

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

/// NAV-PVT in the 84-byte form of u-blox 7.
struct NavPvt {
  static constexpr MessageId kId{0x01, 0x07};
  static constexpr std::size_t kLength =
      20 /*time*/ + 4 /*fix*/ + 24 /*position*/ + 28 /*velocity*/ + 2 /*dilution*/ + 6 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint16_t year = 0;
  std::uint8_t month = 0;
  std::uint8_t day = 0;
  std::uint8_t hour = 0;
  std::uint8_t minute = 0;
  std::uint8_t second = 0;  ///< 0..60.
  std::uint8_t valid = 0;   ///< b0 date, b1 time, b2 fully resolved.
  std::uint32_t time_accuracy_ns = 0;
  std::int32_t nanosecond = 0;  ///< Add to second; may be negative.
  std::uint8_t fix_type = 0;
  std::uint8_t flags = 0;
  std::uint8_t flags2 = 0;
  std::uint8_t satellites_used = 0;
  std::int32_t longitude_e7deg = 0;
  std::int32_t latitude_e7deg = 0;
  std::int32_t ellipsoid_height_mm = 0;
  std::int32_t mean_sea_level_height_mm = 0;
  std::uint32_t horizontal_accuracy_mm = 0;
  std::uint32_t vertical_accuracy_mm = 0;
  std::array<std::int32_t, 3> velocity_ned_mmps{};
  std::int32_t ground_speed_mmps = 0;
  std::int32_t heading_e5deg = 0;
  std::uint32_t speed_accuracy_mmps = 0;
  std::uint32_t heading_accuracy_e5deg = 0;
  std::uint16_t position_dilution_e2 = kNoDilution;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavPvt::time_of_week_ms), at(4, &NavPvt::year), at(6, &NavPvt::month),
        at(7, &NavPvt::day), at(8, &NavPvt::hour), at(9, &NavPvt::minute), at(10, &NavPvt::second),
        at(11, &NavPvt::valid), at(12, &NavPvt::time_accuracy_ns), at(16, &NavPvt::nanosecond),
        at(20, &NavPvt::fix_type), at(21, &NavPvt::flags), at(22, &NavPvt::flags2),
        at(23, &NavPvt::satellites_used), at(24, &NavPvt::longitude_e7deg),
        at(28, &NavPvt::latitude_e7deg), at(32, &NavPvt::ellipsoid_height_mm),
        at(36, &NavPvt::mean_sea_level_height_mm), at(40, &NavPvt::horizontal_accuracy_mm),
        at(44, &NavPvt::vertical_accuracy_mm), at(48, &NavPvt::velocity_ned_mmps),
        at(60, &NavPvt::ground_speed_mmps), at(64, &NavPvt::heading_e5deg),
        at(68, &NavPvt::speed_accuracy_mmps), at(72, &NavPvt::heading_accuracy_e5deg),
        at(76, &NavPvt::position_dilution_e2));
  }
  friend bool operator==(const NavPvt&, const NavPvt&) = default;
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

/// NAV-TIMEGPS.
struct NavTimegps {
  static constexpr MessageId kId{0x01, 0x20};
  static constexpr std::size_t kLength =
      8 /*time*/ + 2 /*week*/ + 2 /*leap, valid*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int32_t time_of_week_rest_ns = 0;
  std::int16_t week = 0;
  std::int8_t leap_seconds = 0;  ///< GPS minus UTC.
  std::uint8_t valid = 0;        ///< b0 time of week, b1 week, b2 leap seconds.
  std::uint32_t time_accuracy_ns = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavTimegps::time_of_week_ms),
                           at(4, &NavTimegps::time_of_week_rest_ns), at(8, &NavTimegps::week),
                           at(10, &NavTimegps::leap_seconds), at(11, &NavTimegps::valid),
                           at(12, &NavTimegps::time_accuracy_ns));
  }
  friend bool operator==(const NavTimegps&, const NavTimegps&) = default;
};

/// NAV-TIMEUTC.
struct NavTimeutc {
  static constexpr MessageId kId{0x01, 0x21};
  static constexpr std::size_t kLength =
      4 /*time*/ + 8 /*accuracy, rest*/ + 7 /*date and time*/ + 1 /*valid*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint32_t time_accuracy_ns = 0;
  std::int32_t nanosecond = 0;  ///< Add to second; may be negative.
  std::uint16_t year = 0;
  std::uint8_t month = 0;
  std::uint8_t day = 0;
  std::uint8_t hour = 0;
  std::uint8_t minute = 0;
  std::uint8_t second = 0;  ///< 0..60.
  std::uint8_t valid = 0;   ///< b0 time of week, b1 week, b2 UTC.

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavTimeutc::time_of_week_ms), at(4, &NavTimeutc::time_accuracy_ns),
        at(8, &NavTimeutc::nanosecond), at(12, &NavTimeutc::year), at(14, &NavTimeutc::month),
        at(15, &NavTimeutc::day), at(16, &NavTimeutc::hour), at(17, &NavTimeutc::minute),
        at(18, &NavTimeutc::second), at(19, &NavTimeutc::valid));
  }
  friend bool operator==(const NavTimeutc&, const NavTimeutc&) = default;
};

/// NAV-CLOCK.
struct NavClock {
  static constexpr MessageId kId{0x01, 0x22};
  static constexpr std::size_t kLength = 4 /*time*/ + 8 /*bias, drift*/ + 8 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int32_t bias_ns = 0;
  std::int32_t drift_nsps = 0;
  std::uint32_t time_accuracy_ns = 0;
  std::uint32_t frequency_accuracy_psps = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavClock::time_of_week_ms), at(4, &NavClock::bias_ns),
                           at(8, &NavClock::drift_nsps), at(12, &NavClock::time_accuracy_ns),
                           at(16, &NavClock::frequency_accuracy_psps));
  }
  friend bool operator==(const NavClock&, const NavClock&) = default;
};

/// NAV-SVINFO: the head, followed by `channels` blocks.
struct NavSvinfoHead {
  static constexpr MessageId kId{0x01, 0x30};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*channels, flags*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t channels = 0;
  std::uint8_t global_flags = 3;  ///< b0-2 chip generation: 3 = u-blox 7.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavSvinfoHead::time_of_week_ms), at(4, &NavSvinfoHead::channels),
                           at(5, &NavSvinfoHead::global_flags));
  }
  friend bool operator==(const NavSvinfoHead&, const NavSvinfoHead&) = default;
};

/// NAV-SVINFO: one channel.
struct NavSvinfoChannel {
  static constexpr std::size_t kLength = 6 /*state*/ + 2 /*azimuth*/ + 4 /*residual*/;

  std::uint8_t channel = 0;
  std::uint8_t satellite = 0;  ///< GPS 1..32.
  std::uint8_t flags = 0;      ///< b0 used, b2 orbit available, b3 orbit from ephemeris.
  std::uint8_t quality = 0;    ///< 0 idle, 1 search, 4 code lock, 7 code and carrier lock.
  std::uint8_t cn0_dbhz = 0;
  std::int8_t elevation_deg = 0;
  std::int16_t azimuth_deg = 0;
  std::int32_t residual_cm = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavSvinfoChannel::channel), at(1, &NavSvinfoChannel::satellite),
        at(2, &NavSvinfoChannel::flags), at(3, &NavSvinfoChannel::quality),
        at(4, &NavSvinfoChannel::cn0_dbhz), at(5, &NavSvinfoChannel::elevation_deg),
        at(6, &NavSvinfoChannel::azimuth_deg), at(8, &NavSvinfoChannel::residual_cm));
  }
  friend bool operator==(const NavSvinfoChannel&, const NavSvinfoChannel&) = default;
};

}  // namespace rigwire::protocols::ubx
