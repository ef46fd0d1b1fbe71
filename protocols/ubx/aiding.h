// Aiding messages (class 0x0B) of u-blox 7 and 8, in wire units. Asked by a poll with an empty
// payload, or with one byte, the satellite.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.9 "UBX-AID".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// AID-INI: position, time and frequency to begin with.
struct AidIni {
  static constexpr MessageId kId{0x0B, 0x01};
  static constexpr std::size_t kLength =
      16 /*position*/ + 20 /*time*/ + 8 /*frequency*/ + 4 /*flags*/;

  /// ECEF in cm; or latitude, longitude in 1e-7 deg and altitude in cm (flags b5).
  std::array<std::int32_t, 3> position{};
  std::uint32_t position_accuracy_cm = 0;
  std::uint16_t time_mark = 0;  ///< b0 enabled, b1 falling edge.
  std::uint16_t week = 0;
  std::uint32_t time_of_week_ms = 0;
  std::int32_t time_of_week_rest_ns = 0;
  std::uint32_t time_accuracy_ms = 0;
  std::uint32_t time_accuracy_ns = 0;
  std::int32_t clock_drift = 0;            ///< ns/s, or 0.01 Hz (flags b4).
  std::uint32_t clock_drift_accuracy = 0;  ///< ppb, or ns/s.
  /// b0 position, b1 time, b2 drift, b3 time mark, b4 frequency, b5 geodetic, b6 no altitude.
  std::uint32_t flags = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidIni::position), at(12, &AidIni::position_accuracy_cm),
                           at(16, &AidIni::time_mark), at(18, &AidIni::week),
                           at(20, &AidIni::time_of_week_ms), at(24, &AidIni::time_of_week_rest_ns),
                           at(28, &AidIni::time_accuracy_ms), at(32, &AidIni::time_accuracy_ns),
                           at(36, &AidIni::clock_drift), at(40, &AidIni::clock_drift_accuracy),
                           at(44, &AidIni::flags));
  }
  friend bool operator==(const AidIni&, const AidIni&) = default;
};

/// AID-HUI: health, UTC and ionosphere of GPS.
struct AidHui {
  static constexpr MessageId kId{0x0B, 0x02};
  static constexpr std::size_t kLength =
      4 /*health*/ + 20 /*UTC*/ + 12 /*leap seconds*/ + 32 /*ionosphere*/ + 4 /*flags*/;

  std::uint32_t health = 0;  ///< A bit a satellite, b0 = PRN 1: healthy.
  double utc_a0_s = 0.0;
  double utc_a1 = 0.0;  ///< s/s.
  std::int32_t utc_reference_s = 0;
  std::int16_t utc_reference_week = 0;
  std::int16_t leap_seconds = 0;
  std::int16_t leap_week = 0;
  std::int16_t leap_day = 0;
  std::int16_t leap_seconds_future = 0;
  std::array<float, 4> klobuchar_alpha{};
  std::array<float, 4> klobuchar_beta{};
  std::uint32_t flags = 0;  ///< b0 health, b1 UTC, b2 ionosphere valid.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidHui::health), at(4, &AidHui::utc_a0_s),
                           at(12, &AidHui::utc_a1), at(20, &AidHui::utc_reference_s),
                           at(24, &AidHui::utc_reference_week), at(26, &AidHui::leap_seconds),
                           at(28, &AidHui::leap_week), at(30, &AidHui::leap_day),
                           at(32, &AidHui::leap_seconds_future), at(36, &AidHui::klobuchar_alpha),
                           at(52, &AidHui::klobuchar_beta), at(68, &AidHui::flags));
  }
  friend bool operator==(const AidHui&, const AidHui&) = default;
};

/// AID-ALM without an almanac: what a receiver answers that has none.
struct AidAlmHead {
  static constexpr MessageId kId{0x0B, 0x30};
  static constexpr std::size_t kLength = 4 /*satellite*/ + 4 /*week*/;

  std::uint32_t satellite = 0;
  std::uint32_t week = 0;  ///< 0 = no almanac.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidAlmHead::satellite), at(4, &AidAlmHead::week));
  }
  friend bool operator==(const AidAlmHead&, const AidAlmHead&) = default;
};

/// AID-ALM with one.
struct AidAlm {
  static constexpr MessageId kId{0x0B, 0x30};
  static constexpr std::size_t kLength = AidAlmHead::kLength + 8 * 4 /*words*/;

  std::uint32_t satellite = 0;
  std::uint32_t week = 0;
  /// Words 3..10 of the almanac page, 24 bits each, no parity.
  std::array<std::uint32_t, 8> words{};

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidAlm::satellite), at(4, &AidAlm::week), at(8, &AidAlm::words));
  }
  friend bool operator==(const AidAlm&, const AidAlm&) = default;
};

/// AID-EPH without an ephemeris: what a receiver answers that has none.
struct AidEphHead {
  static constexpr MessageId kId{0x0B, 0x31};
  static constexpr std::size_t kLength = 4 /*satellite*/ + 4 /*handover word*/;

  std::uint32_t satellite = 0;
  std::uint32_t handover_word = 0;  ///< 0 = no ephemeris.

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidEphHead::satellite), at(4, &AidEphHead::handover_word));
  }
  friend bool operator==(const AidEphHead&, const AidEphHead&) = default;
};

/// AID-EPH with one.
struct AidEph {
  static constexpr MessageId kId{0x0B, 0x31};
  static constexpr std::size_t kLength = AidEphHead::kLength + 3 * 8 * 4 /*words*/;

  std::uint32_t satellite = 0;
  std::uint32_t handover_word = 0;           ///< Of the first subframe, 17 bits.
  std::array<std::uint32_t, 8> subframe1{};  ///< Words 3..10, 24 bits each, no parity.
  std::array<std::uint32_t, 8> subframe2{};
  std::array<std::uint32_t, 8> subframe3{};

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidEph::satellite), at(4, &AidEph::handover_word),
                           at(8, &AidEph::subframe1), at(40, &AidEph::subframe2),
                           at(72, &AidEph::subframe3));
  }
  friend bool operator==(const AidEph&, const AidEph&) = default;
};

/// AID-AOP: orbits extrapolated by the receiver, of one satellite; the content is not documented.
struct AidAop {
  static constexpr MessageId kId{0x0B, 0x33};
  static constexpr std::size_t kLength = 2 /*satellite*/ + 2 /*reserved*/ + 64 /*data*/;

  std::uint8_t system = 0;
  std::uint8_t satellite = 0;
  std::array<std::uint8_t, 64> data{};

  static constexpr auto fields() {
    return std::make_tuple(at(0, &AidAop::system), at(1, &AidAop::satellite), at(4, &AidAop::data));
  }
  friend bool operator==(const AidAop&, const AidAop&) = default;
};

}  // namespace rigwire::protocols::ubx
