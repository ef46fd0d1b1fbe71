// One type of u-blox receiver as data: what it calls itself, what it knows and how it begins. The
// receiver itself is one state machine for all of them.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "emulators/ublox/settings.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// One line of CFG-GNSS.
struct SystemChannels {
  GnssSystem system = GnssSystem::gps;
  std::uint8_t reserved = 0;
  std::uint8_t maximum = 0;
  bool enabled = false;
  std::uint8_t signals = 0x01;  ///< Bits 16..23 of the flags.
};

struct UbloxProfile {
  std::string_view name;      ///< "NEO-7P".
  int generation = 7;         ///< 7, 8, 9.
  int protocol_e2 = 1400;     ///< Protocol version, hundredths.
  std::string_view software;  ///< MON-VER.
  std::string_view hardware;
  std::span<const std::string_view> extensions;
  std::span<const std::string_view> banner;  ///< TXT lines at start.
  /// What CFG-MSG knows, in the order in which one epoch puts it out.
  std::span<const UbloxMessage> messages;
  std::span<const SystemChannels> systems;  ///< CFG-GNSS.
  std::uint8_t channels = 22;
  int radio_paths = 1;  ///< Carrier bands received at once: GPS with Galileo, GLONASS, BeiDou.
  std::uint8_t nmea_version = 0x23;
  bool high_precision = false;      ///< NMEA with 7 decimals of minutes.
  std::size_t cfg_nmea_bytes = 12;  ///< 12 or 20.
  std::size_t pvt_bytes = 84;       ///< NAV-PVT: 84 or 92.
  Duration shortest_period = std::chrono::milliseconds{50};
  bool navigation_ratio = false;  ///< CFG-RATE navRate is honoured.
  bool key_values = false;        ///< CFG-VALSET, VALGET, VALDEL.
  bool carrier_solution = false;  ///< RTK float and fixed are reported.
  std::uint32_t baud = 9600;
  std::uint16_t input_protocols = 0x0007;
  std::uint16_t output_protocols = 0x0003;
};

[[nodiscard]] const UbloxProfile& ublox_neo_7p();
[[nodiscard]] const UbloxProfile& ublox_neo_m8();
[[nodiscard]] const UbloxProfile& ublox_zed_f9p();

}  // namespace rigwire::emulators
