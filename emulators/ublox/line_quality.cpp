#include "emulators/ublox/line_quality.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rigwire::emulators {
namespace {

constexpr std::size_t kLongestChunk = 8;
constexpr std::size_t kFrameBits = 1 /*start*/ + 8 /*data*/ + 1 /*stop*/;

/// Level of the line in a bit time of the sender; at rest (high) after the last one.
bool level(std::span<const std::uint8_t> bytes, std::size_t bit) {
  const std::size_t index = bit / kFrameBits;
  const std::size_t within = bit % kFrameBits;
  if (index >= bytes.size() || within == kFrameBits - 1) {
    return true;
  }
  return within != 0 && (bytes[index] >> (within - 1) & 1U) != 0;
}

}  // namespace

UbloxLineQuality::UbloxLineQuality(ByteOutput& output, std::uint64_t seed)
    : output_(output), random_(seed) {}

void UbloxLineQuality::set_bit_error_rate(double rate) {
  if (rate != bit_error_rate_) {
    bit_error_rate_ = rate;
    draw_gap();
  }
}

/// Geometric distribution of the gap between two errors.
void UbloxLineQuality::draw_gap() {
  if (bit_error_rate_ > 0.0) {
    const double above_zero = random_.uniform() + 0x1p-53;
    const double gap = std::floor(std::log(above_zero) / std::log1p(-bit_error_rate_));
    good_bits_left_ = static_cast<std::uint64_t>(std::min(gap, 1e18));
  }
}

void UbloxLineQuality::disturb(std::span<std::uint8_t> bytes) {
  if (!noisy()) {
    return;
  }
  const std::uint64_t bits = bytes.size() * 8;
  std::uint64_t at = good_bits_left_;
  while (at < bits) {
    bytes[at / 8] = static_cast<std::uint8_t>(bytes[at / 8] ^ 1U << at % 8);
    draw_gap();
    at += 1 + good_bits_left_;
  }
  good_bits_left_ = at - bits;
}

void UbloxLineQuality::send(SimTime due, std::span<const std::uint8_t> bytes) {
  if (matched() && !noisy()) {
    output_.send(due, bytes);
    return;
  }
  std::array<std::uint8_t, kLongestChunk> chunk{};
  const auto disturbed = std::span(chunk).first(std::min(bytes.size(), chunk.size()));
  std::ranges::copy(bytes.first(disturbed.size()), disturbed.begin());
  disturb(disturbed);
  if (matched()) {
    output_.send(due, disturbed);
    return;
  }
  std::array<std::uint8_t, kLongestChunk * kFrameBits / 2> read{};
  const std::size_t count = read_at_wrong_speed(disturbed, device_baud_, client_baud_, read);
  for (std::size_t at = 0; at < count; at += kLongestChunk) {
    output_.send(due, std::span(read).subspan(at, std::min(kLongestChunk, count - at)));
  }
}

std::size_t read_at_wrong_speed(std::span<const std::uint8_t> bytes, std::uint32_t from_baud,
                                std::uint32_t to_baud, std::span<std::uint8_t> out) {
  const double bit = static_cast<double>(from_baud) / to_baud;  // the reader's, in sender's bits
  const std::size_t end = bytes.size() * kFrameBits;
  const auto level_after = [&](std::size_t start, double reader_bits) {
    return level(bytes, start + static_cast<std::size_t>(reader_bits * bit));
  };
  std::size_t count = 0;
  for (std::size_t at = 0; at < end && count < out.size();) {
    if (level(bytes, at)) {
      ++at;
      continue;
    }
    std::uint8_t value = 0;
    for (unsigned i = 0; i < 8; ++i) {
      if (level_after(at, 1.5 + i)) {
        value = static_cast<std::uint8_t>(value | 1U << i);
      }
    }
    out[count++] = value;
    constexpr double kStopBit = 9.5;
    at += std::max<std::size_t>(1, static_cast<std::size_t>(kStopBit * bit));
    while (at < end && !level(bytes, at)) {  // no stop bit: wait for the line to rest
      ++at;
    }
  }
  return count;
}

}  // namespace rigwire::emulators
