// One type of u-blox receiver as data: what it calls itself, what it knows and how it begins. The
// receiver itself is one state machine for all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocols/ubx/frame.h"
#include "sim/samples/gnss_sample.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

struct UbloxConfigurationState;

/// A message that a type of receiver has, and by what it comes. What a type does not list, it
/// neither sends nor answers.
struct UbloxMessage {
  protocols::ubx::MessageId id;
  std::string_view name;           ///< "RMC", "NAV-SOL"; empty when it is known but not produced.
  std::size_t greatest_bytes = 0;  ///< On the line; 0 when it is not produced.
  bool sentence = false;           ///< NMEA.
  bool periodic = true;            ///< CFG-MSG knows it: every so many epochs, or with its event.
  bool polled = true;              ///< A poll is answered.
  bool rtcm = false;               ///< RTCM 3.
};

/// One line of CFG-GNSS.
struct SystemChannels {
  GnssSystem system = GnssSystem::gps;
  std::uint8_t reserved = 0;
  std::uint8_t maximum = 0;
  bool enabled = false;
  std::uint8_t signals = 0x01;  ///< Bits 16..23 of the flags.
};

/// What the radio part of an undisturbed receiver reports.
struct UbloxFrontEnd {
  double noise_per_ms = 104.0;
  double gain_control = 4745.0;
  std::uint8_t jamming_floor = 7;  ///< Lowest jamming indicator.
  std::uint8_t jamming_span = 1;   ///< So far it wanders above that, from epoch to epoch.
};

struct UbloxProfile {
  std::string_view name;      ///< "NEO-7P".
  int generation = 7;         ///< 7, 8, 9; from 8 on messages have their newer form.
  int protocol_e2 = 1400;     ///< Protocol version, hundredths.
  std::string_view software;  ///< MON-VER.
  std::string_view hardware;
  std::span<const std::string_view> extensions;
  std::span<const std::string_view> banner;  ///< TXT lines at start.
  /// In the order in which one epoch puts them out.
  std::span<const UbloxMessage> messages;
  std::span<const SystemChannels> systems;  ///< CFG-GNSS, at most kMaximumSystems.
  std::uint8_t channels = 22;
  int radio_paths = 1;  ///< Carrier bands received at once: GPS with Galileo, GLONASS, BeiDou.
  std::uint8_t nmea_version = 0x23;
  std::span<const std::uint8_t> nmea_versions;  ///< Those that CFG-NMEA accepts.
  bool high_precision = false;                  ///< NMEA with 7 decimals of minutes.
  std::size_t cfg_nmea_bytes = 12;              ///< 12 or 20.
  Duration shortest_period = std::chrono::milliseconds{50};
  bool navigation_ratio = false;  ///< CFG-RATE navRate is honoured.
  bool carrier_solution = false;  ///< RTK float and fixed are reported.
  bool odometer = false;          ///< CFG-ODO, NAV-RESETODO.
  bool power_modes = false;       ///< CFG-PMS; full power alone is accepted.
  bool key_items = false;         ///< CFG-VALSET, VALGET, VALDEL.
  bool logger = false;            ///< LOG-CREATE and others are refused, not ignored.
  std::uint32_t baud = 9600;
  std::uint32_t greatest_baud = 460'800;
  std::uint16_t input_protocols = 0x0007;
  std::uint16_t output_protocols = 0x0003;
  std::uint8_t chip_generation = 3;        ///< NAV-SVINFO globalFlags: 3 = u-blox 7, 4 = u-blox 8.
  std::uint8_t status_flags = 0xD0;        ///< Undocumented upper bits of NAV-SOL and NAV-STATUS.
  std::int32_t first_week = 1691;          ///< Week of the firmware: wknRollover.
  std::int32_t default_leap_seconds = 16;  ///< Value in the firmware, used until received.
  UbloxFrontEnd front_end{};

  /// What other defaults of the type differ from those of a NEO-7P; may be null.
  void (*adjust_defaults)(UbloxConfigurationState& state) = nullptr;
};

inline constexpr std::size_t kMaximumSystems = 8;
inline constexpr std::size_t kMaximumMessages = 128;

/// Index in profile.messages; its size when unknown.
[[nodiscard]] std::size_t message_index(const UbloxProfile& profile, protocols::ubx::MessageId id);
[[nodiscard]] std::size_t message_index(const UbloxProfile& profile, std::string_view name);

/// The message that answers a poll of that id; null when the type has none.
[[nodiscard]] const UbloxMessage* polled_message(const UbloxProfile& profile,
                                                 protocols::ubx::MessageId id);

[[nodiscard]] const UbloxProfile& ublox_neo_7p();
[[nodiscard]] const UbloxProfile& ublox_neo_m8();
[[nodiscard]] const UbloxProfile& ublox_neo_m8t();
[[nodiscard]] const UbloxProfile& ublox_zed_f9p();

}  // namespace rigwire::emulators
