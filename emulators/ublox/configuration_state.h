// What an emulated u-blox receiver is configured to: one value of every CFG message, and how the
// sections of CFG-CFG divide it.
//
// Source: u-blox M8 receiver description, UBX-13003221 R28, section 3 "Receiver configuration" and
// 32.10.3 "UBX-CFG-CFG"; defaults from a complete poll of a NEO-7P, those of CFG-PM2 from the
// description only.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "emulators/ublox/profile.h"
#include "emulators/ublox/settings.h"
#include "protocols/ubx/configuration.h"

namespace rigwire::emulators {

struct UbloxConfigurationState {
  using Rates = std::array<std::uint8_t, protocols::ubx::kPorts>;

  std::array<protocols::ubx::CfgPrt, 5> ports{};
  std::array<Rates, kMaximumMessages> rates{};  ///< In the order of UbloxProfile::messages.
  std::array<protocols::ubx::CfgInf, 3> information{};
  protocols::ubx::CfgRate rate;
  protocols::ubx::CfgNav5 nav5;
  protocols::ubx::CfgNavx5 navx5;
  protocols::ubx::CfgOdo odometer;
  protocols::ubx::CfgNmea nmea;
  std::array<std::uint8_t, 8> nmea_tail{};  ///< Bytes 12..19 of the longer form of CFG-NMEA.
  protocols::ubx::CfgSbas sbas;
  /// Without its position: CFG-TMODE has ECEF and geodetic ones apart, see base_mode().
  protocols::ubx::CfgTmode3 base;
  std::array<std::int32_t, 3> base_ecef_cm{};
  std::array<std::int8_t, 3> base_ecef_rest{};
  std::array<std::int32_t, 3> base_geodetic{};
  std::array<std::int8_t, 3> base_geodetic_rest{};
  std::uint16_t station_out = 0;       ///< CFG-RTCM-DF003_OUT.
  std::uint16_t station_in = 0;        ///< CFG-RTCM-DF003_IN,
  std::uint8_t station_filter = 0;     ///< and DF003_IN_FILTER.
  std::uint8_t carrier_mode = 3;       ///< CFG-NAVHPG-DGNSSMODE: 2 float, 3 fixed, 5 conservative.
  std::uint8_t jamming_sensitive = 1;  ///< CFG-SEC-JAMDET_SENSITIVITY_HI.
  protocols::ubx::CfgAnt antenna;
  protocols::ubx::CfgRxm power;
  std::array<protocols::ubx::CfgTp5, 2> pulses{};
  protocols::ubx::CfgGnssHead gnss;
  std::array<protocols::ubx::CfgGnssBlock, kMaximumSystems> systems{};  ///< gnss.blocks of them.
  // Kept as the bytes of their payload: nothing here acts on them.
  std::array<std::uint8_t, 52> datum{};
  std::array<std::uint8_t, 44> power_management{};      ///< CFG-PM2.
  std::array<std::uint8_t, 108> usb{};                  ///< CFG-USB.
  std::array<std::uint8_t, 8> interference{};           ///< CFG-ITFM.
  std::array<std::uint8_t, 12> log_filter{};            ///< CFG-LOGFILTER.
  std::array<std::uint8_t, 1 + 30> remote_inventory{};  ///< CFG-RINV: flags and text.
  std::size_t remote_inventory_bytes = 1;
};

/// CFG messages that are kept as bytes.
inline constexpr protocols::ubx::MessageId kCfgDat{0x06, 0x06};
inline constexpr protocols::ubx::MessageId kCfgUsb{0x06, 0x1B};
inline constexpr protocols::ubx::MessageId kCfgRinv{0x06, 0x34};
inline constexpr protocols::ubx::MessageId kCfgItfm{0x06, 0x39};
inline constexpr protocols::ubx::MessageId kCfgPm2{0x06, 0x3B};
inline constexpr protocols::ubx::MessageId kCfgLogfilter{0x06, 0x47};

/// Sections of CFG-CFG.
inline constexpr std::uint32_t kSectionIoPort = 0x0001;
inline constexpr std::uint32_t kSectionMessages = 0x0002;
inline constexpr std::uint32_t kSectionInformation = 0x0004;
inline constexpr std::uint32_t kSectionNavigation = 0x0008;
inline constexpr std::uint32_t kSectionReceiver = 0x0010;
inline constexpr std::uint32_t kSectionInventory = 0x0200;
inline constexpr std::uint32_t kSectionAntenna = 0x0400;
inline constexpr std::uint32_t kSectionLogging = 0x0800;

/// What both ways of writing it must respect: the UART has 8N1 and a speed that the type has ...
[[nodiscard]] bool line_is_sound(const UbloxProfile& profile, const protocols::ubx::CfgPrt& uart);
/// ... and one of the systems that are on gives a position without another one.
[[nodiscard]] bool has_major_system(std::span<const protocols::ubx::CfgGnssBlock> systems);

/// The state of a receiver of that type with nothing saved. Precondition: validate(settings).
[[nodiscard]] UbloxConfigurationState default_state(const UbloxSettings& settings);

/// CFG-TMODE3 as it is in force: with the position of the kind that its flags name.
[[nodiscard]] protocols::ubx::CfgTmode3 base_mode(const UbloxConfigurationState& state);
void set_base_mode(UbloxConfigurationState& state, const protocols::ubx::CfgTmode3& wanted);

/// Masks and reserved bytes of CFG-NAVX5 from version 2 on.
void set_modern_expert(protocols::ubx::CfgNavx5& expert);

/// Copies the sections of `mask`.
void copy_sections(const UbloxConfigurationState& from, UbloxConfigurationState& to,
                   std::uint32_t mask);

}  // namespace rigwire::emulators
