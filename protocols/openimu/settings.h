// Settings of the OpenIMU family over J1939: what a client may set, and what it may ask for.
//
// Source: openIMU300-lib and openIMU335RI-lib (open firmware), settings messages. Settings are
// proprietary-B groups FF50..FF5E, broadcast, whose first byte is the address of the device meant
// (reset and save: second byte, after a zero that says "request").
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::openimu {

/// Groups that a client asks for with a J1939 request.
inline constexpr std::uint32_t kSoftwareVersionPgn = 65242;    ///< FEDA; 5 bytes (335RI: 8).
inline constexpr std::uint32_t kEcuIdentificationPgn = 64965;  ///< FDC5; the NAME, 8 bytes.
inline constexpr std::uint32_t kStatusPgn = 0xFF54;            ///< 2 bytes, see StatusBit.

inline constexpr std::uint32_t kResetAlgorithmPgn = 0xFF50;
inline constexpr std::uint32_t kSaveConfigurationPgn = 0xFF51;
inline constexpr std::uint32_t kPacketRatePgn = 0xFF55;
inline constexpr std::uint32_t kPacketMaskPgn = 0xFF56;
inline constexpr std::uint32_t kFilterPgn = 0xFF57;
inline constexpr std::uint32_t kOrientationPgn = 0xFF58;
inline constexpr std::uint32_t kBehaviourPgn = 0xFF59;

/// Priority of the device's settings answers.
inline constexpr std::uint8_t kSettingsPriority = 6;

/// Bits of the master status word.
struct StatusBit {
  static constexpr std::uint16_t kMaster = 1U << 0U;
  static constexpr std::uint16_t kSensor = 1U << 3U;
  static constexpr std::uint16_t kAlgorithmInitialising = 1U << 8U;
  static constexpr std::uint16_t kHighGain = 1U << 9U;
  static constexpr std::uint16_t kAttitudeOnly = 1U << 10U;
  static constexpr std::uint16_t kOverRange = 1U << 12U;
};

/// Bits of the packet mask.
struct PacketBit {
  static constexpr std::uint16_t kSlope = 1;
  static constexpr std::uint16_t kAngularRate = 2;
  static constexpr std::uint16_t kAcceleration = 4;
  static constexpr std::uint16_t kAll = kSlope | kAngularRate | kAcceleration;
};

/// The device's internal tick; one packet goes out every 2 * divider ticks.
inline constexpr unsigned kTicksPerSecond = 200;
/// Legal packet-rate dividers: off, 100, 50, 25, 20, 10, 5, 4, 2 Hz.
inline constexpr std::array<std::uint8_t, 9> kRateDividers{0, 1, 2, 4, 5, 10, 20, 25, 50};
/// Legal low-pass cut-offs in Hz; 0 is off.
inline constexpr std::array<std::uint8_t, 7> kCutOffs_hz{0, 2, 5, 10, 25, 40, 50};

[[nodiscard]] bool is_rate_divider(std::uint8_t divider);
[[nodiscard]] bool is_cut_off(std::uint8_t cut_off_hz);

enum class SettingKind : std::uint8_t {
  reset_algorithm,
  save_configuration,
  packet_rate,  ///< first: divider.
  packet_mask,  ///< word: mask.
  filters,      ///< first: rate cut-off, second: acceleration cut-off, Hz.
  orientation,  ///< word: one of the 24 codes (not checked here).
  behaviour,    ///< word.
};

/// One settings message, either direction.
struct Setting {
  SettingKind kind = SettingKind::packet_rate;
  std::uint8_t address = 0;  ///< Destination when set, own address when answered.
  std::uint8_t first = 0;
  std::uint8_t second = 0;
  std::uint16_t word = 0;

  friend bool operator==(const Setting&, const Setting&) = default;
};

/// The kind that belongs to a group; nothing when the group is no setting known here.
[[nodiscard]] std::optional<SettingKind> setting_kind(std::uint32_t pgn);
[[nodiscard]] std::uint32_t setting_pgn(SettingKind kind);

/// What a client sends. Extra bytes of the packet mask (priorities of the 335RI) are not looked at.
[[nodiscard]] can::Frame make_setting(const Setting& setting, std::uint8_t source);
/// Malformed when the group is no setting, the message too short, or a reset or save is not marked
/// as a request.
[[nodiscard]] Decoded<Setting> decode_setting(const can::Frame& frame);

/// The answer to a request for a setting: own address, then the values. Filters are answered in the
/// order acceleration, rate, the reverse of how they are set: the firmware does that.
[[nodiscard]] can::Frame make_setting_answer(const Setting& setting, std::uint8_t source);

/// The answer to reset and save: 1, who asked, 0 failed or 1 done.
[[nodiscard]] can::Frame make_outcome(SettingKind kind, std::uint8_t source, std::uint8_t requester,
                                      bool done);

}  // namespace rigwire::protocols::openimu
