// pcap: the older file format of captures, of one link type, as tcpdump writes it.
//
// Source: IETF draft-ietf-opsawg-pcap-04. A head of 24 bytes says byte order and resolution by its
// first four, and the link type by its last; then records, each a head of 16 bytes (seconds,
// fraction, bytes that follow, bytes that the packet had) and its bytes.
//
//   magic       times in
//   0xA1B2C3D4  microseconds
//   0xA1B23C4D  nanoseconds
//
// A file that ends in the middle of a record is good up to that record.
#pragma once

#include <cstdint>
#include <span>

#include "protocols/pcapng/pcapng.h"
#include "protocols/result.h"

namespace rigwire::protocols::pcapng {

inline constexpr std::size_t kPcapHead = 4     // magic
                                         + 2   // version
                                         + 2   // of it, minor
                                         + 4   // time zone, 0
                                         + 4   // accuracy, 0
                                         + 4   // longest packet
                                         + 4;  // link type
static_assert(kPcapHead == 24);
inline constexpr std::size_t kPcapRecordHead = 4     // seconds
                                               + 4   // micro- or nanoseconds
                                               + 4   // bytes that follow
                                               + 4;  // bytes of the packet
static_assert(kPcapRecordHead == 16);

/// Reads a file record by record. Packets refer to the bytes that were given.
class PcapReader {
 public:
  /// Whether a file that begins so is of this format.
  [[nodiscard]] static bool begins(std::span<const std::uint8_t> bytes);

  /// Takes the head at the front of `bytes`: the link. Once, before next(). Malformed: another
  /// magic, a version other than 2.
  [[nodiscard]] Decoded<Interface> head(std::span<const std::uint8_t> bytes);
  /// The record at the front of `bytes`. Malformed: a length beyond Reader::kLongestBlock, a
  /// fraction of a whole second or more.
  [[nodiscard]] Decoded<Packet> next(std::span<const std::uint8_t> bytes) const;

 private:
  [[nodiscard]] std::uint32_t load(std::span<const std::uint8_t> bytes, std::size_t at) const;

  bool big_endian_ = false;
  bool nanoseconds_ = false;
};

}  // namespace rigwire::protocols::pcapng
