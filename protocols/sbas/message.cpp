#include "protocols/sbas/message.h"

#include <algorithm>

#include "protocols/crc24q.h"

namespace rigwire::protocols::sbas {
namespace {

constexpr std::array<std::uint8_t, 3> kPreambles{0x53, 0x9A, 0xC6};
constexpr std::size_t kTypeBits = 6;
constexpr std::size_t kChecksumBits = 24;
constexpr std::size_t kCheckedBits = kMessageBits - kChecksumBits;
// In front of the checked bits, so that they end with a whole byte.
constexpr std::size_t kPaddingBits = 6;
constexpr std::size_t kCheckedBytes = (kPaddingBits + kCheckedBits) / 8;
static_assert((kPaddingBits + kCheckedBits) % 8 == 0);

using Checked = std::array<std::uint8_t, kCheckedBytes>;

/// Puts bits one after the other behind those that are there.
class Writer {
 public:
  void put(std::uint32_t value, std::size_t width) {
    for (std::size_t i = width; i-- > 0; ++at_) {
      const auto bit = static_cast<unsigned>(value >> i & 1U);
      checked_[at_ / 8] = static_cast<std::uint8_t>(checked_[at_ / 8] | bit << (7 - at_ % 8));
    }
  }
  [[nodiscard]] const Checked& checked() const { return checked_; }

 private:
  Checked checked_{};
  std::size_t at_ = kPaddingBits;
};

Writer begin(std::uint32_t second, std::uint8_t type) {
  Writer writer;
  writer.put(kPreambles[second % kPreambles.size()], 8);
  writer.put(type, kTypeBits);
  return writer;
}

/// Bits not written are zero.
Message sealed(const Writer& writer) {
  const Checked& checked = writer.checked();
  const std::uint32_t checksum = crc24q(checked);
  Message message;
  const auto put = [&](std::size_t at, bool bit) {
    const std::size_t word = at / 32;
    const std::size_t width = word + 1 < kWords ? 32 : kMessageBits - 32 * (kWords - 1);
    message.words[word] |= bit ? 1U << (width - 1 - at % 32) : 0U;
  };
  for (std::size_t i = 0; i < kCheckedBits; ++i) {
    const std::size_t from = i + kPaddingBits;
    put(i, (checked[from / 8] >> (7 - from % 8) & 1U) != 0);
  }
  for (std::size_t i = 0; i < kChecksumBits; ++i) {
    put(kCheckedBits + i, (checksum >> (kChecksumBits - 1 - i) & 1U) != 0);
  }
  return message;
}

}  // namespace

Message null_message(std::uint32_t second) {
  return sealed(begin(second, kTypeNull));
}

Message mask_message(std::uint32_t second, const std::bitset<32>& gps, std::uint8_t issue) {
  Writer writer = begin(second, kTypeMask);
  for (std::size_t i = 0; i < kMaskedSatellites; ++i) {
    writer.put(i < gps.size() && gps[i] ? 1 : 0, 1);
  }
  writer.put(issue, 2);
  return sealed(writer);
}

Message fast_corrections(std::uint32_t second, std::uint8_t block,
                         std::span<const FastCorrection> corrections, std::uint8_t issue,
                         std::uint8_t mask_issue) {
  Writer writer = begin(second, static_cast<std::uint8_t>(kTypeFirstFastCorrections + block));
  writer.put(issue, 2);
  writer.put(mask_issue, 2);
  const auto at = [&](std::size_t i) {
    return i < corrections.size() ? corrections[i] : FastCorrection{};
  };
  for (std::size_t i = 0; i < kFastCorrections; ++i) {
    writer.put(static_cast<std::uint32_t>(at(i).range_steps) & 0xFFFU, 12);
  }
  for (std::size_t i = 0; i < kFastCorrections; ++i) {
    writer.put(at(i).error_index, 4);
  }
  return sealed(writer);
}

Message degradation_message(std::uint32_t second, std::uint8_t mask_issue) {
  Writer writer = begin(second, kTypeDegradation);
  writer.put(0, 4);  // latency
  writer.put(mask_issue, 2);
  return sealed(writer);
}

Decoded<std::uint8_t> decode_type(const Message& message) {
  Checked checked{};
  std::uint32_t checksum = 0;
  for (std::size_t i = 0; i < kMessageBits; ++i) {
    const std::size_t word = i / 32;
    const std::size_t width = word + 1 < kWords ? 32 : kMessageBits - 32 * (kWords - 1);
    const std::uint32_t bit = message.words[word] >> (width - 1 - i % 32) & 1U;
    if (i < kCheckedBits) {
      const std::size_t to = i + kPaddingBits;
      checked[to / 8] = static_cast<std::uint8_t>(checked[to / 8] | bit << (7 - to % 8));
    } else {
      checksum = checksum << 1U | bit;
    }
  }
  const auto preamble = static_cast<std::uint8_t>(message.words[0] >> 24U);
  if (std::ranges::find(kPreambles, preamble) == kPreambles.end()) {
    return Malformed{"SBAS preamble", 0};
  }
  if (crc24q(checked) != checksum) {
    return Malformed{"SBAS checksum", kCheckedBits};
  }
  return {static_cast<std::uint8_t>(message.words[0] >> 18U & 0x3FU), kWords};
}

}  // namespace rigwire::protocols::sbas
