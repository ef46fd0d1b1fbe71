// Modbus on TCP: the MBAP header and the framing of a byte stream into application data units.
//
// Source: MODBUS Messaging on TCP/IP Implementation Guide V1.0b, section 3.1.3:
//
//   offset  size  field
//   0       2     transaction identifier, echoed by the server
//   2       2     protocol identifier, 0 = Modbus
//   4       2     length: unit identifier and PDU, 2 .. 254 here (a PDU has 1 .. 253 bytes)
//   6       1     unit identifier
//   7       ...   PDU
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "protocols/modbus/constants.h"
#include "protocols/result.h"

namespace rigwire::protocols::modbus {

inline constexpr std::uint16_t kModbusProtocol = 0;
inline constexpr std::size_t kMbapLengthMinimum = 1 + 1;            // unit, function
inline constexpr std::size_t kMbapLengthMaximum = 1 + kPduMaximum;  // unit, PDU

struct MbapHeader {
  std::uint16_t transaction = 0;
  std::uint16_t protocol = kModbusProtocol;
  std::uint8_t unit = 1;
  friend bool operator==(const MbapHeader&, const MbapHeader&) = default;
};

/// One data unit inside the bytes given to decode_adu; `pdu` points into them and is never empty.
struct Adu {
  MbapHeader header;
  std::span<const std::uint8_t> pdu;
};

/// The data unit at the start of `stream`. Incomplete until all of it is there. Malformed when the
/// length field is outside 2 .. 254: no later byte can be trusted to start a data unit then. A
/// foreign protocol identifier is not malformed: the length still says where the next unit starts,
/// and the receiver drops this one.
[[nodiscard]] Decoded<Adu> decode_adu(std::span<const std::uint8_t> stream);

/// Encoded bytes, header first; no allocation.
struct AduBytes {
  std::array<std::uint8_t, kTcpAduMaximum> bytes{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }
};

/// Precondition: pdu has 1 .. kPduMaximum bytes.
[[nodiscard]] AduBytes encode_adu(const MbapHeader& header, std::span<const std::uint8_t> pdu);

}  // namespace rigwire::protocols::modbus
