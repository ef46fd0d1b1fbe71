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

  static constexpr auto fields(auto& m) {
    return std::tie(m.position, m.position_accuracy_cm, m.time_mark, m.week, m.time_of_week_ms,
                    m.time_of_week_rest_ns, m.time_accuracy_ms, m.time_accuracy_ns, m.clock_drift,
                    m.clock_drift_accuracy, m.flags);
  }
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

  static constexpr auto fields(auto& m) {
    return std::tie(m.health, m.utc_a0_s, m.utc_a1, m.utc_reference_s, m.utc_reference_week,
                    m.leap_seconds, m.leap_week, m.leap_day, m.leap_seconds_future, gap<2>,
                    m.klobuchar_alpha, m.klobuchar_beta, m.flags);
  }
};

/// AID-ALM without an almanac: what a receiver answers that has none.
struct AidAlmHead {
  static constexpr MessageId kId{0x0B, 0x30};
  static constexpr std::size_t kLength = 4 /*satellite*/ + 4 /*week*/;

  std::uint32_t satellite = 0;
  std::uint32_t week = 0;  ///< 0 = no almanac.

  static constexpr auto fields(auto& m) { return std::tie(m.satellite, m.week); }
};

/// AID-ALM with one.
struct AidAlm {
  static constexpr MessageId kId{0x0B, 0x30};
  static constexpr std::size_t kLength = AidAlmHead::kLength + 8 * 4 /*words*/;

  std::uint32_t satellite = 0;
  std::uint32_t week = 0;
  /// Words 3..10 of the almanac page, 24 bits each, no parity.
  std::array<std::uint32_t, 8> words{};

  static constexpr auto fields(auto& m) { return std::tie(m.satellite, m.week, m.words); }
};

/// AID-EPH without an ephemeris: what a receiver answers that has none.
struct AidEphHead {
  static constexpr MessageId kId{0x0B, 0x31};
  static constexpr std::size_t kLength = 4 /*satellite*/ + 4 /*handover word*/;

  std::uint32_t satellite = 0;
  std::uint32_t handover_word = 0;  ///< 0 = no ephemeris.

  static constexpr auto fields(auto& m) { return std::tie(m.satellite, m.handover_word); }
};

/// AID-EPH with one.
struct AidEph {
  static constexpr MessageId kId{0x0B, 0x31};
  static constexpr std::size_t kLength = AidEphHead::kLength + 3 * 8 * 4 /*words*/;

  std::uint32_t satellite = 0;
  std::uint32_t handover_word = 0;           ///< HOW of the first subframe, 17 bits.
  std::array<std::uint32_t, 8> subframe1{};  ///< Words 3..10, 24 bits each, no parity.
  std::array<std::uint32_t, 8> subframe2{};
  std::array<std::uint32_t, 8> subframe3{};

  static constexpr auto fields(auto& m) {
    return std::tie(m.satellite, m.handover_word, m.subframe1, m.subframe2, m.subframe3);
  }
};

}  // namespace rigwire::protocols::ubx
