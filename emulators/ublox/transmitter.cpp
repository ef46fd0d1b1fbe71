#include "emulators/ublox/transmitter.h"

#include <algorithm>
#include <array>

namespace rigwire::emulators {
namespace {

constexpr std::uint64_t kBitsPerByte = 1 /*start*/ + 8 /*data*/ + 1 /*stop*/;

}  // namespace

UbloxTransmitter::UbloxTransmitter(ByteOutput& output, std::size_t capacity_bytes,
                                   std::uint32_t baud)
    : output_(output), ring_(capacity_bytes), baud_(baud) {}

SimTime UbloxTransmitter::after(std::uint64_t burst_bytes) const {
  const std::uint64_t bits = burst_bytes * kBitsPerByte;
  const std::uint64_t seconds = bits / baud_;
  const std::uint64_t rest_ns = (bits % baud_) * 1'000'000'000U / baud_;
  return burst_start_ + Duration{static_cast<std::int64_t>(seconds * 1'000'000'000U + rest_ns)};
}

bool UbloxTransmitter::enqueue(SimTime now, std::span<const std::uint8_t> message) {
  if (baud_ == 0 || message.size() > room()) {
    ++messages_lost_;
    return false;
  }
  if (size_ == 0 && after(burst_bytes_) <= now) {
    burst_start_ = now;
    burst_bytes_ = 0;
  }
  for (const std::uint8_t byte : message) {
    ring_[(head_ + size_) % ring_.size()] = byte;
    ++size_;
  }
  peak_ = std::max(peak_, size_);
  ++messages_sent_;
  return true;
}

void UbloxTransmitter::advance(SimTime now) {
  std::array<std::uint8_t, kChunkBytes> chunk{};
  while (next_event() <= now && size_ > 0) {
    const std::size_t count = std::min(size_, chunk.size());
    for (std::size_t i = 0; i < count; ++i) {
      chunk[i] = ring_[(head_ + i) % ring_.size()];
    }
    head_ = (head_ + count) % ring_.size();
    size_ -= count;
    burst_bytes_ += count;
    bytes_sent_ += count;
    output_.send(after(burst_bytes_), std::span(chunk).first(count));
  }
}

SimTime UbloxTransmitter::next_event() const {
  return size_ == 0 ? kNever : after(burst_bytes_);
}

void UbloxTransmitter::set_baud(std::uint32_t baud) {
  if (baud != baud_) {
    if (baud_ > 0) {
      burst_start_ = after(burst_bytes_);
    }
    burst_bytes_ = 0;
    baud_ = baud;
  }
}

void UbloxTransmitter::clear() {
  head_ = 0;
  size_ = 0;
  peak_ = 0;
}

}  // namespace rigwire::emulators
