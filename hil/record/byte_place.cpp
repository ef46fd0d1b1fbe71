#include "hil/record/byte_place.h"

#include <fmt/format.h>

#include <algorithm>

#include "protocols/bytes.h"
#include "protocols/can/signal.h"
#include "protocols/pcapng/link_packet.h"

namespace rigwire::hil {
namespace {

namespace pcapng = protocols::pcapng;

constexpr std::size_t kLongestSentence = 1024;

/// Bytes of the message that begins at the front, 0: none does.
std::size_t message_size(std::span<const std::uint8_t> bytes) {
  if (bytes.size() >= 6 && bytes[0] == 0xB5 && bytes[1] == 0x62) {
    return 8U + protocols::load_little<std::uint16_t>(bytes, 4);  // head of 6, check of 2
  }
  if (bytes.size() >= 3 && bytes[0] == 0xD3 && (bytes[1] & 0xFCU) == 0) {
    return 6U + (protocols::load_big<std::uint16_t>(bytes, 1) & 0x3FFU);  // head and check of 3
  }
  if (!bytes.empty() && bytes[0] == '$') {
    const auto rest = bytes.first(std::min(bytes.size(), kLongestSentence));
    return static_cast<std::size_t>(std::ranges::find(rest, '\n') - rest.begin()) + 1;
  }
  return 0;
}

std::string name_message(std::span<const std::uint8_t> message, std::size_t at) {
  if (message[0] == 0xB5) {
    return fmt::format("UBX 0x{:02X} 0x{:02X}, {}", message[2], message[3],
                       at < 6 ? "its head" : fmt::format("byte {} of its payload", at - 6));
  }
  if (message[0] == 0xD3) {
    const unsigned number =
        message.size() < 5 ? 0U : protocols::load_big<std::uint16_t>(message, 3) >> 4U;
    return fmt::format("RTCM {}, byte {}", number, at);
  }
  const auto end = std::ranges::find(message, ',');
  return fmt::format("{}, field {}", std::string(message.begin(), end),
                     std::count(message.begin(), message.begin() + static_cast<std::ptrdiff_t>(at),
                                std::uint8_t{','}));
}

}  // namespace

std::string serial_place(std::span<const std::uint8_t> bytes, std::size_t at) {
  for (std::size_t from = 0; from <= at && from < bytes.size();) {
    const std::size_t size = message_size(bytes.subspan(from));
    if (size == 0) {
      ++from;
      continue;
    }
    if (at < from + size) {
      return name_message(bytes.subspan(from, std::min(size, bytes.size() - from)), at - from);
    }
    from += size;
  }
  return {};
}

std::string datagram_place(std::span<const std::uint8_t> bytes, std::size_t at) {
  constexpr std::size_t kBlock = 2      // flag
                                 + 2    // azimuth
                                 + 96;  // 32 returns
  constexpr std::size_t kData = 12 * kBlock + 4 /* time stamp */ + 2 /* factory bytes */;
  constexpr std::size_t kPosition = 512;
  if (bytes.size() == kPosition) {
    return "position packet";
  }
  if (bytes.size() != kData) {
    return {};
  }
  if (at >= 12 * kBlock) {
    return at < 12 * kBlock + 4 ? "data packet, time stamp" : "data packet, factory bytes";
  }
  const std::size_t within = at % kBlock;
  const std::string block = fmt::format("data packet, block {}", at / kBlock);
  if (within < 4) {
    return block + (within < 2 ? ", flag" : ", azimuth");
  }
  return fmt::format("{}, channel {}, {}", block, (within - 4) / 3,
                     (within - 4) % 3 == 2 ? "reflectivity" : "distance");
}

std::string can_place(std::span<const std::uint8_t> packet, std::span<const std::uint8_t> other,
                      std::size_t at, std::span<const protocols::can::OwnedMessage> messages) {
  const auto frame = pcapng::can_frame(packet);
  if (!frame.ok()) {
    return pcapng::is_error_frame(packet) ? "error frame" : std::string();
  }
  constexpr std::size_t kHead = pcapng::kCanPacketSize - 8;
  std::string text = fmt::format("{:0{}X}", frame->id, frame->extended ? 8 : 3);
  const auto same = [&](const auto& message) {
    return message.id == frame->id && message.extended == frame->extended;
  };
  const auto message = std::ranges::find_if(messages, same);
  if (message != messages.end()) {
    text += " " + message->name;
  }
  if (at < kHead) {
    return text + (at < 4 ? ", identifier" : ", length");
  }
  text += fmt::format(", data byte {}", at - kHead);
  if (message != messages.end() && at < other.size()) {
    const auto changed = static_cast<std::uint8_t>(packet[at] ^ other[at]);
    for (const auto& signal : message->signals) {
      if ((protocols::can::bits_in(signal, at - kHead) & changed) != 0) {
        text += ", signal " + signal.name;
        break;
      }
    }
  }
  return text;
}

}  // namespace rigwire::hil
