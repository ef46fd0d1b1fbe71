// pcapng: the file format of captures with several interfaces of different link types.
//
// Source: IETF draft-ietf-opsawg-pcapng-02. A file is a row of blocks; each has its type, its total
// length in front and behind, and options of type, length and value, padded to four bytes. Nothing
// is sought back to, so that a file that ends in the middle of a block is good up to that block.
//
//   block       type        what is written and read
//   section     0x0A0D0D0A  byte order, version 1.0; options 1 comment, 4 application
//   interface   0x00000001  link type; options 2 name, 3 description, 9 resolution, 14 offset
//   old packet  0x00000002  read as a packet; its number of packets lost
//   simple      0x00000003  passed over: it has no time
//   packet      0x00000006  interface, time, lengths, bytes; options 1 comment, 2 direction,
//                           4 packets lost before it
//   statistics  0x00000005  interface, time; options 4 received, 5 lost
//
// Written is little-endian, with times in nanoseconds; both byte orders and every resolution, by
// powers of ten and of two, are read. Times count from 1970 without leap seconds, as computers do.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "protocols/result.h"

namespace rigwire::protocols::pcapng {

/// What the bytes of a packet are, by tcpdump.org's list of link types.
enum class LinkType : std::uint16_t {
  ethernet = 1,
  raw_ip = 101,          ///< The packet begins with its IP head.
  linux_cooked = 113,    ///< Linux "any" device: sixteen bytes in front, the last two its protocol.
  socketcan = 227,       ///< struct can_frame, identifier in network order.
  rtac_serial = 250,     ///< A head of twelve bytes, then what the line carried.
  linux_cooked_2 = 276,  ///< Linux "any" device: twenty bytes in front, the first two its protocol.
};

/// Seen from the device that is emulated, whose wire the interface is.
enum class Direction : std::uint8_t { unknown, inbound, outbound };

struct Section {
  std::string application;
  std::string comment;
};

struct Interface {
  LinkType link = LinkType::ethernet;
  std::string name;
  std::string description;
  /// Its times count 10^-resolution s in the file, or 2^-(resolution - 128) s from 128 on. Written
  /// is always 9.
  std::uint8_t resolution = 9;
  std::int64_t offset_s = 0;  ///< Added to its times. Written is always 0.
};

struct Packet {
  std::uint32_t interface = 0;  ///< Index in the section, from 0.
  std::uint64_t time_ns = 0;
  std::span<const std::uint8_t> bytes;
  std::uint32_t original_length = 0;  ///< Length on the wire; `bytes` may be shorter.
  Direction direction = Direction::unknown;
  std::uint64_t lost_before = 0;  ///< Lost packets since the one before it on its interface.
  std::string_view comment;       ///< Empty: none.
};

struct Statistics {
  std::uint32_t interface = 0;
  std::uint64_t time_ns = 0;
  std::uint64_t received = 0;
  std::uint64_t lost = 0;
};

using Bytes = std::vector<std::uint8_t>;

// Each appends one whole block.
void append(Bytes& out, const Section& section);
void append(Bytes& out, const Interface& interface);
/// `original_length` 0 stands for that of `bytes`. A comment beyond 65535 bytes is cut.
void append(Bytes& out, const Packet& packet);
void append(Bytes& out, const Statistics& statistics);

/// The type of a block with a packet that has no time and no interface of its own.
inline constexpr std::uint32_t kSimplePacketBlock = 3;
/// A block of another kind: to be passed over.
struct OtherBlock {
  std::uint32_t type = 0;
};
using Block = std::variant<Section, Interface, Packet, Statistics, OtherBlock>;

/// Reads a file block by block. Packets refer to the bytes that were given.
class Reader {
 public:
  /// The block at the front of `bytes`. Malformed: no section before it, lengths that contradict
  /// each other, a packet of an interface that was not described.
  [[nodiscard]] Decoded<Block> next(std::span<const std::uint8_t> bytes);

  /// Returns the interfaces of the present section.
  [[nodiscard]] const std::vector<Interface>& interfaces() const { return interfaces_; }

  static constexpr std::size_t kLongestBlock = 16 * 1024 * 1024;

 private:
  std::vector<Interface> interfaces_;
  bool in_section_ = false;
  bool big_endian_ = false;
};

}  // namespace rigwire::protocols::pcapng
