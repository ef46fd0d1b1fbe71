// Times of the navigation epoch (class 0x01), in wire units: NAV-TIMEGPS, NAV-TIMEUTC, NAV-CLOCK,
// NAV-TIMEGLO, NAV-TIMEBDS, NAV-TIMEGAL, NAV-TIMELS, and what closes an epoch, NAV-EOE.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.17.27 "UBX-NAV-TIMEBDS"
// to 32.17.32 "UBX-NAV-TIMEUTC", 32.17.1 "UBX-NAV-AOPSTATUS", and "UBX-NAV-EOE", "UBX-NAV-CLOCK"
// there. The times of other systems, NAV-TIMELS and NAV-EOE are not known to
// u-blox 7.
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

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
  std::uint8_t valid = 0;   ///< b0 time of week, b1 week, b2 UTC; b4..7 whose UTC (u-blox 8).

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

/// NAV-TIMEGLO: u-blox 8 and later.
struct NavTimeglo {
  static constexpr MessageId kId{0x01, 0x23};
  static constexpr std::size_t kLength =
      4 /*time*/ + 8 /*time of day*/ + 4 /*date, valid*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint32_t time_of_day_s = 0;    ///< UTC and three hours, rounded.
  std::int32_t time_of_day_rest_ns = 0;
  std::uint16_t day = 0;        ///< Of the four years, 1..1461.
  std::uint8_t four_years = 0;  ///< Since 1996, from 1.
  std::uint8_t valid = 0;       ///< b0 time of day, b1 date.
  std::uint32_t time_accuracy_ns = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavTimeglo::time_of_week_ms), at(4, &NavTimeglo::time_of_day_s),
                           at(8, &NavTimeglo::time_of_day_rest_ns), at(12, &NavTimeglo::day),
                           at(14, &NavTimeglo::four_years), at(15, &NavTimeglo::valid),
                           at(16, &NavTimeglo::time_accuracy_ns));
  }
  friend bool operator==(const NavTimeglo&, const NavTimeglo&) = default;
};

/// NAV-TIMEBDS and NAV-TIMEGAL: time of week and week of another system. u-blox 8 and later.
struct NavTimeOfSystem {
  static constexpr std::size_t kLength =
      4 /*time*/ + 8 /*time of week*/ + 2 /*week*/ + 2 /*leap, valid*/ + 4 /*accuracy*/;

  std::uint32_t time_of_week_ms = 0;        ///< GPS time of week of the navigation epoch.
  std::uint32_t system_time_of_week_s = 0;  ///< Of the system, rounded.
  std::int32_t system_time_of_week_rest_ns = 0;
  std::int16_t week = 0;         ///< Of the system.
  std::int8_t leap_seconds = 0;  ///< The system's time minus UTC.
  std::uint8_t valid = 0;        ///< b0 time of week, b1 week, b2 leap seconds.
  std::uint32_t time_accuracy_ns = 0;

  static constexpr auto fields() {
    return std::make_tuple(
        at(0, &NavTimeOfSystem::time_of_week_ms), at(4, &NavTimeOfSystem::system_time_of_week_s),
        at(8, &NavTimeOfSystem::system_time_of_week_rest_ns), at(12, &NavTimeOfSystem::week),
        at(14, &NavTimeOfSystem::leap_seconds), at(15, &NavTimeOfSystem::valid),
        at(16, &NavTimeOfSystem::time_accuracy_ns));
  }
  friend bool operator==(const NavTimeOfSystem&, const NavTimeOfSystem&) = default;
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
  /// Of leap_seconds: 0 default, 1 GPS and GLONASS, 2 GPS, 255 unknown.
  std::uint8_t source = 0;
  std::int8_t leap_seconds = 0;       ///< GPS minus UTC.
  std::uint8_t change_source = 0;     ///< 0 none, 2 GPS.
  std::int8_t change = 0;             ///< -1, 0 (nothing scheduled) or 1.
  std::int32_t time_to_change_s = 0;  ///< Negative after it.
  std::uint16_t change_week = 0;      ///< GPS week and day (1 = Sunday) at whose end it happens.
  std::uint16_t change_day = 0;
  std::uint8_t valid = 0;  ///< b0 leap_seconds, b1 time_to_change_s.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavTimels::time_of_week_ms), at(4, &NavTimels::version),
                           at(8, &NavTimels::source), at(9, &NavTimels::leap_seconds),
                           at(10, &NavTimels::change_source), at(11, &NavTimels::change),
                           at(12, &NavTimels::time_to_change_s), at(16, &NavTimels::change_week),
                           at(18, &NavTimels::change_day), at(23, &NavTimels::valid));
  }
  friend bool operator==(const NavTimels&, const NavTimels&) = default;
};

/// NAV-EOE: nothing more comes of this epoch. Protocol 18 and later.
struct NavEoe {
  static constexpr MessageId kId{0x01, 0x61};
  static constexpr std::size_t kLength = 4 /*time*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.

  static constexpr auto fields() { return std::make_tuple(at(0, &NavEoe::time_of_week_ms)); }
  friend bool operator==(const NavEoe&, const NavEoe&) = default;
};

/// NAV-AOPSTATUS: orbits extrapolated by the receiver itself.
struct NavAopstatus {
  static constexpr MessageId kId{0x01, 0x60};
  static constexpr std::size_t kLength = 4 /*time*/ + 2 /*state*/ + 10 /*reserved*/;

  std::uint32_t time_of_week_ms = 0;  ///< GPS time of week of the navigation epoch.
  std::uint8_t configuration = 0;     ///< b0 switched on.
  std::uint8_t status = 0;            ///< 0 idle.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &NavAopstatus::time_of_week_ms),
                           at(4, &NavAopstatus::configuration), at(5, &NavAopstatus::status));
  }
  friend bool operator==(const NavAopstatus&, const NavAopstatus&) = default;
};

}  // namespace rigwire::protocols::ubx
