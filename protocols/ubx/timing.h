// Timing messages (class 0x0D), in wire units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.20.6 "UBX-TIM-TM2"
// and 32.20.8 "UBX-TIM-TP".
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// TIM-TP: the next pulse, sent before it.
struct TimTp {
  static constexpr MessageId kId{0x0D, 0x01};
  static constexpr std::size_t kLength =
      8 /*time*/ + 4 /*error*/ + 2 /*week*/ + 2 /*flags, reference*/;

  std::uint32_t time_of_week_ms = 0;
  std::uint32_t time_of_week_rest_e32ms = 0;  ///< Units of 2^-32 ms.
  std::int32_t quantisation_error_ps = 0;
  std::uint16_t week = 0;
  std::uint8_t flags = 0;      ///< b0 time base: 0 GNSS, 1 UTC; b1 UTC available.
  std::uint8_t reference = 0;  ///< b0-3 system when the base is GNSS, b4-7 whose UTC.

  static constexpr auto fields(auto& m) {
    return std::tie(m.time_of_week_ms, m.time_of_week_rest_e32ms, m.quantisation_error_ps, m.week,
                    m.flags, m.reference);
  }
};

/// TIM-TM2: an edge on an external interrupt.
struct TimTm2 {
  static constexpr MessageId kId{0x0D, 0x03};
  static constexpr std::size_t kLength =
      4 /*channel, flags, count*/ + 4 /*weeks*/ + 16 /*times*/ + 4 /*accuracy*/;

  std::uint8_t channel = 0;
  /// b0 running, b2 new falling edge, b3-4 time base, b5 UTC, b6 valid, b7 new rising edge.
  std::uint8_t flags = 0;
  std::uint16_t count = 0;  ///< Number of rising edges.
  std::uint16_t rising_week = 0;
  std::uint16_t falling_week = 0;
  std::uint32_t rising_time_of_week_ms = 0;
  std::uint32_t rising_rest_ns = 0;
  std::uint32_t falling_time_of_week_ms = 0;
  std::uint32_t falling_rest_ns = 0;
  std::uint32_t accuracy_ns = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.channel, m.flags, m.count, m.rising_week, m.falling_week,
                    m.rising_time_of_week_ms, m.rising_rest_ns, m.falling_time_of_week_ms,
                    m.falling_rest_ns, m.accuracy_ns);
  }
};

}  // namespace rigwire::protocols::ubx
