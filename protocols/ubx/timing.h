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

  static constexpr auto fields() {
    return std::make_tuple(at(0, &TimTp::time_of_week_ms), at(4, &TimTp::time_of_week_rest_e32ms),
                           at(8, &TimTp::quantisation_error_ps), at(12, &TimTp::week),
                           at(14, &TimTp::flags), at(15, &TimTp::reference));
  }
  friend bool operator==(const TimTp&, const TimTp&) = default;
};

/// TIM-TM2: an edge on an external interrupt.
struct TimTm2 {
  static constexpr MessageId kId{0x0D, 0x03};
  static constexpr std::size_t kLength =
      4 /*channel, flags, count*/ + 4 /*weeks*/ + 16 /*times*/ + 4 /*accuracy*/;

  std::uint8_t channel = 0;
  /// b0 running, b2 new falling edge, b3-4 time base, b5 UTC, b6 valid, b7 new rising edge.
  std::uint8_t flags = 0;
  std::uint16_t count = 0;  ///< Of rising edges.
  std::uint16_t rising_week = 0;
  std::uint16_t falling_week = 0;
  std::uint32_t rising_time_of_week_ms = 0;
  std::uint32_t rising_rest_ns = 0;
  std::uint32_t falling_time_of_week_ms = 0;
  std::uint32_t falling_rest_ns = 0;
  std::uint32_t accuracy_ns = 0;

  static constexpr auto fields() {
    return std::make_tuple(at(0, &TimTm2::channel), at(1, &TimTm2::flags), at(2, &TimTm2::count),
                           at(4, &TimTm2::rising_week), at(6, &TimTm2::falling_week),
                           at(8, &TimTm2::rising_time_of_week_ms), at(12, &TimTm2::rising_rest_ns),
                           at(16, &TimTm2::falling_time_of_week_ms),
                           at(20, &TimTm2::falling_rest_ns), at(24, &TimTm2::accuracy_ns));
  }
  friend bool operator==(const TimTm2&, const TimTm2&) = default;
};

}  // namespace rigwire::protocols::ubx
