#include "protocols/pcapng/link_packet.h"

#include <algorithm>
#include <cassert>

#include "protocols/bytes.h"

namespace rigwire::protocols::pcapng {
namespace {

constexpr std::uint32_t kExtendedFlag = 0x8000'0000U;
constexpr std::uint32_t kRemoteFlag = 0x4000'0000U;
constexpr std::uint32_t kStandardIds = 0x7FFU;
constexpr std::uint32_t kExtendedIds = 0x1FFF'FFFFU;

constexpr std::uint8_t kSerialTransmit = 1;  // "data transmit start"
constexpr std::uint8_t kSerialReceive = 2;   // "data receive start"

constexpr std::uint16_t kIpv4 = 0x0800;
constexpr std::uint16_t kVlan = 0x8100;
constexpr std::uint16_t kProviderVlan = 0x88A8;
constexpr std::uint8_t kTcp = 6;
constexpr std::uint8_t kUdp = 17;
constexpr std::size_t kEthernetHead = 6     // to
                                      + 6   // from
                                      + 2;  // type
static_assert(kEthernetHead == 14);
constexpr std::size_t kIpHead = 1     // version, length of the head
                                + 1   // service
                                + 2   // length
                                + 2   // identification
                                + 2   // flags, fragment
                                + 1   // time to live
                                + 1   // protocol
                                + 2   // checksum
                                + 4   // from
                                + 4;  // to
static_assert(kIpHead == 20);
constexpr std::size_t kUdpHead = 2     // from
                                 + 2   // to
                                 + 2   // length
                                 + 2;  // checksum
static_assert(kUdpHead == 8);
constexpr std::size_t kTcpHead = 2     // from
                                 + 2   // to
                                 + 4   // sequence
                                 + 4   // acknowledgement
                                 + 1   // length of the head
                                 + 1   // flags
                                 + 2   // window
                                 + 2   // checksum
                                 + 2;  // urgent pointer
static_assert(kTcpHead == 20);

/// The ones' complement sum of RFC 1071, before it is complemented.
std::uint32_t sum(std::span<const std::uint8_t> bytes, std::uint32_t start) {
  std::size_t i = 0;
  for (; i + 1 < bytes.size(); i += 2) {
    start += load_big<std::uint16_t>(bytes, i);
  }
  if (i < bytes.size()) {
    start += static_cast<std::uint32_t>(bytes[i]) << 8U;
  }
  return start;
}

std::uint16_t checksum(std::uint32_t total) {
  while (total > 0xFFFFU) {
    total = (total & 0xFFFFU) + (total >> 16U);
  }
  return static_cast<std::uint16_t>(~total);
}

void put_hardware_address(std::span<std::uint8_t> bytes, std::size_t at, std::uint32_t address) {
  store_big<std::uint16_t>(bytes, at, 0x0200);  // locally administered
  store_big<std::uint32_t>(bytes, at + 2, address);
}

/// Appends both heads and room for `size` bytes behind, which is returned.
std::span<std::uint8_t> append_ip(Bytes& out, std::uint8_t protocol, std::uint32_t from,
                                  std::uint32_t to, std::size_t size) {
  const std::size_t start = out.size();
  out.resize(start + kEthernetHead + kIpHead + size);
  const std::span<std::uint8_t> packet = std::span(out).subspan(start);
  put_hardware_address(packet, 0, to);
  put_hardware_address(packet, 6, from);
  store_big<std::uint16_t>(packet, 12, kIpv4);
  const std::span<std::uint8_t> ip = packet.subspan(kEthernetHead);
  ip[0] = 0x45;  // version 4, five words
  store_big<std::uint16_t>(ip, 2, static_cast<std::uint16_t>(kIpHead + size));
  store_big<std::uint16_t>(ip, 6, 0x4000);  // not to be fragmented
  ip[8] = 64;
  ip[9] = protocol;
  store_big<std::uint32_t>(ip, 12, from);
  store_big<std::uint32_t>(ip, 16, to);
  store_big<std::uint16_t>(ip, 10, checksum(sum(ip.first(kIpHead), 0)));
  return ip.subspan(kIpHead);
}

/// Payload of an IPv4 packet.
struct IpContent {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
  std::size_t offset = 0;  ///< Offset of `bytes` in the packet.
  std::size_t length = 0;  ///< Length in the head; `bytes` may be longer (padding) or shorter.
  std::span<const std::uint8_t> bytes;
};

/// Returns the payload of an IPv4 packet of that protocol. Malformed if it is shorter than `needed`
/// bytes.
Decoded<IpContent> ip_content(std::span<const std::uint8_t> packet, LinkType link,
                              std::uint8_t protocol, std::size_t needed) {
  const auto shorter_than = [&](std::size_t size) { return packet.size() < size; };
  constexpr std::size_t kCookedHead = 16;
  constexpr std::size_t kCooked2Head = 20;
  std::size_t type_at = kEthernetHead - 2;  // where the content's protocol number is
  std::size_t at = kEthernetHead;
  switch (link) {
    case LinkType::raw_ip:
      at = 0;
      break;
    case LinkType::linux_cooked:
      type_at = kCookedHead - 2;
      at = kCookedHead;
      break;
    case LinkType::linux_cooked_2:
      type_at = 0;
      at = kCooked2Head;
      break;
    case LinkType::ethernet:
      break;
    default:
      return Malformed{"no link that carries IP", 0};
  }
  if (at != 0) {
    if (shorter_than(at)) {
      return Incomplete{at, packet.size()};
    }
    auto type = load_big<std::uint16_t>(packet, type_at);
    for (int tags = 0; tags < 2 && (type == kVlan || type == kProviderVlan); ++tags) {
      if (shorter_than(at + 4)) {
        return Incomplete{at + 4, packet.size()};
      }
      type = load_big<std::uint16_t>(packet, at + 2);
      at += 4;
    }
    if (type != kIpv4) {
      return Malformed{"no IPv4", type_at};
    }
  }
  if (shorter_than(at + kIpHead)) {
    return Incomplete{at + kIpHead, packet.size()};
  }
  const auto ip = packet.subspan(at);
  const std::size_t head = 4U * (ip[0] & 0x0FU);
  const std::size_t total = load_big<std::uint16_t>(ip, 2);
  if (ip[0] >> 4U != 4 || head < kIpHead || total < head + needed) {
    return Malformed{"no head of IPv4", at};
  }
  if (ip[9] != protocol) {
    return Malformed{"another protocol over IPv4", at + 9};
  }
  // "More fragments", and where the fragment begins.
  if ((load_big<std::uint16_t>(ip, 6) & 0x3FFFU) != 0) {
    return Malformed{"a fragment", at + 6};
  }
  if (ip.size() < head + needed) {
    return Incomplete{at + head + needed, packet.size()};
  }
  return {{load_big<std::uint32_t>(ip, 12), load_big<std::uint32_t>(ip, 16), at + head,
           total - head, ip.subspan(head)},
          packet.size()};
}

}  // namespace

CanPacket can_packet(const can::Frame& frame) {
  CanPacket packet{};
  store_big<std::uint32_t>(
      packet, 0,
      frame.id | (frame.extended ? kExtendedFlag : 0U) | (frame.remote ? kRemoteFlag : 0U));
  packet[4] = frame.length;
  const auto data = frame.payload();
  std::copy(data.begin(), data.end(), packet.begin() + 8);
  return packet;
}

CanPacket can_packet(const can::ErrorFrame& frame) {
  CanPacket packet{};
  store_big<std::uint32_t>(packet, 0, frame.id);
  packet[4] = static_cast<std::uint8_t>(frame.data.size());
  std::copy(frame.data.begin(), frame.data.end(), packet.begin() + 8);
  return packet;
}

bool is_error_frame(std::span<const std::uint8_t> packet) {
  return packet.size() >= 4 && (load_big<std::uint32_t>(packet, 0) & can::kErrorFlag) != 0;
}

Decoded<can::Frame> can_frame(std::span<const std::uint8_t> packet) {
  constexpr std::size_t kHead = kCanPacketSize - 8;
  if (packet.size() < kHead) {
    return Incomplete{kHead, packet.size()};
  }
  const auto identifier = load_big<std::uint32_t>(packet, 0);
  if ((identifier & can::kErrorFlag) != 0) {
    return Malformed{"an error frame", 0};
  }
  can::Frame frame;
  frame.extended = (identifier & kExtendedFlag) != 0;
  frame.remote = (identifier & kRemoteFlag) != 0;
  frame.id = identifier & kExtendedIds;
  frame.length = packet[4];
  if (!frame.extended && frame.id > kStandardIds) {
    return Malformed{"an identifier of more than 11 bits", 0};
  }
  if (frame.length > frame.data.size()) {
    return Malformed{"more than eight bytes: CAN FD", 4};
  }
  const std::size_t data = frame.payload().size();
  if (packet.size() < kHead + data) {
    return Incomplete{kHead + data, packet.size()};
  }
  std::copy_n(packet.begin() + kHead, data, frame.data.begin());
  return {frame, packet.size()};
}

void append_serial(Bytes& out, std::uint64_t time_ns, Direction direction,
                   std::span<const std::uint8_t> bytes) {
  const std::size_t start = out.size();
  out.resize(start + kSerialHead);
  const std::span<std::uint8_t> head = std::span(out).subspan(start);
  store_big<std::uint32_t>(head, 0, static_cast<std::uint32_t>(time_ns / 1'000'000'000U));
  store_big<std::uint32_t>(head, 4, static_cast<std::uint32_t>(time_ns / 1000 % 1'000'000U));
  head[8] = direction == Direction::inbound ? kSerialReceive : kSerialTransmit;
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::span<const std::uint8_t> serial_bytes(std::span<const std::uint8_t> packet) {
  return packet.size() < kSerialHead ? std::span<const std::uint8_t>()
                                     : packet.subspan(kSerialHead);
}

void append_udp(Bytes& out, const IpEnd& from, const IpEnd& to,
                std::span<const std::uint8_t> bytes) {
  assert(bytes.size() <= kLongestDatagram);
  const auto udp = append_ip(out, kUdp, from.address, to.address, kUdpHead + bytes.size());
  store_big<std::uint16_t>(udp, 0, from.port);
  store_big<std::uint16_t>(udp, 2, to.port);
  store_big<std::uint16_t>(udp, 4, static_cast<std::uint16_t>(kUdpHead + bytes.size()));
  std::copy(bytes.begin(), bytes.end(), udp.begin() + kUdpHead);
}

Decoded<UdpPacket> udp_packet(std::span<const std::uint8_t> packet, LinkType link) {
  const auto found = ip_content(packet, link, kUdp, kUdpHead);
  if (!found.ok()) {
    return found.malformed() ? Decoded<UdpPacket>(found.fault())
                             : Decoded<UdpPacket>(found.shortage());
  }
  const std::span<const std::uint8_t> udp = found->bytes;
  const std::size_t length = load_big<std::uint16_t>(udp, 4);
  if (length < kUdpHead) {
    return Malformed{"the length of a datagram", found->offset + 4};
  }
  if (udp.size() < length) {
    return Incomplete{found->offset + length, packet.size()};
  }
  return {{{found->from, load_big<std::uint16_t>(udp, 0)},
           {found->to, load_big<std::uint16_t>(udp, 2)},
           udp.subspan(kUdpHead, length - kUdpHead)},
          packet.size()};
}

Decoded<TcpPacket> tcp_packet(std::span<const std::uint8_t> packet) {
  const auto found = ip_content(packet, LinkType::ethernet, kTcp, kTcpHead);
  if (!found.ok()) {
    return found.malformed() ? Decoded<TcpPacket>(found.fault())
                             : Decoded<TcpPacket>(found.shortage());
  }
  const std::span<const std::uint8_t> tcp = found->bytes;
  const std::size_t head = 4U * (tcp[12] >> 4U);
  if (head < kTcpHead || found->length < head) {
    return Malformed{"the length of a head of TCP", found->offset + 12};
  }
  if (tcp.size() < found->length) {
    return Incomplete{found->offset + found->length, packet.size()};
  }
  constexpr std::uint8_t kFin = 0x01;
  constexpr std::uint8_t kSyn = 0x02;
  constexpr std::uint8_t kReset = 0x04;
  return {{{found->from, load_big<std::uint16_t>(tcp, 0)},
           {found->to, load_big<std::uint16_t>(tcp, 2)},
           (tcp[13] & kSyn) != 0,
           (tcp[13] & kFin) != 0,
           (tcp[13] & kReset) != 0,
           tcp.subspan(head, found->length - head)},
          packet.size()};
}

std::span<const std::uint8_t> TcpConversation::segment(Side from, std::uint8_t flags,
                                                       std::span<const std::uint8_t> bytes) {
  const auto own = static_cast<std::size_t>(from);
  const std::size_t other = 1 - own;
  packet_.clear();
  const auto tcp =
      append_ip(packet_, kTcp, ends_[own].address, ends_[other].address, kTcpHead + bytes.size());
  store_big<std::uint16_t>(tcp, 0, ends_[own].port);
  store_big<std::uint16_t>(tcp, 2, ends_[other].port);
  store_big<std::uint32_t>(tcp, 4, sequence_[own]);
  store_big<std::uint32_t>(tcp, 8, (flags & kAck) != 0 ? sequence_[other] : 0);
  tcp[12] = 5U << 4U;  // words of the head
  tcp[13] = flags;
  store_big<std::uint16_t>(tcp, 14, 0xFFFF);
  std::copy(bytes.begin(), bytes.end(), tcp.begin() + kTcpHead);
  // Over the segment and a head of both addresses, protocol and length.
  std::uint32_t total = kTcp + static_cast<std::uint32_t>(tcp.size());
  for (const IpEnd& end : ends_) {
    total += (end.address >> 16U) + (end.address & 0xFFFFU);
  }
  store_big<std::uint16_t>(tcp, 16, checksum(sum(tcp, total)));
  sequence_[own] +=
      static_cast<std::uint32_t>(bytes.size()) + ((flags & (kSyn | kFin)) != 0 ? 1 : 0);
  return packet_;
}

}  // namespace rigwire::protocols::pcapng
