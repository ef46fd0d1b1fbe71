// A receiver's judgement of the signals that it receives: SEC-SIG and SEC-SIGLOG (class 0x27), in
// wire units. HPG 1.50 and later.
//
// Source: u-blox F9 HPG 1.50 interface description, UBXDOC-963802114-12815, sections 3.18.2
// "UBX-SEC-SIG" and 3.18.3 "UBX-SEC-SIGLOG".
#pragma once

#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// SEC-SIG: the head, followed by `frequencies` blocks.
struct SecSigHead {
  static constexpr MessageId kId{0x27, 0x09};
  static constexpr std::size_t kLength = 4 /*version, flags, reserved, frequencies*/;

  std::uint8_t version = 2;
  /// b0 jamming is looked for, b1-2 jamming: 0 unknown, 1 none, 2 indicated; b3 spoofing is looked
  /// for, b4-6 spoofing: 0 unknown, 1 none, 2 indicated, 3 affirmed.
  std::uint8_t flags = 0;
  std::uint8_t frequencies = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.flags, gap<1>, m.frequencies);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return frequencies; }
};

/// SEC-SIG: signals that share a centre frequency.
struct SecSigBlock {
  static constexpr std::size_t kLength = 4 /*frequency and state*/;

  std::uint32_t state = 0;  ///< b0-23 kHz, b24 jammed.

  static constexpr auto fields(auto& m) { return std::tie(m.state); }
};

/// SEC-SIGLOG: the head, followed by `events` blocks.
struct SecSiglogHead {
  static constexpr MessageId kId{0x27, 0x10};
  static constexpr std::size_t kLength = 2 /*version, events*/ + 6 /*reserved*/;

  std::uint8_t version = 1;
  std::uint8_t events = 0;  ///< At most 16.

  static constexpr auto fields(auto& m) { return std::tie(m.version, m.events, gap<6>); }
  [[nodiscard]] constexpr std::size_t block_count() const { return events; }
};

/// SEC-SIGLOG: one event.
struct SecSiglogEvent {
  static constexpr std::size_t kLength = 4 /*age*/ + 2 /*kinds*/ + 2 /*reserved*/;

  std::uint32_t elapsed_s = 0;
  std::uint8_t detection = 0;  ///< 3 abrupt changes in signals, 4 jamming, ...
  std::uint8_t event = 0;      ///< 0 started, 1 stopped, 2 triggered, 3 timed out.

  static constexpr auto fields(auto& m) {
    return std::tie(m.elapsed_s, m.detection, m.event, gap<2>);
  }
};

}  // namespace rigwire::protocols::ubx
