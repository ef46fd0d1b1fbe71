// Settings of the OpenIMU family over J1939: what a client may set, and what it may ask for.
//
// Source: openIMU300-lib and openIMU335RI-lib (open firmware), settings messages. Settings are
// proprietary-B groups FF50..FF5E, which can be moved, broadcast, whose first byte is the address
// of the device meant (reset and save: second byte, after a zero that says "request").
//
// The two devices answer differently. 300RI: the answer's first byte is its own address, the
// filters come back in reverse order, messages are as long as what they say. 335RI: the first byte
// is the address that asked, priorities follow the packet mask, every message has eight bytes
// filled up with AA.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/can/frame.h"
#include "protocols/result.h"

namespace rigwire::protocols::openimu {

// Groups under which an OpenIMU receives its commands and sends its proprietary messages: all are
// FFxx, and a client may move xx (groups FFF0, FFF1, FFF2, "bank" messages: byte 1 the device, then
// one byte per command, in an order that differs between the two devices) to avoid conflicts with
// other nodes.

/// Commands and messages whose group can be moved.
enum class Command : std::uint8_t {
  reset_algorithm,
  save_configuration,
  hardware_status,  ///< 335RI, as the next.
  software_status,
  master_status,
  packet_rate,
  packet_mask,
  filters,
  orientation,
  behaviour,
  trouble_code,        ///< 335RI: what DM1 says.
  magnetic_alignment,  ///< 300RI.
  fine_rate,           ///< 335RI: a data message.
};
inline constexpr std::size_t kCommands = 13;

inline constexpr std::uint32_t kBank0Pgn = 0xFFF0;
inline constexpr std::uint32_t kBank1Pgn = 0xFFF1;
inline constexpr std::uint32_t kBank2Pgn = 0xFFF2;  ///< 335RI.

inline constexpr std::uint8_t kLowestSpecific = 0x40;
inline constexpr std::uint8_t kHighestSpecific300 = 0x6A;
inline constexpr std::uint8_t kHighestSpecific335 = 0x6C;

/// The low byte of each command's group.
using CommandMap = std::array<std::uint8_t, kCommands>;
inline constexpr CommandMap kDeliveredCommands{0x50, 0x51, 0x52, 0x53, 0x54, 0x55, 0x56,
                                               0x57, 0x58, 0x59, 0x5A, 0x5E, 0x6B};

[[nodiscard]] constexpr std::uint32_t pgn_of(const CommandMap& map, Command command) {
  return 0xFF00U | map[static_cast<std::size_t>(command)];
}
/// Returns the command of a group; nullopt if there is none.
[[nodiscard]] std::optional<Command> command_of(const CommandMap& map, std::uint32_t pgn);

/// Returns the commands whose groups the bytes after the address of a bank message set, in their
/// order; further bytes have no meaning. Empty if the device has no such bank.
[[nodiscard]] std::span<const Command> bank_commands(std::uint32_t pgn, bool is_300);

/// Takes a bank message's bytes (those after the address). The 300RI refuses all of them when one
/// is neither 0 (back to delivery) nor 0x40..0x6A; the 335RI takes each that is 0x40..0x6C. Returns
/// whether anything was taken.
bool apply_bank(CommandMap& map, std::uint32_t pgn, std::span<const std::uint8_t> bytes,
                bool is_300);

/// Groups that a client asks for with a J1939 request.
inline constexpr std::uint32_t kSoftwareVersionPgn = 65242;    ///< FEDA; 5 bytes (335RI: 8).
inline constexpr std::uint32_t kEcuIdentificationPgn = 64965;  ///< FDC5; the NAME, 8 bytes.
/// At delivery, as the groups below. 300RI 2 bytes, 335RI those and the application's checksum.
inline constexpr std::uint32_t kStatusPgn = 0xFF54;
inline constexpr std::uint32_t kHardwareStatusPgn = 0xFF52;  ///< 335RI, 2 bytes.
inline constexpr std::uint32_t kSoftwareStatusPgn = 0xFF53;  ///< 335RI, 4 bytes.
/// How an older request for the 300RI's magnetic field names it.
inline constexpr std::uint32_t kMagneticRequestPgn = 0xF06A;
inline constexpr std::uint32_t kActiveTroublePgn = 65226;  ///< FECA, DM1; 335RI.
inline constexpr std::uint32_t kClearTroublePgn = 65235;   ///< FED3, DM11; 335RI.

inline constexpr std::uint32_t kResetAlgorithmPgn = 0xFF50;
inline constexpr std::uint32_t kSaveConfigurationPgn = 0xFF51;
inline constexpr std::uint32_t kPacketRatePgn = 0xFF55;
inline constexpr std::uint32_t kPacketMaskPgn = 0xFF56;
inline constexpr std::uint32_t kFilterPgn = 0xFF57;
inline constexpr std::uint32_t kOrientationPgn = 0xFF58;
inline constexpr std::uint32_t kBehaviourPgn = 0xFF59;
inline constexpr std::uint32_t kTroubleCodePgn = 0xFF5A;        ///< 335RI.
inline constexpr std::uint32_t kMagneticAlignmentPgn = 0xFF5E;  ///< 300RI.

/// Vehicle messages that aid the 335RI's algorithm.
inline constexpr std::uint32_t kTransmissionPgn = 61445;  ///< F005, ETC2.
inline constexpr std::uint32_t kWheelSpeedPgn = 65215;    ///< FEBF, EBC2.
inline constexpr std::uint32_t kVehicleSpeedPgn = 65265;  ///< FEF1, CCVS.

/// Priority of the device's settings answers.
inline constexpr std::uint8_t kSettingsPriority = 6;

/// Bits of the master status word.
struct StatusBit {
  static constexpr std::uint16_t kMaster = 1U << 0U;
  static constexpr std::uint16_t kHardware = 1U << 1U;
  static constexpr std::uint16_t kSensor = 1U << 3U;
  static constexpr std::uint16_t kMemory = 1U << 7U;  ///< What was saved could not be read.
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
  static constexpr std::uint16_t kMagneticField = 8;                            ///< 300RI.
  static constexpr std::uint16_t kFineRate = 8;                                 ///< 335RI.
  static constexpr std::uint16_t kSlope1 = 0x20;                                ///< 335RI.
  static constexpr std::uint16_t kAll = kSlope | kAngularRate | kAcceleration;  ///< At delivery.
  static constexpr std::uint16_t kOf300 = kAll | kMagneticField;
  static constexpr std::uint16_t kOf335 = kAll | kFineRate | kSlope1;
};

/// The device's internal tick; one packet goes out every 2 * divider ticks.
inline constexpr unsigned kTicksPerSecond = 200;
/// Legal packet-rate dividers: off, 100, 50, 25, 20, 10, 5, 4, 2 Hz.
inline constexpr std::array<std::uint8_t, 9> kRateDividers{0, 1, 2, 4, 5, 10, 20, 25, 50};
/// Legal low-pass cut-offs in Hz; 0 is off.
inline constexpr std::array<std::uint8_t, 7> kCutOffs_hz{0, 2, 5, 10, 25, 40, 50};

[[nodiscard]] bool is_rate_divider(std::uint8_t divider);
[[nodiscard]] bool is_cut_off(std::uint8_t cut_off_hz);

/// Commands that are settings:
///   reset_algorithm, save_configuration   first: 0, or 2 to restart the device after it (335RI)
///   packet_rate          first: divider
///   packet_mask          word: mask; first, second: priorities and which of them are meant, two
///   bits
///                        each for angular rate, acceleration, slope from bit 0 (335RI)
///   filters              first: rate cut-off, second: acceleration cut-off, Hz
///   orientation          word: one of the 24 codes (not checked here)
///   behaviour            word: the bits (300RI), the bits to set (335RI); more: the bits to clear,
///                        low byte first, and a new address (335RI)
///   trouble_code         more: lamps, flashing, SPN low byte first, two failure modes
///   magnetic_alignment   first: command
using SettingKind = Command;

/// One settings message, either direction.
struct Setting {
  SettingKind kind = SettingKind::packet_rate;
  std::uint8_t address = 0;  ///< Destination when set, own address when answered.
  std::uint8_t first = 0;
  std::uint8_t second = 0;
  std::uint16_t word = 0;
  std::array<std::uint8_t, 7> more{};

  friend bool operator==(const Setting&, const Setting&) = default;
};

/// The kind that belongs to a group; nothing when the group is no setting.
[[nodiscard]] std::optional<SettingKind> setting_kind(std::uint32_t pgn,
                                                      const CommandMap& map = kDeliveredCommands);
/// Precondition: the kind is one of the above.
[[nodiscard]] std::uint32_t setting_pgn(SettingKind kind,
                                        const CommandMap& map = kDeliveredCommands);

/// What a client sends.
[[nodiscard]] can::Frame make_setting(const Setting& setting, std::uint8_t source,
                                      const CommandMap& map = kDeliveredCommands);
/// Malformed when the group is no setting, the message too short, or a reset or save is not marked
/// as a request.
[[nodiscard]] Decoded<Setting> decode_setting(const can::Frame& frame,
                                              const CommandMap& map = kDeliveredCommands);

/// The 300RI's answer to a request for a setting.
[[nodiscard]] can::Frame make_setting_answer_300(const Setting& setting, std::uint8_t source,
                                                 const CommandMap& map = kDeliveredCommands);
/// The 335RI's. Of a packet mask `first` are the priorities in force.
[[nodiscard]] can::Frame make_setting_answer_335(const Setting& setting, std::uint8_t source,
                                                 std::uint8_t requester,
                                                 const CommandMap& map = kDeliveredCommands);

/// The answer to reset and save: 1, the requester, 0 failed or 1 done.
[[nodiscard]] can::Frame make_outcome(SettingKind kind, std::uint8_t source, std::uint8_t requester,
                                      bool done, const CommandMap& map = kDeliveredCommands);

/// State of the magnetic alignment (300RI): command that it answers, state, hard iron along x and y
/// (1/256 G, -8 G, 12 bits each), soft-iron ratio (1/1024, 10 bits) and angle (14 bits, pi / 2048
/// rad, -pi).
struct MagneticAlignment {
  std::uint8_t command = 0;
  std::uint8_t state = 0;
  double hard_iron_x_gauss = 0.0;
  double hard_iron_y_gauss = 0.0;
  double soft_iron_ratio = 0.0;
  double soft_iron_angle_rad = 0.0;
};
[[nodiscard]] can::Frame make_alignment_answer(const MagneticAlignment& alignment,
                                               std::uint8_t source,
                                               const CommandMap& map = kDeliveredCommands);

/// Returns the frame filled up to eight bytes, as the 335RI sends it.
[[nodiscard]] can::Frame filled_up(can::Frame frame);

}  // namespace rigwire::protocols::openimu
