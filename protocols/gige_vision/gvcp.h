// GigE Vision control protocol (GVCP): commands of an application and acknowledges of a device,
// each one UDP datagram, device port 3956. All integers are most significant byte first.
//
//   command:      key 0x42 (1), flags (1), command (2), length (2), request (2), payload
//   acknowledge:  status (2), acknowledge (2), length (2), request (2), payload
//
//   command       code    payload                                    acknowledge's payload
//   DISCOVERY     0x0002  none                                       bootstrap registers 0 .. 0xF7
//   FORCEIP       0x0004  2 0, MAC (6), 12 0, IP (4), 12 0,          none
//                         mask (4), 12 0, gateway (4)
//   PACKETRESEND  0x0040  channel (2), block (2), 0 first (4),       none; the packets are the
//   answer
//                         0 last (4); with 64-bit identifiers:
//                         channel (2), 0 (2), first (4), last (4),
//                         block (8)
//   READREG       0x0080  1 .. 135 addresses (4)                     as many values (4)
//   WRITEREG      0x0082  1 .. 67 pairs of address (4), value (4)    0 (2), number written (2)
//   READMEM       0x0084  address (4), 0 (2), count (2)              address (4), bytes
//   WRITEMEM      0x0086  address (4), bytes                         0 (2), number of bytes (2)
//   PENDING               sent by a device that needs longer:        0x0089: 0 (2), milliseconds
//   (2)
//
// The acknowledge's code is the command's plus one. A packet with its IP and UDP headers has at
// most 576 bytes, hence 536 bytes of memory. Memory is read and written in whole words.
//
// Worked example: Aravis asks for control (CCP := 2) with its request 0xFF15:
//   42 01 00 82 00 08 FF 15 00 00 0A 00 00 00 00 02
// and the device answers: 00 00 00 83 00 04 FF 15 00 00 00 01
//
// Sources: Aravis 0.8.26 (src/arvgvcp.c, src/arvgvcpprivate.h), Wireshark 4.0 (packet-gvcp.c).
// Events and actions are not here: they need a message channel or a group key, which the devices of
// this project do not offer.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "protocols/bytes.h"
#include "protocols/gige_vision/status.h"
#include "protocols/result.h"

namespace rigwire::protocols::gige_vision {

inline constexpr std::uint16_t kGvcpPort = 3956;
inline constexpr std::uint8_t kCommandKey = 0x42;
inline constexpr std::size_t kGvcpHeaderSize = 2 + 2 + 2 + 2;  // key and flags, command, length, id
inline constexpr std::size_t kIpUdpHeaders = 20 + 8;
inline constexpr std::size_t kGvcpSizeMaximum = 576 - kIpUdpHeaders;
inline constexpr std::size_t kGvcpPayloadMaximum = kGvcpSizeMaximum - kGvcpHeaderSize;
inline constexpr std::size_t kMemoryMaximum = kGvcpPayloadMaximum - 4;  // an address
inline constexpr std::size_t kReadRegistersMaximum = kGvcpPayloadMaximum / 4;
inline constexpr std::size_t kWriteRegistersMaximum = kGvcpPayloadMaximum / 8;
static_assert(kGvcpSizeMaximum == 548 && kMemoryMaximum == 536 && kReadRegistersMaximum == 135 &&
              kWriteRegistersMaximum == 67);

enum class CommandCode : std::uint16_t {
  discovery = 0x0002,
  force_ip = 0x0004,
  packet_resend = 0x0040,
  read_registers = 0x0080,
  write_registers = 0x0082,
  read_memory = 0x0084,
  write_memory = 0x0086,
};
/// The code in the acknowledge of a command, whether known or not.
[[nodiscard]] constexpr std::uint16_t acknowledge_code(std::uint16_t command) {
  return static_cast<std::uint16_t>(command + 1);
}
inline constexpr std::uint16_t kPendingAcknowledge = 0x0089;

struct CommandFlag {
  static constexpr std::uint8_t kAcknowledge = 0x01;  ///< The device shall answer.
  static constexpr std::uint8_t kBroadcastAnswer =
      0x10;                                           ///< DISCOVERY: it may answer by broadcast.
  static constexpr std::uint8_t kExtendedIds = 0x10;  ///< PACKETRESEND: 64-bit identifiers.
};

using MacAddress = std::array<std::uint8_t, 6>;

// --- Commands. Views refer to the datagram that they were read from. ---

struct Discovery {
  bool broadcast_answer = false;
};
struct ForceIp {
  MacAddress mac{};           ///< Address of the device that is meant.
  std::uint32_t address = 0;  ///< 0: the device chooses an address by its configuration.
  std::uint32_t mask = 0;
  std::uint32_t gateway = 0;
};
struct PacketResend {
  /// Value of `last`: all to the end, with short identifiers.
  static constexpr std::uint32_t kToTheEnd = 0x00FF'FFFF;
  static constexpr std::uint32_t kToTheEndExtended = 0xFFFF'FFFF;

  std::uint16_t channel = 0;
  bool extended_ids = false;
  std::uint64_t block = 0;
  std::uint32_t first = 0;
  std::uint32_t last = 0;
};

/// Words of a payload.
class WordView {
 public:
  WordView() = default;
  explicit WordView(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
    assert(bytes.size() % 4 == 0);
  }
  [[nodiscard]] std::size_t size() const { return bytes_.size() / 4; }
  [[nodiscard]] std::uint32_t operator[](std::size_t index) const {
    return load_big<std::uint32_t>(bytes_, 4 * index);
  }

 private:
  std::span<const std::uint8_t> bytes_;
};

struct ReadRegisters {
  WordView addresses;
};
struct WriteRegisters {
  WordView words;  ///< Address, value, address, value, ...

  [[nodiscard]] std::size_t size() const { return words.size() / 2; }
  [[nodiscard]] std::uint32_t address(std::size_t index) const { return words[2 * index]; }
  [[nodiscard]] std::uint32_t value(std::size_t index) const { return words[2 * index + 1]; }
};
struct ReadMemory {
  std::uint32_t address = 0;
  std::uint16_t count = 0;
};
struct WriteMemory {
  std::uint32_t address = 0;
  std::span<const std::uint8_t> bytes;
};

using Command = std::variant<Discovery, ForceIp, PacketResend, ReadRegisters, WriteRegisters,
                             ReadMemory, WriteMemory>;

/// A command's header with its payload, not looked into.
struct CommandPacket {
  std::uint8_t flags = 0;
  std::uint16_t command = 0;  ///< A CommandCode, or one that is not known here.
  std::uint16_t request = 0;
  std::span<const std::uint8_t> payload;

  [[nodiscard]] bool wants_acknowledge() const { return (flags & CommandFlag::kAcknowledge) != 0; }
};

/// A datagram that reached port 3956. Malformed: no command (key), bytes beyond its length, or the
/// request 0, which the protocol reserves.
[[nodiscard]] Decoded<CommandPacket> decode_command(std::span<const std::uint8_t> datagram);

/// Returns the header of a datagram that decode_command() does not take, without payload: enough to
/// refuse it. Empty where it is not recognisable as a command.
[[nodiscard]] std::optional<CommandPacket> peek_header(std::span<const std::uint8_t> datagram);

/// The command, or how a device has to refuse it: not_implemented (code), invalid_header (a length
/// that the command cannot have), bad_alignment, invalid_parameter. Whether addresses exist and who
/// may write them only the device knows.
[[nodiscard]] std::variant<Command, Status> interpret(const CommandPacket& packet);

/// A datagram of the control protocol.
class GvcpPacket {
 public:
  [[nodiscard]] std::span<const std::uint8_t> view() const {
    return std::span(bytes_).first(size_);
  }

  /// Precondition for all: there is room, which each encoder below sees to.
  void half(std::uint16_t value) { integer(value); }
  void word(std::uint32_t value) { integer(value); }
  void append(std::span<const std::uint8_t> bytes);
  /// Room for `count` bytes that the caller fills.
  [[nodiscard]] std::span<std::uint8_t> extend(std::size_t count);
  /// The length field of the header; to be called when the payload is complete.
  void finish();

 private:
  template <class Integer>
  void integer(Integer value) {
    store_big(std::span(bytes_), size_, value);
    size_ += sizeof(Integer);
  }

  std::array<std::uint8_t, kGvcpSizeMaximum> bytes_{};
  std::size_t size_ = 0;
};

// --- Encoders of an application. ---

[[nodiscard]] GvcpPacket encode_discovery(std::uint16_t request, bool broadcast_answer = false);
[[nodiscard]] GvcpPacket encode_force_ip(std::uint16_t request, const ForceIp& command);
[[nodiscard]] GvcpPacket encode_packet_resend(std::uint16_t request, const PacketResend& command);
/// Precondition: 1 .. 135 addresses.
[[nodiscard]] GvcpPacket encode_read_registers(std::uint16_t request,
                                               std::span<const std::uint32_t> addresses);
struct RegisterValue {
  std::uint32_t address = 0;
  std::uint32_t value = 0;
};
/// Precondition: 1 .. 67 pairs.
[[nodiscard]] GvcpPacket encode_write_registers(std::uint16_t request,
                                                std::span<const RegisterValue> registers);
[[nodiscard]] GvcpPacket encode_read_memory(std::uint16_t request, std::uint32_t address,
                                            std::uint16_t count);
/// Precondition: at most 536 bytes.
[[nodiscard]] GvcpPacket encode_write_memory(std::uint16_t request, std::uint32_t address,
                                             std::span<const std::uint8_t> bytes);

// --- Acknowledges. ---

/// Returns an acknowledge to be filled by the caller, which then calls finish().
[[nodiscard]] GvcpPacket begin_acknowledge(Status status, std::uint16_t acknowledge,
                                           std::uint16_t request);
/// Returns an acknowledge without payload.
[[nodiscard]] GvcpPacket encode_acknowledge(Status status, std::uint16_t acknowledge,
                                            std::uint16_t request);
/// Encodes the acknowledge of WRITEREG or WRITEMEM; `written`: number of registers or bytes
/// written.
[[nodiscard]] GvcpPacket encode_written(Status status, CommandCode command, std::uint16_t request,
                                        std::uint16_t written);
/// Encodes PENDING_ACK: the command takes up to `milliseconds`.
[[nodiscard]] GvcpPacket encode_pending(std::uint16_t request, std::uint16_t milliseconds);

struct Acknowledge {
  Status status = Status::success;
  std::uint16_t acknowledge = 0;
  std::uint16_t request = 0;
  std::span<const std::uint8_t> payload;
};
[[nodiscard]] Decoded<Acknowledge> decode_acknowledge(std::span<const std::uint8_t> datagram);

/// Values of READREG. Malformed when the payload is of no whole words.
[[nodiscard]] Decoded<WordView> decode_register_values(const Acknowledge& acknowledge);
struct MemoryContent {
  std::uint32_t address = 0;
  std::span<const std::uint8_t> bytes;
};
[[nodiscard]] Decoded<MemoryContent> decode_memory(const Acknowledge& acknowledge);
/// Returns the number written (WRITEREG, WRITEMEM) or the milliseconds (PENDING).
[[nodiscard]] Decoded<std::uint16_t> decode_count(const Acknowledge& acknowledge);

}  // namespace rigwire::protocols::gige_vision
