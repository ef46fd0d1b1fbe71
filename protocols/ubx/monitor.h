// Monitor messages (class 0x0A), in wire units.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 32.16 "UBX-MON"; ZED-F9P
// interface description HPG 1.50, UBXDOC-963802114-12815, sections 3.14.1 "UBX-MON-COMMS"
// and 3.14.9 "UBX-MON-RF"; lengths checked against recordings of a NEO-7P and of a ZED-F9P
// (MON-COMMS).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "protocols/ubx/layout.h"

namespace rigwire::protocols::ubx {

/// What MON-IO, MON-MSGPP, MON-RXBUF and MON-TXBUF count by: DDC, UART1, UART2, USB, SPI, reserved.
inline constexpr std::size_t kMonitorPorts = 6;

/// MON-VER: the head, followed by extensions of 30 characters each. version.h reads it as text.
struct MonVerHead {
  static constexpr MessageId kId{0x0A, 0x04};
  static constexpr std::size_t kLength = 30 /*software*/ + 10 /*hardware*/;

  std::array<std::uint8_t, 30> software{};  ///< Text, padded with zeros.
  std::array<std::uint8_t, 10> hardware{};

  static constexpr auto fields(auto& m) { return std::tie(m.software, m.hardware); }
};

/// MON-VER: one extension.
struct MonVerExtension {
  static constexpr std::size_t kLength = 30 /*text*/;

  std::array<std::uint8_t, 30> text{};

  static constexpr auto fields(auto& m) { return std::tie(m.text); }
};

/// MON-IO: one port; the message is kMonitorPorts of them behind an empty head.
struct MonIoPort {
  static constexpr std::size_t kLength = 8 /*bytes*/ + 8 /*errors*/ + 4 /*busy, reserved*/;

  std::uint32_t received_bytes = 0;
  std::uint32_t sent_bytes = 0;
  std::uint16_t parity_errors = 0;
  std::uint16_t framing_errors = 0;
  std::uint16_t overrun_errors = 0;
  std::uint16_t break_conditions = 0;
  std::uint8_t receiving = 0;
  std::uint8_t sending = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.received_bytes, m.sent_bytes, m.parity_errors, m.framing_errors,
                    m.overrun_errors, m.break_conditions, m.receiving, m.sending, gap<2>);
  }
};

/// MON-IO: the empty head.
struct MonIoHead {
  static constexpr MessageId kId{0x0A, 0x02};
  static constexpr std::size_t kLength = 0 /*nothing*/;

  static constexpr auto fields([[maybe_unused]] auto& m) { return std::tie(); }
};

/// MON-MSGPP: messages taken on each port, by protocol.
struct MonMsgpp {
  static constexpr MessageId kId{0x0A, 0x06};
  static constexpr std::size_t kLength = 6 * 8 * 2 /*messages*/ + 6 * 4 /*skipped bytes*/;

  /// Port by port, eight protocols each: b0 of the protocol masks first.
  std::array<std::uint16_t, 48> messages{};
  std::array<std::uint32_t, 6> skipped_bytes{};

  static constexpr auto fields(auto& m) { return std::tie(m.messages, m.skipped_bytes); }
};

/// MON-RXBUF: receive buffers by port.
struct MonRxbuf {
  static constexpr MessageId kId{0x0A, 0x07};
  static constexpr std::size_t kLength = 6 * 2 /*pending*/ + 6 /*usage*/ + 6 /*peak*/;

  std::array<std::uint16_t, 6> pending_bytes{};
  std::array<std::uint8_t, 6> usage_percent{};       ///< Highest of the last second.
  std::array<std::uint8_t, 6> peak_usage_percent{};  ///< Highest since start.

  static constexpr auto fields(auto& m) {
    return std::tie(m.pending_bytes, m.usage_percent, m.peak_usage_percent);
  }
};

/// MON-TXBUF: send buffers by port.
struct MonTxbuf {
  static constexpr MessageId kId{0x0A, 0x08};
  static constexpr std::size_t kLength =
      6 * 2 /*pending*/ + 6 /*usage*/ + 6 /*peak*/ + 4 /*total, errors, reserved*/;

  std::array<std::uint16_t, 6> pending_bytes{};
  std::array<std::uint8_t, 6> usage_percent{};       ///< Highest of the last second.
  std::array<std::uint8_t, 6> peak_usage_percent{};  ///< Highest since start.
  std::uint8_t total_usage_percent = 0;
  std::uint8_t total_peak_usage_percent = 0;
  std::uint8_t errors = 0;  ///< b0-5 limit of that port reached, b6 memory, b7 allocation.

  static constexpr auto fields(auto& m) {
    return std::tie(m.pending_bytes, m.usage_percent, m.peak_usage_percent, m.total_usage_percent,
                    m.total_peak_usage_percent, m.errors, gap<1>);
  }
};

/// MON-HW in the 60-byte form of u-blox 7 and 8.
struct MonHw {
  static constexpr MessageId kId{0x0A, 0x09};
  static constexpr std::size_t kLength = 16 /*pins*/ + 8 /*noise, antenna, flags*/ +
                                         4 /*used pins*/ + 20 /*functions, jamming*/ +
                                         12 /*interrupt, pull*/;

  std::uint32_t pin_select = 0;
  std::uint32_t pin_bank = 0;
  std::uint32_t pin_direction = 0;
  std::uint32_t pin_value = 0;
  std::uint16_t noise_per_ms = 0;
  std::uint16_t gain_control = 0;   ///< 0..8191.
  std::uint8_t antenna_status = 0;  ///< 0 starting, 1 unknown, 2 good, 3 short, 4 open.
  std::uint8_t antenna_power = 0;   ///< 1 = on.
  /// b0 real-time clock calibrated, b2-3 jamming (0 unknown, 1 none, 2 warning, 3 critical).
  std::uint8_t flags = 0;
  std::uint32_t used_mask = 0;
  std::array<std::uint8_t, 17> pin_function{};
  std::uint8_t jamming_indicator = 0;  ///< 0 none .. 255 strong, continuous wave.
  std::uint32_t pin_interrupt = 0;
  std::uint32_t pull_high = 0;
  std::uint32_t pull_low = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.pin_select, m.pin_bank, m.pin_direction, m.pin_value, m.noise_per_ms,
                    m.gain_control, m.antenna_status, m.antenna_power, m.flags, gap<1>, m.used_mask,
                    m.pin_function, m.jamming_indicator, gap<2>, m.pin_interrupt, m.pull_high,
                    m.pull_low);
  }
};

/// MON-HW2: the radio part.
struct MonHw2 {
  static constexpr MessageId kId{0x0A, 0x0B};
  static constexpr std::size_t kLength =
      4 /*imbalance*/ + 4 /*source*/ + 4 /*configuration*/ + 8 /*reserved*/ + 8 /*self test*/;

  std::int8_t offset_i = 0;
  std::uint8_t magnitude_i = 0;
  std::int8_t offset_q = 0;
  std::uint8_t magnitude_q = 0;
  std::uint8_t configuration_source = 0;  ///< 114 ROM, 111 OTP, 112 pins, 102 flash.
  std::uint32_t low_level_configuration = 0;
  std::uint32_t self_test = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.offset_i, m.magnitude_i, m.offset_q, m.magnitude_q, m.configuration_source,
                    gap<3>, m.low_level_configuration, gap<8>, m.self_test, gap<4>);
  }
};

/// MON-GNSS: major systems, one bit each: b0 GPS, b1 GLONASS, b2 BeiDou, b3 Galileo. u-blox 8 and
/// later.
struct MonGnss {
  static constexpr MessageId kId{0x0A, 0x28};
  static constexpr std::size_t kLength = 5 /*version, systems*/ + 3 /*reserved*/;

  std::uint8_t version = 0;
  std::uint8_t supported = 0;
  std::uint8_t default_on = 0;
  std::uint8_t enabled = 0;
  std::uint8_t simultaneous = 0;  ///< So many at once at most.

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.supported, m.default_on, m.enabled, m.simultaneous, gap<3>);
  }
};

/// MON-PATCH: the head, followed by `entries` patches of 16 bytes. u-blox 8 and later.
struct MonPatchHead {
  static constexpr MessageId kId{0x0A, 0x27};
  static constexpr std::size_t kLength = 2 * 2 /*version, entries*/;

  std::uint16_t version = 1;
  std::uint16_t entries = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.version, m.entries); }
};

/// MON-COMMS: the head, followed by `ports` ports. F9.
struct MonCommsHead {
  static constexpr MessageId kId{0x0A, 0x36};
  static constexpr std::size_t kLength = 4 /*version, ports, errors*/ + 4 /*protocols*/;

  std::uint8_t version = 0;
  std::uint8_t ports = 0;
  std::uint8_t errors = 0;  ///< b0 memory, b1 transmit buffer full, b2-4 port of this message.
  std::array<std::uint8_t, 4> protocols{0, 1, 5, 6};  ///< UBX, NMEA, RTCM 3, SPARTN.

  static constexpr auto fields(auto& m) {
    return std::tie(m.version, m.ports, m.errors, gap<1>, m.protocols);
  }
  [[nodiscard]] constexpr std::size_t block_count() const { return ports; }
};

/// MON-COMMS: one port.
struct MonCommsPort {
  static constexpr std::size_t kLength = 2 /*port*/ + 8 /*sent*/ + 10 /*received, errors*/ +
                                         8 /*messages*/ + 8 /*reserved*/ + 4 /*skipped*/;

  std::uint16_t port = 0;  ///< 0x0000 I2C, 0x0100 UART1, 0x0201 UART2, 0x0300 USB, 0x0400 SPI.
  std::uint16_t sending_bytes = 0;
  std::uint32_t sent_bytes = 0;
  std::uint8_t sending_percent = 0;
  std::uint8_t sending_peak_percent = 0;
  std::uint16_t received_pending_bytes = 0;
  std::uint32_t received_bytes = 0;
  std::uint8_t received_percent = 0;
  std::uint8_t received_peak_percent = 0;
  std::uint16_t overruns = 0;
  std::array<std::uint16_t, 4> messages{};  ///< In the order of MonCommsHead::protocols.
  std::uint32_t skipped_bytes = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.port, m.sending_bytes, m.sent_bytes, m.sending_percent,
                    m.sending_peak_percent, m.received_pending_bytes, m.received_bytes,
                    m.received_percent, m.received_peak_percent, m.overruns, m.messages, gap<8>,
                    m.skipped_bytes);
  }
};

/// MON-RXR: the receiver wakes or goes to sleep.
struct MonRxr {
  static constexpr MessageId kId{0x0A, 0x21};
  static constexpr std::size_t kLength = 1 /*flags*/;

  std::uint8_t flags = 0;  ///< b0 awake.

  static constexpr auto fields(auto& m) { return std::tie(m.flags); }
};

/// MON-RF: the head, followed by `blocks` blocks. F9.
struct MonRfHead {
  static constexpr MessageId kId{0x0A, 0x38};
  static constexpr std::size_t kLength = 2 /*version, blocks*/ + 2 /*reserved*/;

  std::uint8_t version = 0;
  std::uint8_t blocks = 0;

  static constexpr auto fields(auto& m) { return std::tie(m.version, m.blocks, gap<2>); }
  [[nodiscard]] constexpr std::size_t block_count() const { return blocks; }
};

/// MON-RF: one band.
struct MonRfBlock {
  static constexpr std::size_t kLength = 4 /*block, antenna*/ + 8 /*self test, reserved*/ +
                                         4 /*noise, gain*/ + 5 /*jamming, imbalance*/ +
                                         3 /*reserved*/;

  std::uint8_t block = 0;           ///< 0 L1, 1 L2 or L5.
  std::uint8_t flags = 0;           ///< b0-1 jamming, as b2-3 of MonHw::flags.
  std::uint8_t antenna_status = 0;  ///< Coded as MonHw::antenna_status.
  std::uint8_t antenna_power = 0;   ///< 1 = on, 2 = unknown.
  std::uint32_t self_test = 0;
  std::uint16_t noise_per_ms = 0;
  std::uint16_t gain_control = 0;      ///< 0..8191.
  std::uint8_t jamming_indicator = 0;  ///< 0 none .. 255 strong, continuous wave.
  std::int8_t offset_i = 0;
  std::uint8_t magnitude_i = 0;
  std::int8_t offset_q = 0;
  std::uint8_t magnitude_q = 0;

  static constexpr auto fields(auto& m) {
    return std::tie(m.block, m.flags, m.antenna_status, m.antenna_power, m.self_test, gap<4>,
                    m.noise_per_ms, m.gain_control, m.jamming_indicator, m.offset_i, m.magnitude_i,
                    m.offset_q, m.magnitude_q, gap<3>);
  }
};

}  // namespace rigwire::protocols::ubx
