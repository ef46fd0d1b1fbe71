#include "protocols/pcapng/pcap.h"

#include "protocols/bytes.h"

namespace rigwire::protocols::pcapng {
namespace {

constexpr std::uint32_t kMicroseconds = 0xA1B2'C3D4U;
constexpr std::uint32_t kNanoseconds = 0xA1B2'3C4DU;

bool is_magic(std::uint32_t word) {
  return word == kMicroseconds || word == kNanoseconds;
}

}  // namespace

bool PcapReader::begins(std::span<const std::uint8_t> bytes) {
  return bytes.size() >= 4 && (is_magic(load_little<std::uint32_t>(bytes, 0)) ||
                               is_magic(load_big<std::uint32_t>(bytes, 0)));
}

std::uint32_t PcapReader::load(std::span<const std::uint8_t> bytes, std::size_t at) const {
  return big_endian_ ? load_big<std::uint32_t>(bytes, at) : load_little<std::uint32_t>(bytes, at);
}

Decoded<Interface> PcapReader::head(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kPcapHead) {
    return Incomplete{kPcapHead, bytes.size()};
  }
  if (!begins(bytes)) {
    return Malformed{"no capture of the format pcap", 0};
  }
  big_endian_ = is_magic(load_big<std::uint32_t>(bytes, 0));
  nanoseconds_ = load(bytes, 0) == kNanoseconds;
  const std::uint16_t version =
      big_endian_ ? load_big<std::uint16_t>(bytes, 4) : load_little<std::uint16_t>(bytes, 4);
  if (version != 2) {
    return Malformed{"another version of pcap than 2", 4};
  }
  Interface interface;
  // The upper half says whether check sequences are there, which this reader ignores.
  interface.link = static_cast<LinkType>(load(bytes, 20) & 0xFFFFU);
  interface.resolution = nanoseconds_ ? 9 : 6;
  return {interface, kPcapHead};
}

Decoded<Packet> PcapReader::next(std::span<const std::uint8_t> bytes) const {
  if (bytes.size() < kPcapRecordHead) {
    return Incomplete{kPcapRecordHead, bytes.size()};
  }
  const std::uint32_t fraction = load(bytes, 4);
  const std::size_t length = load(bytes, 8);
  if (fraction >= (nanoseconds_ ? 1'000'000'000U : 1'000'000U)) {
    return Malformed{"a fraction of a second that is more than one", 4};
  }
  if (length > Reader::kLongestBlock) {
    return Malformed{"a packet that is too long", 8};
  }
  if (bytes.size() < kPcapRecordHead + length) {
    return Incomplete{kPcapRecordHead + length, bytes.size()};
  }
  Packet packet;
  packet.time_ns = std::uint64_t{load(bytes, 0)} * 1'000'000'000U +
                   std::uint64_t{fraction} * (nanoseconds_ ? 1U : 1'000U);
  packet.original_length = load(bytes, 12);
  packet.bytes = bytes.subspan(kPcapRecordHead, length);
  return {packet, kPcapRecordHead + length};
}

}  // namespace rigwire::protocols::pcapng
