// Navigation messages (class 0x01) of u-blox 7, 8 and 9, in wire units; the unit is in each name or
// comment.
//
// Sources: u-blox M8 receiver description, UBX-13003221 R28, section 32.17 "UBX-NAV"; ZED-F9P
// interface description HPG 1.50, UBXDOC-963802114-12815, section 3.15, for NAV-SIG, NAV-COV,
// NAV-SVIN, NAV-RELPOSNED and the high-precision positions. Lengths and ids of the older messages
// checked against recordings of u-blox 7 receivers. NAV-PVT of 84 bytes ends before headVeh: no
// recording of it was available, two client drivers accept that length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// gpsFix / fixType.
inline constexpr std::uint8_t kFixNone = 0;
inline constexpr std::uint8_t kFixDeadReckoning = 1;
inline constexpr std::uint8_t kFix2d = 2;
inline constexpr std::uint8_t kFix3d = 3;
inline constexpr std::uint8_t kFixGnssAndDeadReckoning = 4;
inline constexpr std::uint8_t kFixTimeOnly = 5;
/// A dilution that is not known, in hundredths.
inline constexpr std::uint16_t kNoDilution = 9999;

/// NavPvt::valid. M8 and later also say in b4..7 whose UTC it is.
inline constexpr std::uint8_t kPvtValidDate = 0x01;
inline constexpr std::uint8_t kPvtValidTime = 0x02;
inline constexpr std::uint8_t kPvtFullyResolved = 0x04;
inline constexpr std::uint8_t kPvtValidDeclination = 0x08;
/// NavPvt::flags.
inline constexpr std::uint8_t kPvtFixOk = 0x01;
inline constexpr std::uint8_t kPvtDifferential = 0x02;
inline constexpr std::uint8_t kPvtVehicleHeadingValid = 0x20;
inline constexpr std::uint8_t kPvtCarrierFloat = 0x40;
inline constexpr std::uint8_t kPvtCarrierFixed = 0x80;
/// NavPvt::flags2, u-blox 8 and later.
inline constexpr std::uint8_t kPvtConfirmationAvailable = 0x20;
inline constexpr std::uint8_t kPvtConfirmedDate = 0x40;
inline constexpr std::uint8_t kPvtConfirmedTime = 0x80;
/// NavPvt92::flags3: b0; b1..4 hold the age class of the last correction (F9).
inline constexpr std::uint16_t kPvtInvalidPosition = 0x0001;
inline constexpr unsigned kPvtCorrectionAgeShift = 1;

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
  std::uint8_t valid = 0;   ///< kPvtValidDate, ...
  std::uint32_t time_accuracy_ns = 0;
  std::int32_t nanosecond = 0;  ///< Add to second; may be negative.
  std::uint8_t fix_type = 0;
  std::uint8_t flags = 0;  ///< kPvtFixOk, ...
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
  std::int32_t heading_e5deg = 0;  ///< Heading of motion.
  std::uint32_t speed_accuracy_mmps = 0;
  std::uint32_t heading_accuracy_e5deg = 0;
  std::uint16_t position_dilution_e2 = kNoDilution;

  /// What both forms begin with.
  static constexpr auto first_fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.year, m.month, m.day, m.hour, m.minute, m.second, m.valid,
                    m.time_accuracy_ns, m.nanosecond, m.fix_type, m.flags, m.flags2,
                    m.satellites_used, m.longitude_e7deg, m.latitude_e7deg, m.ellipsoid_height_mm,
                    m.mean_sea_level_height_mm, m.horizontal_accuracy_mm, m.vertical_accuracy_mm,
                    m.velocity_ned_mmps, m.ground_speed_mmps, m.heading_e5deg,
                    m.speed_accuracy_mmps, m.heading_accuracy_e5deg, m.position_dilution_e2);
  }
  static constexpr auto fields(auto& m) {
    return std::tuple_cat(first_fields(m), std::tie(gap<6>));
  }
};

/// NAV-PVT in the 92-byte form of u-blox 8 and later: the shorter form, with the fields in and
/// after its reserved bytes.
struct NavPvt92 : NavPvt {
  static constexpr MessageId kId{0x01, 0x07};
  static constexpr std::size_t kLength = NavPvt::kLength - 6 /*reserved*/ + 2 /*flags*/ +
                                         4 /*reserved*/ + 4 /*vehicle*/ + 4 /*declination*/;

  std::uint16_t flags3 = 0;                ///< kPvtInvalidPosition, ...
  std::int32_t vehicle_heading_e5deg = 0;  ///< Valid with kPvtVehicleHeadingValid.
  std::int16_t declination_e2deg = 0;      ///< Magnetic; valid with kPvtValidDeclination.
  std::uint16_t declination_accuracy_e2deg = 0;

  static constexpr auto fields(auto& m) {
    return std::tuple_cat(first_fields(m),
                          std::tie(m.flags3, gap<4>, m.vehicle_heading_e5deg, m.declination_e2deg,
                                   m.declination_accuracy_e2deg));
  }
};

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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.position_cm, m.position_accuracy_cm);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.longitude_e7deg, m.latitude_e7deg, m.ellipsoid_height_mm,
                    m.mean_sea_level_height_mm, m.horizontal_accuracy_mm, m.vertical_accuracy_mm);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.fix_type, m.flags, m.fix_status, m.flags2,
                    m.time_to_first_fix_ms, m.since_start_ms);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.geometric_e2, m.position_e2, m.time_e2, m.vertical_e2,
                    m.horizontal_e2, m.northing_e2, m.easting_e2);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.time_of_week_rest_ns, m.week, m.fix_type, m.flags,
                    m.position_cm, m.position_accuracy_cm, m.velocity_cmps, m.speed_accuracy_cmps,
                    m.position_dilution_e2, gap<1>, m.satellites_used, gap<4>);
  }
};

/// NAV-VELECEF.
struct NavVelecef {
  static constexpr MessageId kId{0x01, 0x11};
  static constexpr std::size_t kLength = 4 /*time*/ + 12 /*velocity*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::array<std::int32_t, 3> velocity_cmps{};
  std::uint32_t speed_accuracy_cmps = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.velocity_cmps, m.speed_accuracy_cmps);
  }
};

/// NAV-ODO: ground distance. u-blox 8 and later.
struct NavOdo {
  static constexpr MessageId kId{0x01, 0x09};
  static constexpr std::size_t kLength = 4 /*version*/ + 4 /*time*/ + 12 /*distances*/;

  std::uint8_t version = 0;
  std::uint32_t time_of_week_ms = 0;   ///< GPS time of week of the navigation epoch.
  std::uint32_t distance_m = 0;        ///< Since NAV-RESETODO.
  std::uint32_t total_distance_m = 0;  ///< Since the last cold start.
  std::uint32_t accuracy_m = 0;        ///< Accuracy of distance_m.

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<3>, m.time_of_week_ms, m.distance_m, m.total_distance_m,
                    m.accuracy_m);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.velocity_ned_cmps, m.speed_cmps, m.ground_speed_cmps,
                    m.heading_e5deg, m.speed_accuracy_cmps, m.heading_accuracy_e5deg);
  }
};

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

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<3>, m.time_of_week_ms, m.position_cm, m.position_rest_e4m,
                    m.flags, m.position_accuracy_e4m);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<2>, m.flags, m.time_of_week_ms, m.longitude_e7deg,
                    m.latitude_e7deg, m.ellipsoid_height_mm, m.mean_sea_level_height_mm,
                    m.longitude_rest_e9deg, m.latitude_rest_e9deg, m.ellipsoid_height_rest_e4m,
                    m.mean_sea_level_height_rest_e4m, m.horizontal_accuracy_e4m,
                    m.vertical_accuracy_e4m);
  }
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
  std::array<float, 6> velocity_covariance_ned_m2ps2{};  ///< NN, NE, ND, EE, ED, DD.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.version, m.position_valid, m.velocity_valid, gap<9>,
                    m.position_covariance_ned_m2, m.velocity_covariance_ned_m2ps2);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<3>, m.time_of_week_ms, m.duration_s, m.mean_cm, m.mean_rest_e4m,
                    gap<1>, m.mean_accuracy_e4m, m.observations, m.valid, m.active, gap<2>);
  }
};

/// NavRelposned::flags.
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

/// NAV-RELPOSNED version 1 (F9): from the reference station, north, east, down.
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, gap<1>, m.station, m.time_of_week_ms, m.relative_ned_cm, m.length_cm,
                    m.heading_e5deg, gap<4>, m.relative_ned_rest_e4m, m.length_rest_e4m,
                    m.accuracy_ned_e4m, m.length_accuracy_e4m, m.heading_accuracy_e5deg, gap<4>,
                    m.flags);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.time_of_week_rest_ns, m.week, m.leap_seconds, m.valid,
                    m.time_accuracy_ns);
  }
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
  std::uint8_t valid = 0;   ///< b0 time of week, b1 week, b2 UTC; b4..7 whose UTC (u-blox 8).

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.time_accuracy_ns, m.nanosecond, m.year, m.month, m.day,
                    m.hour, m.minute, m.second, m.valid);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.bias_ns, m.drift_nsps, m.time_accuracy_ns,
                    m.frequency_accuracy_psps);
  }
};

/// NAV-TIMEGLO: u-blox 8 and later.
struct NavTimeglo {
  static constexpr MessageId kId{0x01, 0x23};
  static constexpr std::size_t kLength =
      4 /*time*/ + 8 /*time of day*/ + 4 /*date, valid*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint32_t time_of_day_s = 0;    ///< UTC and three hours, rounded.
  std::int32_t time_of_day_rest_ns = 0;
  std::uint16_t day = 0;        ///< Day of the four years, 1..1461.
  std::uint8_t four_years = 0;  ///< Number of the four years since 1996, from 1.
  std::uint8_t valid = 0;       ///< b0 time of day, b1 date.
  std::uint32_t time_accuracy_ns = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.time_of_day_s, m.time_of_day_rest_ns, m.day, m.four_years,
                    m.valid, m.time_accuracy_ns);
  }
};

/// NAV-TIMEBDS and NAV-TIMEGAL: time of week and week of another system. u-blox 8 and later.
struct NavTimeOfSystem {
  static constexpr std::size_t kLength =
      4 /*time*/ + 8 /*time of week*/ + 2 /*week*/ + 2 /*leap, valid*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;        ///< GPS time of week of the navigation epoch.
  std::uint32_t system_time_of_week_s = 0;  ///< Time of week of the system, rounded.
  std::int32_t system_time_of_week_rest_ns = 0;
  std::int16_t week = 0;         ///< Week of the system.
  std::int8_t leap_seconds = 0;  ///< The system's time minus UTC.
  std::uint8_t valid = 0;        ///< b0 time of week, b1 week, b2 leap seconds.
  std::uint32_t time_accuracy_ns = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.system_time_of_week_s, m.system_time_of_week_rest_ns,
                    m.week, m.leap_seconds, m.valid, m.time_accuracy_ns);
  }
};
struct NavTimebds : NavTimeOfSystem {
  static constexpr MessageId kId{0x01, 0x24};
};
struct NavTimegal : NavTimeOfSystem {
  static constexpr MessageId kId{0x01, 0x25};
};

/// NAV-TIMELS: the leap second that is and the one to come. u-blox 8 and later.
struct NavTimels {
  static constexpr MessageId kId{0x01, 0x26};
  static constexpr std::size_t kLength =
      4 /*time*/ + 4 /*version*/ + 4 /*seconds*/ + 4 /*time to event*/ + 4 /*date*/ + 4 /*valid*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 0;
  /// Source of leap_seconds: 0 default, 1 GPS and GLONASS, 2 GPS, 255 unknown.
  std::uint8_t source = 0;
  std::int8_t leap_seconds = 0;       ///< GPS minus UTC.
  std::uint8_t change_source = 0;     ///< 0 none, 2 GPS.
  std::int8_t change = 0;             ///< -1, 0 (nothing scheduled) or 1.
  std::int32_t time_to_change_s = 0;  ///< Negative after it.
  std::uint16_t change_week = 0;      ///< GPS week and day (1 = Sunday) at whose end it happens.
  std::uint16_t change_day = 0;
  std::uint8_t valid = 0;  ///< b0 leap_seconds, b1 time_to_change_s.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.version, gap<3>, m.source, m.leap_seconds, m.change_source,
                    m.change, m.time_to_change_s, m.change_week, m.change_day, gap<3>, m.valid);
  }
};

/// NAV-EOE: nothing more comes of this epoch. Protocol 18 and later.
struct NavEoe {
  static constexpr MessageId kId{0x01, 0x61};
  static constexpr std::size_t kLength = 4 /*time*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.

  static constexpr auto fields(auto& m) { return std::tie(m.time_of_week_ms); }
};

/// NAV-AOPSTATUS: orbits extrapolated by the receiver itself.
struct NavAopstatus {
  static constexpr MessageId kId{0x01, 0x60};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*state*/ + 10 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t configuration = 0;     ///< b0 switched on.
  std::uint8_t status = 0;            ///< 0 idle.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.configuration, m.status, gap<10>);
  }
};

/// NAV-SVINFO: the head, followed by `channels` blocks.
struct NavSvinfoHead {
  static constexpr MessageId kId{0x01, 0x30};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*channels, flags*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t channels = 0;
  std::uint8_t global_flags = 3;  ///< b0-2 chip generation: 3 = u-blox 7, 4 = u-blox 8.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.channels, m.global_flags, gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return channels; }
};

/// NAV-SVINFO: one channel.
struct NavSvinfoChannel {
  static constexpr std::size_t kLength = 6 /*state*/ + 2 /*azimuth*/ + 4 /*residual*/;

  std::uint8_t channel = 0;    ///< 255 when no channel is on it.
  std::uint8_t satellite = 0;  ///< GPS 1..32, SBAS 120..158.
  /// b0 used, b1 corrected, b2 orbit available, b3 orbit from ephemeris, b5 from almanac.
  std::uint8_t flags = 0;
  std::uint8_t quality = 0;  ///< 0 idle, 1 search, 4 code lock, 7 code and carrier lock.
  std::uint8_t cn0_dbhz = 0;
  std::int8_t elevation_deg = 0;
  std::int16_t azimuth_deg = 0;
  std::int32_t residual_cm = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.channel, m.satellite, m.flags, m.quality, m.cn0_dbhz, m.elevation_deg,
                    m.azimuth_deg, m.residual_cm);
  }
};

/// NavSatBlock::flags.
/// Coded as NavSvinfoChannel::quality.
inline constexpr std::uint32_t kSatQualityMask = 0x0000'0007;
inline constexpr std::uint32_t kSatUsed = 0x0000'0008;
inline constexpr std::uint32_t kSatHealthy = 0x0000'0010;
inline constexpr std::uint32_t kSatUnhealthy = 0x0000'0020;
inline constexpr std::uint32_t kSatCorrected = 0x0000'0040;
inline constexpr std::uint32_t kSatSmoothed = 0x0000'0080;
inline constexpr std::uint32_t kSatOrbitEphemeris = 0x0000'0100;  ///< Source of the orbit, b8..10.
inline constexpr std::uint32_t kSatOrbitAlmanac = 0x0000'0200;
inline constexpr std::uint32_t kSatEphemerisAvailable = 0x0000'0800;
inline constexpr std::uint32_t kSatAlmanacAvailable = 0x0000'1000;
inline constexpr std::uint32_t kSatSbasCorrections = 0x0001'0000;
inline constexpr std::uint32_t kSatRtcmCorrections = 0x0002'0000;
inline constexpr std::uint32_t kSatRangeCorrected = 0x0010'0000;
inline constexpr std::uint32_t kSatCarrierCorrected = 0x0020'0000;
inline constexpr std::uint32_t kSatDopplerCorrected = 0x0040'0000;

/// NAV-SAT: the head, followed by `satellites` blocks. u-blox 8 and later.
struct NavSatHead {
  static constexpr MessageId kId{0x01, 0x35};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*version, satellites*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 1;
  std::uint8_t satellites = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.version, m.satellites, gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
};

/// NAV-SAT: one satellite.
struct NavSatBlock {
  static constexpr std::size_t kLength =
      4 /*satellite, signal*/ + 4 /*azimuth, residual*/ + 4 /*flags*/;

  std::uint8_t system = 0;     ///< 0 GPS, 1 SBAS, 2 Galileo, 3 BeiDou, 5 QZSS, 6 GLONASS.
  std::uint8_t satellite = 0;  ///< Within its system; 255 an unidentified GLONASS satellite.
  std::uint8_t cn0_dbhz = 0;
  std::int8_t elevation_deg = 0;  ///< -91 when not known.
  std::int16_t azimuth_deg = 0;
  std::int16_t residual_dm = 0;
  std::uint32_t flags = 0;  ///< kSatUsed, ...

  static constexpr auto fields(auto& m) {
    return std::tie(m.system, m.satellite, m.cn0_dbhz, m.elevation_deg, m.azimuth_deg,
                    m.residual_dm, m.flags);
  }
};

/// NAV-SIG: the head, followed by `signals` blocks. F9.
struct NavSigHead {
  static constexpr MessageId kId{0x01, 0x43};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*version, signals*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 0;
  std::uint8_t signals = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.version, m.signals, gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return signals; }
};

/// NAV-SIG: one signal.
struct NavSigBlock {
  static constexpr std::size_t kLength =
      4 /*signal*/ + 2 /*residual*/ + 4 /*quality*/ + 2 /*flags*/ + 4 /*reserved*/;

  std::uint8_t system = 0;  ///< Coded as NavSatBlock::system.
  std::uint8_t satellite = 0;
  std::uint8_t signal = 0;          ///< GPS: 0 L1C/A, 3 L2CL, 4 L2CM.
  std::uint8_t frequency_slot = 0;  ///< GLONASS only: slot + 7.
  std::int16_t residual_dm = 0;
  std::uint8_t cn0_dbhz = 0;
  std::uint8_t quality = 0;            ///< Coded as NavSvinfoChannel::quality.
  std::uint8_t correction_source = 0;  ///< 0 none, 1 SBAS, 4 RTCM 3 observations.
  std::uint8_t ionosphere_model = 0;   ///< 0 none, 1 Klobuchar of GPS, 2 SBAS, 8 two frequencies.
  /// b0-1 health, b2 smoothed, b3-5 range, carrier, Doppler used, b6-8 the same corrected.
  std::uint16_t flags = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.system, m.satellite, m.signal, m.frequency_slot, m.residual_dm, m.cn0_dbhz,
                    m.quality, m.correction_source, m.ionosphere_model, m.flags, gap<4>);
  }
};

/// NAV-ORB: the head, followed by `satellites` blocks. u-blox 8 and later.
struct NavOrbHead {
  static constexpr MessageId kId{0x01, 0x34};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*version, satellites*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t version = 1;
  std::uint8_t satellites = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.version, m.satellites, gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
};

/// NAV-ORB: what is known of one satellite's orbit.
struct NavOrbBlock {
  static constexpr std::size_t kLength = 2 /*satellite*/ + 1 /*flags*/ + 3 /*orbits*/;

  std::uint8_t system = 0;  ///< Coded as NavSatBlock::system.
  std::uint8_t satellite = 0;
  /// b0-1 health (1 healthy), b2-3 visibility (2 above horizon, 3 above mask).
  std::uint8_t flags = 0;
  /// b0-4 usable for n quarters of an hour, b5-7 source (1 broadcast).
  std::uint8_t ephemeris = 0;
  std::uint8_t almanac = 0;  ///< b0-4 usable for n days, b5-7 source (1 broadcast).
  std::uint8_t other = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.system, m.satellite, m.flags, m.ephemeris, m.almanac, m.other);
  }
};

/// NAV-DGPS: the head, followed by `channels` blocks.
struct NavDgpsHead {
  static constexpr MessageId kId{0x01, 0x31};
  static constexpr std::size_t kLength =
      4 /*time*/ + 4 /*age*/ + 4 /*station*/ + 2 /*channels, status*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::int32_t age_ms = 0;
  std::int16_t station = 0;
  std::int16_t station_health = 0;
  std::uint8_t channels = 0;
  std::uint8_t status = 0;  ///< 0 none, 1 range and range rate corrections.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.age_ms, m.station, m.station_health, m.channels, m.status,
                    gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return channels; }
};

/// NAV-DGPS: one satellite.
struct NavDgpsBlock {
  static constexpr std::size_t kLength = 2 /*satellite, flags*/ + 2 /*age*/ + 8 /*corrections*/;

  std::uint8_t satellite = 0;
  std::uint8_t flags = 0;  ///< b0-3 channel, b4 used.
  std::uint16_t age_ms = 0;
  float range_correction_m = 0.0F;
  float range_rate_correction_mps = 0.0F;

  static constexpr auto fields(auto& m) {
    return std::tie(m.satellite, m.flags, m.age_ms, m.range_correction_m,
                    m.range_rate_correction_mps);
  }
};

/// NAV-SBAS: the head, followed by `satellites` blocks.
struct NavSbasHead {
  static constexpr MessageId kId{0x01, 0x32};
  static constexpr std::size_t kLength = 4 /*time*/ + 6 /*state*/ + 2 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t geostationary = 0;     ///< PRN whose corrections are used; 0 none.
  std::uint8_t mode = 0;              ///< 0 off, 1 on (integrity), 3 test.
  std::int8_t system = -1;            ///< -1 unknown, 0 WAAS, 1 EGNOS, 2 MSAS, 3 GAGAN, 16 GPS.
  std::uint8_t services = 0;          ///< b0 ranging, b1 corrections, b2 integrity, b3 test.
  std::uint8_t satellites = 0;
  std::uint8_t status_flags = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.geostationary, m.mode, m.system, m.services, m.satellites,
                    m.status_flags, gap<2>);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return satellites; }
};

/// NAV-SBAS: one satellite.
struct NavSbasBlock {
  static constexpr std::size_t kLength =
      5 /*satellite*/ + 1 /*reserved*/ + 2 /*range*/ + 2 /*reserved*/ + 2 /*ionosphere*/;

  std::uint8_t satellite = 0;
  std::uint8_t flags = 0;       ///< Reserved from u-blox 8 on.
  std::uint8_t monitoring = 0;  ///< User differential range error index.
  std::int8_t system = -1;
  std::uint8_t services = 0;
  std::int16_t range_correction_cm = 0;
  std::int16_t ionosphere_correction_cm = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.satellite, m.flags, m.monitoring, m.system, m.services, gap<1>,
                    m.range_correction_cm, gap<2>, m.ionosphere_correction_cm);
  }
};

}  // namespace rigwire::protocols::ubx
