// Settings of an OpenIMU: those at power-on and those that a client changes over the bus.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/supply.h"
#include "fields/rules.h"
#include "protocols/openimu/axes.h"
#include "protocols/openimu/messages.h"
#include "protocols/openimu/settings.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

enum class OpenImuVariant : std::uint8_t {
  openimu300ri,  ///< Figures of merit always "not available", latency 0, claim repeated each
                 ///< second, magnetic field.
  openimu335ri,  ///< Figures of merit by state, latency sent, trouble codes, every message of 8
                 ///< bytes.
};

/// Behaviour bits that change something in this device; the others keep their default.
inline constexpr std::uint16_t kChangeableBehaviour =
    protocols::openimu::Behaviour::kSwapPitchRoll | protocols::openimu::Behaviour::kNorthWestUp |
    protocols::openimu::Behaviour::kSwapRequestPgn | protocols::openimu::Behaviour::kRunAlgorithm;

/// The messages that a variant can send.
[[nodiscard]] constexpr std::uint16_t packets_of(OpenImuVariant variant) {
  return variant == OpenImuVariant::openimu300ri ? protocols::openimu::PacketBit::kOf300
                                                 : protocols::openimu::PacketBit::kOf335;
}

/// What DM1 says besides the occurrences (335RI, group FF5A). At delivery: lamps off, flashing and
/// parameter "not available".
struct TroubleCode {
  std::uint8_t lamps = 0x00;
  std::uint8_t flashing = 0xFF;
  std::uint32_t parameter = 0x7FFFF;  ///< SPN, 19 bits.
  std::uint8_t first_failure = 31;    ///< FMI of the supply; there is no such trouble here.
  std::uint8_t second_failure = 31;   ///< FMI of the elements; FF: not sent.

  friend bool operator==(const TroubleCode&, const TroubleCode&) = default;
};

/// What a client can change over the bus.
struct OpenImuConfiguration {
  std::uint16_t packet_mask = protocols::openimu::PacketBit::kAll;
  std::uint8_t rate_divider = 1;      ///< One of kRateDividers: 0 off, 1 100 Hz, 2 50 Hz ...
  std::uint8_t rate_cut_off_hz = 25;  ///< One of kCutOffs_hz; 0 off.
  std::uint8_t acceleration_cut_off_hz = 25;
  std::uint16_t orientation = 0x0000;  ///< One of the 24 codes.
  std::uint16_t behaviour = protocols::openimu::Behaviour::kDefault;
  std::uint8_t rate_priority = protocols::openimu::kAngularRatePriority;  ///< 335RI, 0..3, as next.
  std::uint8_t acceleration_priority = protocols::openimu::kAccelerationPriority;
  std::uint8_t slope_priority = protocols::openimu::kSlopePriority;
  protocols::openimu::CommandMap commands = protocols::openimu::kDeliveredCommands;
  TroubleCode trouble;

  friend bool operator==(const OpenImuConfiguration&, const OpenImuConfiguration&) = default;
};

struct OpenImuSettings {
  OpenImuVariant variant = OpenImuVariant::openimu335ri;
  std::uint8_t source_address = 0x80;  ///< Preferred; 128 .. 247.
  std::uint32_t serial = 1;            ///< Low 21 bits go into the NAME; unique on a bus.
  OpenImuConfiguration configuration;
  /// Range of the gyros; it decides the figure of merit.
  double rate_range_radps = 400.0 * 3.14159265358979323846 / 180.0;
  double acceleration_range_mps2 = 8.0 * 9.80665;
  std::array<std::uint8_t, 5> software_version{1, 1, 0, 0,
                                               0};  ///< major, minor, patch, stage, build
  SupplySettings supply;                            ///< The first tick is at power-on.
  Duration processing_delay =
      std::chrono::milliseconds{1};  ///< From a tick or request to the frame.
};

/// Without the message priorities, the behaviour and what else only a client sets.
void visit(fields::Visitor& v, OpenImuSettings& p);
/// Throws std::invalid_argument with the value found and what is allowed.
void validate(const OpenImuSettings& settings);

/// What "save" writes down, and an address won in contention.
struct OpenImuMemory {
  std::uint8_t address = 0;
  OpenImuConfiguration configuration;

  friend bool operator==(const OpenImuMemory&, const OpenImuMemory&) = default;
};
[[nodiscard]] std::vector<std::uint8_t> sealed(const OpenImuMemory& memory);
/// Nothing when the block is not one of sealed(), or holds values that the variant does not have.
[[nodiscard]] std::optional<OpenImuMemory> unsealed(std::span<const std::uint8_t> block,
                                                    OpenImuVariant variant);

}  // namespace rigwire::emulators
