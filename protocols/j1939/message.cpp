#include "protocols/j1939/message.h"

#include <algorithm>
#include <array>

#include "protocols/bytes.h"

namespace rigwire::protocols::j1939 {
namespace {

constexpr std::size_t kRequestBytes = 3;
constexpr std::size_t kClaimBytes = 8;
constexpr std::size_t kAcknowledgementBytes = 1 + 1 + 2 + 1 + 3;  // control, function, FF, who, PGN
static_assert(kAcknowledgementBytes == 8);

void store_pgn(std::span<std::uint8_t> bytes, std::size_t offset, std::uint32_t pgn) {
  for (std::size_t i = 0; i < 3; ++i) {
    bytes[offset + i] = static_cast<std::uint8_t>((pgn >> (8 * i)) & 0xFFU);
  }
}

std::uint32_t load_pgn(std::span<const std::uint8_t> bytes, std::size_t offset) {
  return bytes[offset] | (static_cast<std::uint32_t>(bytes[offset + 1]) << 8U) |
         (static_cast<std::uint32_t>(bytes[offset + 2] & 0x3U) << 16U);
}

bool is_message(const can::Frame& frame, std::uint32_t pgn) {
  const auto identifier = identify(frame);
  return identifier && identifier->pgn == pgn;
}

}  // namespace

can::Frame make_frame(const Identifier& identifier, std::span<const std::uint8_t> payload) {
  can::Frame frame;
  frame.id = pack(identifier);
  frame.extended = true;
  frame.length = static_cast<std::uint8_t>(std::min(payload.size(), frame.data.size()));
  std::copy_n(payload.begin(), frame.length, frame.data.begin());
  return frame;
}

std::optional<Identifier> identify(const can::Frame& frame) {
  if (!frame.extended || frame.remote || frame.length > 8) {
    return std::nullopt;
  }
  return unpack(frame.id);
}

can::Frame make_request(std::uint8_t source, std::uint8_t destination,
                        std::uint32_t requested_pgn) {
  std::array<std::uint8_t, kRequestBytes> payload{};
  store_pgn(payload, 0, requested_pgn);
  return make_frame({kManagementPriority, kRequestPgn, destination, source}, payload);
}

Decoded<std::uint32_t> decode_request(const can::Frame& frame) {
  if (!is_message(frame, kRequestPgn)) {
    return Malformed{"not a request (PGN 59904, 29-bit data frame)", 0};
  }
  if (frame.length != kRequestBytes) {
    return Malformed{"a request has exactly 3 bytes", frame.length};
  }
  return {load_pgn(frame.payload(), 0), kRequestBytes};
}

can::Frame make_address_claim(std::uint8_t source, std::uint64_t name) {
  std::array<std::uint8_t, kClaimBytes> payload{};
  store_little<std::uint64_t>(payload, 0, name);
  return make_frame({kManagementPriority, kAddressClaimedPgn, kGlobalAddress, source}, payload);
}

Decoded<std::uint64_t> decode_address_claim(const can::Frame& frame) {
  if (!is_message(frame, kAddressClaimedPgn)) {
    return Malformed{"not an address claim (PGN 60928, 29-bit data frame)", 0};
  }
  if (frame.length != kClaimBytes) {
    return Malformed{"an address claim has exactly 8 bytes", frame.length};
  }
  return {load_little<std::uint64_t>(frame.payload(), 0), kClaimBytes};
}

std::array<std::uint8_t, kCommandedAddressBytes> encode_commanded_address(
    const CommandedAddress& command) {
  std::array<std::uint8_t, kCommandedAddressBytes> payload{};
  store_little<std::uint64_t>(payload, 0, command.name);
  payload[8] = command.address;
  return payload;
}

Decoded<CommandedAddress> decode_commanded_address(std::span<const std::uint8_t> payload) {
  if (payload.size() != kCommandedAddressBytes) {
    return Malformed{"a commanded address has exactly 9 bytes", payload.size()};
  }
  return {CommandedAddress{load_little<std::uint64_t>(payload, 0), payload[8]},
          kCommandedAddressBytes};
}

can::Frame make_acknowledgement(std::uint8_t source, std::uint8_t destination,
                                const Acknowledgement& acknowledgement) {
  std::array<std::uint8_t, kAcknowledgementBytes> payload{};
  payload.fill(0xFF);
  payload[0] = static_cast<std::uint8_t>(acknowledgement.control);
  payload[1] = acknowledgement.group_function;
  payload[4] = acknowledgement.address;
  store_pgn(payload, 5, acknowledgement.pgn);
  return make_frame({kManagementPriority, kAcknowledgementPgn, destination, source}, payload);
}

Decoded<Acknowledgement> decode_acknowledgement(const can::Frame& frame) {
  if (!is_message(frame, kAcknowledgementPgn)) {
    return Malformed{"not an acknowledgement (PGN 59392, 29-bit data frame)", 0};
  }
  if (frame.length != kAcknowledgementBytes) {
    return Malformed{"an acknowledgement has exactly 8 bytes", frame.length};
  }
  const auto payload = frame.payload();
  if (payload[0] > static_cast<std::uint8_t>(Acknowledge::busy)) {
    return Malformed{"control byte is 0..3", 0};
  }
  return {Acknowledgement{static_cast<Acknowledge>(payload[0]), payload[1], payload[4],
                          load_pgn(payload, 5)},
          kAcknowledgementBytes};
}

}  // namespace rigwire::protocols::j1939
