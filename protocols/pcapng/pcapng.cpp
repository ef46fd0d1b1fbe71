#include "protocols/pcapng/pcapng.h"

#include <algorithm>
#include <array>

#include "protocols/bytes.h"

namespace rigwire::protocols::pcapng {
namespace {

constexpr std::uint32_t kSectionBlock = 0x0A0D0D0A;
constexpr std::uint32_t kInterfaceBlock = 1;
constexpr std::uint32_t kOldPacketBlock = 2;
constexpr std::uint32_t kStatisticsBlock = 5;
constexpr std::uint32_t kPacketBlock = 6;
constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;

constexpr std::uint16_t kEndOfOptions = 0;
constexpr std::uint16_t kComment = 1;
constexpr std::uint16_t kInterfaceName = 2;
constexpr std::uint16_t kInterfaceDescription = 3;
constexpr std::uint16_t kInterfaceResolution = 9;
constexpr std::uint16_t kInterfaceOffset = 14;
constexpr std::uint16_t kPacketFlags = 2;
constexpr std::uint16_t kPacketLost = 4;
constexpr std::uint16_t kSectionApplication = 4;
constexpr std::uint16_t kStatisticsReceived = 4;
constexpr std::uint16_t kStatisticsLost = 5;

constexpr std::size_t kFrame = 4     // type
                               + 4   // total length
                               + 4;  // total length again, behind
static_assert(kFrame == 12);
constexpr std::size_t kSectionBody = 4     // byte order
                                     + 4   // version
                                     + 8;  // length of the section
static_assert(kSectionBody == 16);
constexpr std::size_t kInterfaceBody = 2     // link type
                                       + 2   // reserved
                                       + 4;  // maximum length
static_assert(kInterfaceBody == 8);
constexpr std::size_t kPacketBody = 4     // interface
                                    + 8   // time, upper half first
                                    + 4   // captured length
                                    + 4;  // original length
static_assert(kPacketBody == 20);
constexpr std::size_t kStatisticsBody = 4     // interface
                                        + 8;  // time, upper half first
static_assert(kStatisticsBody == 12);
constexpr std::size_t kOptionHead = 2     // code
                                    + 2;  // length
static_assert(kOptionHead == 4);

constexpr std::size_t padded(std::size_t length) {
  return (length + 3) / 4 * 4;
}

template <class Integer>
void put(Bytes& out, Integer value) {
  const std::size_t at = out.size();
  out.resize(at + sizeof(Integer));
  store_little<Integer>(out, at, value);
}

void put_padded(Bytes& out, std::span<const std::uint8_t> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
  out.resize(out.size() + padded(bytes.size()) - bytes.size());
}

/// Writes the frame around what is appended while it lives.
class OpenBlock {
 public:
  OpenBlock(Bytes& out, std::uint32_t type) : out_(out), start_(out.size()) {
    put(out, type);
    put<std::uint32_t>(out, 0);
  }
  ~OpenBlock() {
    const auto length = static_cast<std::uint32_t>(out_.size() + 4 - start_);
    store_little<std::uint32_t>(out_, start_ + 4, length);
    put(out_, length);
  }
  OpenBlock(const OpenBlock&) = delete;
  OpenBlock& operator=(const OpenBlock&) = delete;

  void option(std::uint16_t code, std::span<const std::uint8_t> value) {
    const auto cut = value.first(std::min<std::size_t>(value.size(), 0xFFFF));
    put(out_, code);
    put(out_, static_cast<std::uint16_t>(cut.size()));
    put_padded(out_, cut);
    any_ = true;
  }
  void option(std::uint16_t code, std::string_view text) {
    if (!text.empty()) {
      option(code, std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()));
    }
  }
  template <class Integer>
  void number(std::uint16_t code, Integer value) {
    std::array<std::uint8_t, sizeof(Integer)> bytes{};
    store_little<Integer>(bytes, 0, value);
    option(code, bytes);
  }
  void end_options() {
    if (any_) {
      put<std::uint16_t>(out_, kEndOfOptions);
      put<std::uint16_t>(out_, 0);
    }
  }

 private:
  Bytes& out_;
  std::size_t start_;
  bool any_ = false;
};

void put_time(Bytes& out, std::uint64_t time_ns) {
  put(out, static_cast<std::uint32_t>(time_ns >> 32U));
  put(out, static_cast<std::uint32_t>(time_ns));
}

/// Numbers of a block in the section's byte order.
class View {
 public:
  View(std::span<const std::uint8_t> bytes, bool big_endian)
      : bytes_(bytes), big_endian_(big_endian) {}

  template <class Integer>
  [[nodiscard]] Integer number(std::size_t at) const {
    return big_endian_ ? load_big<Integer>(bytes_, at) : load_little<Integer>(bytes_, at);
  }
  [[nodiscard]] std::uint64_t time(std::size_t at) const {
    return std::uint64_t{number<std::uint32_t>(at)} << 32U | number<std::uint32_t>(at + 4);
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const { return bytes_; }

  /// Calls `use` with code and place of each option from `at` on; false where one is cut off.
  template <class Use>
  [[nodiscard]] bool each_option(std::size_t at, const Use& use) const {
    while (bytes_.size() - at >= kOptionHead) {
      const auto code = number<std::uint16_t>(at);
      const auto length = number<std::uint16_t>(at + 2);
      at += kOptionHead;
      if (code == kEndOfOptions) {
        return true;
      }
      if (bytes_.size() - at < padded(length)) {
        return false;
      }
      use(code, View(bytes_.subspan(at, length), big_endian_));
      at += padded(length);
    }
    return true;
  }
  [[nodiscard]] std::string_view text() const {
    return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()};
  }

 private:
  std::span<const std::uint8_t> bytes_;
  bool big_endian_;
};

constexpr Malformed kCutOption{"an option that is longer than its block", 0};

/// Resolution of an interface that does not give one.
constexpr std::uint8_t kUsualResolution = 6;
constexpr std::uint8_t kFinestResolution = 18;

/// At this value and above a resolution is a power of two.
constexpr std::uint8_t kBinary = 0x80;
constexpr std::uint8_t kFinestBinary = kBinary + 60;

/// A time as the interface counts it, in nanoseconds.
std::uint64_t nanoseconds(std::uint64_t time, const Interface& interface) {
  constexpr std::uint64_t kSecond_ns = 1'000'000'000;
  std::uint8_t resolution = interface.resolution;
  if (resolution >= kBinary) {
    const unsigned bits = resolution - kBinary;
    const std::uint64_t whole = bits == 0 ? time : time >> bits;
    const std::uint64_t rest = time - (whole << bits);
    // The rest has `bits` bits: as many as fit beside the nanoseconds are enough for one of them.
    const unsigned kept = bits > 30 ? 30 : bits;
    time = whole * kSecond_ns + ((rest >> (bits - kept)) * kSecond_ns >> kept);
  }
  for (; resolution < 9; ++resolution) {
    time *= 10;
  }
  for (; resolution > 9 && resolution < kBinary; --resolution) {
    time /= 10;
  }
  return time + static_cast<std::uint64_t>(interface.offset_s) * kSecond_ns;
}

}  // namespace

void append(Bytes& out, const Section& section) {
  OpenBlock block(out, kSectionBlock);
  put(out, kByteOrderMagic);
  put<std::uint16_t>(out, 1);
  put<std::uint16_t>(out, 0);
  put<std::uint64_t>(out, ~std::uint64_t{0});
  block.option(kComment, section.comment);
  block.option(kSectionApplication, section.application);
  block.end_options();
}

void append(Bytes& out, const Interface& interface) {
  OpenBlock block(out, kInterfaceBlock);
  put(out, static_cast<std::uint16_t>(interface.link));
  put<std::uint16_t>(out, 0);
  put<std::uint32_t>(out, 0);
  block.option(kInterfaceName, interface.name);
  block.option(kInterfaceDescription, interface.description);
  block.number<std::uint8_t>(kInterfaceResolution, 9);
  block.end_options();
}

void append(Bytes& out, const Packet& packet) {
  OpenBlock block(out, kPacketBlock);
  put(out, packet.interface);
  put_time(out, packet.time_ns);
  const auto length = static_cast<std::uint32_t>(packet.bytes.size());
  put(out, length);
  put(out, packet.original_length == 0 ? length : packet.original_length);
  put_padded(out, packet.bytes);
  block.option(kComment, packet.comment);
  if (packet.direction != Direction::unknown) {
    block.number<std::uint32_t>(kPacketFlags, static_cast<std::uint32_t>(packet.direction));
  }
  if (packet.lost_before != 0) {
    block.number<std::uint64_t>(kPacketLost, packet.lost_before);
  }
  block.end_options();
}

void append(Bytes& out, const Statistics& statistics) {
  OpenBlock block(out, kStatisticsBlock);
  put(out, statistics.interface);
  put_time(out, statistics.time_ns);
  block.number<std::uint64_t>(kStatisticsReceived, statistics.received);
  block.number<std::uint64_t>(kStatisticsLost, statistics.lost);
  block.end_options();
}

Decoded<Block> Reader::next(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kFrame) {
    return Incomplete{kFrame, bytes.size()};
  }
  // A section's type reads the same in both orders; its magic says which one holds.
  if (load_little<std::uint32_t>(bytes, 0) == kSectionBlock) {
    const auto magic = load_little<std::uint32_t>(bytes, 8);
    if (magic != kByteOrderMagic && load_big<std::uint32_t>(bytes, 8) != kByteOrderMagic) {
      return Malformed{"a section without byte order", 8};
    }
    big_endian_ = magic != kByteOrderMagic;
    in_section_ = true;
    interfaces_.clear();
  } else if (!in_section_) {
    return Malformed{"a block before the first section", 0};
  }
  const View whole(bytes, big_endian_);
  const auto type = whole.number<std::uint32_t>(0);
  const std::size_t length = whole.number<std::uint32_t>(4);
  if (length < kFrame || length % 4 != 0 || length > kLongestBlock) {
    return Malformed{"the length of a block", 4};
  }
  if (bytes.size() < length) {
    return Incomplete{length, bytes.size()};
  }
  if (whole.number<std::uint32_t>(length - 4) != length) {
    return Malformed{"a block whose two lengths differ", length - 4};
  }
  const View body(bytes.subspan(8, length - kFrame), big_endian_);
  const std::size_t size = body.bytes().size();
  const auto has = [&](std::size_t needed) { return size >= needed; };
  switch (type) {
    case kSectionBlock: {
      Section section;
      if (!has(kSectionBody) || !body.each_option(kSectionBody, [&](auto code, const View& value) {
            if (code == kSectionApplication) {
              section.application = value.text();
            } else if (code == kComment) {
              section.comment = value.text();
            }
          })) {
        return kCutOption;
      }
      return {Block(std::move(section)), length};
    }
    case kInterfaceBlock: {
      Interface interface;
      interface.resolution = kUsualResolution;
      if (!has(kInterfaceBody) ||
          !body.each_option(kInterfaceBody, [&](auto code, const View& value) {
            if (code == kInterfaceName) {
              interface.name = value.text();
            } else if (code == kInterfaceDescription) {
              interface.description = value.text();
            } else if (code == kInterfaceResolution && !value.bytes().empty()) {
              interface.resolution = value.bytes().front();
            } else if (code == kInterfaceOffset && value.bytes().size() == 8) {
              interface.offset_s =
                  static_cast<std::int64_t>(value.template number<std::uint64_t>(0));
            }
          })) {
        return kCutOption;
      }
      if (interface.resolution < kBinary ? interface.resolution > kFinestResolution
                                         : interface.resolution > kFinestBinary) {
        return Malformed{"times that count more than 10^18 or 2^60 in a second", 8};
      }
      interface.link = static_cast<LinkType>(body.number<std::uint16_t>(0));
      interfaces_.push_back(interface);
      return {Block(std::move(interface)), length};
    }
    case kOldPacketBlock:
    case kPacketBlock: {
      if (!has(kPacketBody)) {
        return Malformed{"a packet without its head", 8};
      }
      Packet packet;
      packet.interface =
          type == kPacketBlock ? body.number<std::uint32_t>(0) : body.number<std::uint16_t>(0);
      if (type == kOldPacketBlock && body.number<std::uint16_t>(2) != 0xFFFFU) {
        packet.lost_before = body.number<std::uint16_t>(2);
      }
      const std::size_t captured = body.number<std::uint32_t>(12);
      packet.original_length = body.number<std::uint32_t>(16);
      if (packet.interface >= interfaces_.size()) {
        return Malformed{"a packet of an interface that is not described", 8};
      }
      if (captured > size - kPacketBody || padded(captured) > size - kPacketBody) {
        return Malformed{"a packet that is longer than its block", 8 + 12};
      }
      packet.time_ns = nanoseconds(body.time(4), interfaces_[packet.interface]);
      packet.bytes = body.bytes().subspan(kPacketBody, captured);
      if (!body.each_option(kPacketBody + padded(captured), [&](auto code, const View& value) {
            if (code == kComment) {
              packet.comment = value.text();
            } else if (code == kPacketFlags && value.bytes().size() == 4) {
              const auto direction = value.template number<std::uint32_t>(0) & 3U;
              packet.direction =
                  direction == 3 ? Direction::unknown : static_cast<Direction>(direction);
            } else if (code == kPacketLost && value.bytes().size() == 8) {
              packet.lost_before = value.template number<std::uint64_t>(0);
            }
          })) {
        return kCutOption;
      }
      return {Block(packet), length};
    }
    case kStatisticsBlock: {
      Statistics statistics;
      if (!has(kStatisticsBody) ||
          !body.each_option(kStatisticsBody, [&](auto code, const View& value) {
            if (value.bytes().size() == 8 && code == kStatisticsReceived) {
              statistics.received = value.template number<std::uint64_t>(0);
            } else if (value.bytes().size() == 8 && code == kStatisticsLost) {
              statistics.lost = value.template number<std::uint64_t>(0);
            }
          })) {
        return kCutOption;
      }
      statistics.interface = body.number<std::uint32_t>(0);
      if (statistics.interface >= interfaces_.size()) {
        return Malformed{"statistics of an interface that is not described", 8};
      }
      statistics.time_ns = nanoseconds(body.time(4), interfaces_[statistics.interface]);
      return {Block(statistics), length};
    }
    default:
      return {Block(OtherBlock{type}), length};
  }
}

}  // namespace rigwire::protocols::pcapng
