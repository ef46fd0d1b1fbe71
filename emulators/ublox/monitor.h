// What an emulated u-blox receiver says about itself: its port, its buffers, its radio part, its
// chip, its memory, its time marks (classes MON, TIM, SEC and LOG, and AID-INI).
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, sections 32.14.5 "UBX-LOG-INFO", 32.16
// "UBX-MON", 32.19 "UBX-SEC" and 32.20 "UBX-TIM"; SEC-SIG, see signal_security.h.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "emulators/ublox/configuration.h"
#include "emulators/ublox/navigation_messages.h"
#include "emulators/ublox/signal_security.h"
#include "emulators/ublox/solution.h"
#include "emulators/ublox/transmitter.h"
#include "protocols/ubx/frame.h"

namespace rigwire::emulators {

/// What the antenna supervisor reports: R28 section 14.1.
struct UbloxAntenna {
  std::uint8_t status = 2;  ///< MON-HW aStatus: 1 unknown, 2 OK, 3 short, 4 open.
  std::uint8_t power = 1;   ///< MON-HW aPower: 0 off, 1 on, 2 unknown.
  std::string_view text = "ANTSTATUS=OK";

  friend bool operator==(const UbloxAntenna&, const UbloxAntenna&) = default;
};

/// A NEO-7P detects shorts and switches the supply off; open circuits only when CFG-ANT says so. A
/// receiver that looks for neither (a ZED-F9P as delivered) does not know.
[[nodiscard]] UbloxAntenna supervise(AntennaState state, const protocols::ubx::CfgAnt& settings);

/// What came in on the UART since power-on or reset.
struct UbloxPortStatistics {
  std::uint32_t bytes = 0;
  std::array<std::uint16_t, 8> messages{};  ///< By protocol: 0 UBX, 1 NMEA.
  std::uint32_t skipped = 0;                ///< Bytes that belong to no message.
  std::uint16_t framing_errors = 0;
  std::size_t peak_bytes = 0;  ///< Most that waited to be parsed.
  bool overflow = false;       ///< A message was lost since MON-TXBUF was last sent.
};

/// Edges on the external interrupt pin.
struct UbloxTimeMark {
  bool fresh = false;  ///< Since the last epoch.
  std::uint16_t count = 0;
  bool rose = false;  ///< What `fresh` was about.
  bool fell = false;
  GpsTime rising;
  GpsTime falling;
};

/// Input of all messages of this file.
struct UbloxMonitorView {
  const UbloxSolution& solution;
  const UbloxConfiguration& configuration;
  const UbloxTransmitter& transmitter;
  const UbloxPortStatistics& port;
  const UbloxAntenna& antenna;
  const UbloxTimeMark& mark;
  const UbloxSignalSecurity& security;
  /// The second UART; null where the type has none.
  const UbloxTransmitter* second_line = nullptr;
  const UbloxPortStatistics* second_port = nullptr;
  std::size_t receive_capacity = 0;
  std::uint64_t seed = 0;  ///< Seed of this device.
  std::uint64_t epoch = 0;
};

/// Writes the UBX frame of MON-IO, MSGPP, RXBUF, TXBUF, HW, HW2, RXR, RF, COMMS, GNSS, PATCH,
/// TIM-TP, TIM-TM2, AID-INI, LOG-INFO, SEC-SIG, SEC-SIGLOG or SEC-UNIQID and returns its size; 0
/// when it is none of them. Precondition: out.size() >= kLongestNavigationFrame.
[[nodiscard]] std::size_t encode_monitor(const UbloxMonitorView& view, protocols::ubx::MessageId id,
                                         std::span<std::uint8_t> out);

}  // namespace rigwire::emulators
