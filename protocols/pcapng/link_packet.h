// What the bytes of one packet are, link type by link type: packets of wires that never were on an
// interface of this machine are laid out as if they had been, so that the tools of the trade
// dissect them.
//
// Sources: tcpdump.org, LINKTYPE_CAN_SOCKETCAN, LINKTYPE_RTAC_SERIAL; RFC 791, 768, 9293;
// IEEE 802.3.
//
//   SocketCAN  identifier (4, network order; bit 31 extended, 30 remote, 29 error), length (1),
//              flags of FD (1), reserved (2), data (8, padded with zeros)
//   RTAC       seconds and microseconds (4 each, network order), event (1), control lines (1),
//              footer (2); then the bytes of the line
//   Ethernet   IPv4 without options; hardware addresses are 02:00 and the IPv4 address; checksums
//   of
//              IPv4 and TCP are right, that of UDP is 0, which says that there is none
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocols/can/error_frame.h"
#include "protocols/can/frame.h"
#include "protocols/pcapng/pcapng.h"
#include "protocols/result.h"

namespace rigwire::protocols::pcapng {

// SocketCAN.

inline constexpr std::size_t kCanPacketSize = 4     // identifier
                                              + 1   // length
                                              + 1   // flags of FD
                                              + 2   // reserved
                                              + 8;  // data
static_assert(kCanPacketSize == 16);
using CanPacket = std::array<std::uint8_t, kCanPacketSize>;

[[nodiscard]] CanPacket can_packet(const can::Frame& frame);
[[nodiscard]] CanPacket can_packet(const can::ErrorFrame& frame);
/// Malformed: an error frame, CAN FD, or an identifier or a length out of range.
[[nodiscard]] Decoded<can::Frame> can_frame(std::span<const std::uint8_t> packet);
[[nodiscard]] bool is_error_frame(std::span<const std::uint8_t> packet);

// RTAC serial.

inline constexpr std::size_t kSerialHead = 4     // seconds
                                           + 4   // microseconds
                                           + 1   // event
                                           + 1   // control lines
                                           + 2;  // footer
static_assert(kSerialHead == 12);

/// Appends the packet of bytes that the device sent (outbound) or received.
void append_serial(Bytes& out, std::uint64_t time_ns, Direction direction,
                   std::span<const std::uint8_t> bytes);
/// What the line carried; empty where the packet has no head.
[[nodiscard]] std::span<const std::uint8_t> serial_bytes(std::span<const std::uint8_t> packet);

// Ethernet.

/// An end of UDP or TCP on IPv4: 127.0.0.2 is 0x7F000002.
struct IpEnd {
  std::uint32_t address = 0;
  std::uint16_t port = 0;

  friend bool operator==(const IpEnd&, const IpEnd&) = default;
};

/// The longest payload of one packet.
inline constexpr std::size_t kLongestDatagram = 65'507;

/// Precondition: not more than kLongestDatagram bytes.
void append_udp(Bytes& out, const IpEnd& from, const IpEnd& to,
                std::span<const std::uint8_t> bytes);

struct UdpPacket {
  IpEnd from;
  IpEnd to;
  std::span<const std::uint8_t> bytes;
};
/// Malformed: no UDP over IPv4 on that link (Ethernet with up to two VLAN tags, Linux cooked, raw
/// IP), or a fragment.
[[nodiscard]] Decoded<UdpPacket> udp_packet(std::span<const std::uint8_t> packet,
                                            LinkType link = LinkType::ethernet);

struct TcpPacket {
  IpEnd from;
  IpEnd to;
  bool opens = false;  ///< SYN.
  bool ends = false;   ///< FIN.
  bool resets = false;
  std::span<const std::uint8_t> bytes;
};
/// Malformed: no TCP over IPv4 on Ethernet, or a fragment.
[[nodiscard]] Decoded<TcpPacket> tcp_packet(std::span<const std::uint8_t> packet);

/// One connection as its two ends would have seen it: numbers run on, nothing is lost, every
/// segment acknowledges all that came before.
class TcpConversation {
 public:
  TcpConversation(const IpEnd& client, const IpEnd& server) : ends_{client, server} {}

  enum class Side : std::uint8_t { client, server };
  /// The segments, each a packet of its own, are handed to `use(Side, span)`.
  /// Opening: SYN, SYN with ACK, ACK.
  template <class Use>
  void open(const Use& use) {
    use(Side::client, segment(Side::client, kSyn, {}));
    use(Side::server, segment(Side::server, kSyn | kAck, {}));
    use(Side::client, segment(Side::client, kAck, {}));
  }
  /// Sends the bytes in as many segments as they need.
  template <class Use>
  void data(Side from, std::span<const std::uint8_t> bytes, const Use& use) {
    while (!bytes.empty()) {
      const auto piece = bytes.first(std::min(bytes.size(), kLongestSegment));
      use(from, segment(from, kPush | kAck, piece));
      bytes = bytes.subspan(piece.size());
    }
  }
  /// One side sends nothing more: FIN, ACK.
  template <class Use>
  void finish(Side from, const Use& use) {
    const Side other = from == Side::client ? Side::server : Side::client;
    use(from, segment(from, kFin | kAck, {}));
    use(other, segment(other, kAck, {}));
  }

  static constexpr std::size_t kLongestSegment = 65'495;

 private:
  static constexpr std::uint8_t kFin = 0x01;
  static constexpr std::uint8_t kSyn = 0x02;
  static constexpr std::uint8_t kPush = 0x08;
  static constexpr std::uint8_t kAck = 0x10;
  /// Valid until the next.
  [[nodiscard]] std::span<const std::uint8_t> segment(Side from, std::uint8_t flags,
                                                      std::span<const std::uint8_t> bytes);

  std::array<IpEnd, 2> ends_;
  std::array<std::uint32_t, 2> sequence_{};
  Bytes packet_;
};

}  // namespace rigwire::protocols::pcapng
