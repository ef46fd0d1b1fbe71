// J1939 messages that every node speaks: request, acknowledgement, address claim; and how any
// single-frame message sits in a CAN frame.
//
// Sources: SAE J1939-21, 5.4.2 (request), 5.4.4 (acknowledgement); J1939-81, 4.2 (address claim),
// 4.6 (commanded address). Messages of more than eight bytes: transport.h.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>

#include "protocols/can/frame.h"
#include "protocols/j1939/identifier.h"
#include "protocols/j1939/name.h"
#include "protocols/result.h"

namespace rigwire::protocols::j1939 {

inline constexpr std::uint32_t kRequestPgn = 59904;          ///< EA00, addressed, 3 bytes.
inline constexpr std::uint32_t kAcknowledgementPgn = 59392;  ///< E800, addressed, 8 bytes.
inline constexpr std::uint32_t kAddressClaimedPgn = 60928;   ///< EE00, to everybody, 8 bytes.
/// FED8, 9 bytes by transport: "NAME, take this address".
inline constexpr std::uint32_t kCommandedAddressPgn = 65240;

/// Priority of request, acknowledgement and claim.
inline constexpr std::uint8_t kManagementPriority = 6;

/// A data frame with 29-bit identifier; payloads longer than 8 bytes are cut.
[[nodiscard]] can::Frame make_frame(const Identifier& identifier,
                                    std::span<const std::uint8_t> payload);

/// The identifier of a frame that can be J1939 (29-bit data frame, length 0..8); nothing otherwise.
[[nodiscard]] std::optional<Identifier> identify(const can::Frame& frame);

[[nodiscard]] can::Frame make_request(std::uint8_t source, std::uint8_t destination,
                                      std::uint32_t requested_pgn);
/// The requested parameter group. Malformed unless the frame is a request of exactly three bytes.
[[nodiscard]] Decoded<std::uint32_t> decode_request(const can::Frame& frame);

/// An address claim; with source kNullAddress it says "cannot claim an address".
[[nodiscard]] can::Frame make_address_claim(std::uint8_t source, std::uint64_t name);
/// The NAME. Malformed unless the frame is a claim of exactly eight bytes.
[[nodiscard]] Decoded<std::uint64_t> decode_address_claim(const can::Frame& frame);

struct CommandedAddress {
  std::uint64_t name = 0;    ///< NAME of the addressed node.
  std::uint8_t address = 0;  ///< Address that it shall claim.

  friend bool operator==(const CommandedAddress&, const CommandedAddress&) = default;
};
inline constexpr std::size_t kCommandedAddressBytes = 8 + 1;  // NAME, address
[[nodiscard]] std::array<std::uint8_t, kCommandedAddressBytes> encode_commanded_address(
    const CommandedAddress& command);
/// Malformed unless it has exactly nine bytes.
[[nodiscard]] Decoded<CommandedAddress> decode_commanded_address(
    std::span<const std::uint8_t> payload);

enum class Acknowledge : std::uint8_t { positive = 0, negative = 1, access_denied = 2, busy = 3 };

struct Acknowledgement {
  Acknowledge control = Acknowledge::positive;
  std::uint8_t group_function = 0xFF;     ///< 0xFF: not applicable.
  std::uint8_t address = kGlobalAddress;  ///< Address of the node that is acknowledged.
  std::uint32_t pgn = 0;                  ///< Group that is acknowledged.

  friend bool operator==(const Acknowledgement&, const Acknowledgement&) = default;
};

/// Layout: control, group function, FF, FF, address, parameter group low byte first.
[[nodiscard]] can::Frame make_acknowledgement(std::uint8_t source, std::uint8_t destination,
                                              const Acknowledgement& acknowledgement);
/// Malformed unless the frame is an acknowledgement of eight bytes with control 0..3.
[[nodiscard]] Decoded<Acknowledgement> decode_acknowledgement(const can::Frame& frame);

}  // namespace rigwire::protocols::j1939
