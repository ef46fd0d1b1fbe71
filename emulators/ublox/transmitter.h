// The transmitting half of a UART with its bounded buffer: bytes leave at 10 bits each, in chunks
// of at most 8 bytes that are due when their last bit has left.
//
// A message that does not fit into the buffer is lost as a whole, never in part.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "emulators/device.h"

namespace rigwire::emulators {

class UbloxTransmitter {
 public:
  static constexpr std::size_t kChunkBytes = 8;

  /// Without a speed (0) the line is off until it gets one.
  UbloxTransmitter(ByteOutput& output, std::size_t capacity_bytes, std::uint32_t baud);

  /// Puts a message behind what waits. Returns false, and counts it, when it does not fit or the
  /// line is off.
  bool enqueue(SimTime now, std::span<const std::uint8_t> message);

  /// Sends every chunk whose first bit leaves up to `now`.
  void advance(SimTime now);

  /// When the next chunk's first bit leaves; kNever when nothing waits.
  [[nodiscard]] SimTime next_event() const;

  /// Bytes that have not started yet leave at the new speed.
  void set_baud(std::uint32_t baud);
  [[nodiscard]] std::uint32_t baud() const { return baud_; }

  /// Forgets what waits and the peak (reset). A chunk on the line is finished.
  void clear();

  [[nodiscard]] std::size_t waiting() const { return size_; }
  [[nodiscard]] std::size_t room() const { return ring_.size() - size_; }
  [[nodiscard]] std::size_t capacity() const { return ring_.size(); }
  /// Most that ever waited at once since power-on.
  [[nodiscard]] std::size_t peak() const { return peak_; }
  [[nodiscard]] std::uint64_t messages_sent() const { return messages_sent_; }
  [[nodiscard]] std::uint64_t messages_lost() const { return messages_lost_; }
  [[nodiscard]] std::uint64_t bytes_sent() const { return bytes_sent_; }

 private:
  [[nodiscard]] SimTime after(std::uint64_t burst_bytes) const;

  ByteOutput& output_;
  std::vector<std::uint8_t> ring_;
  std::size_t head_ = 0;
  std::size_t size_ = 0;
  std::size_t peak_ = 0;
  std::uint32_t baud_;
  SimTime burst_start_ = kStart;   ///< Since then the line has been busy without a gap ...
  std::uint64_t burst_bytes_ = 0;  ///< ... with this many bytes, so that no rounding adds up.
  std::uint64_t messages_sent_ = 0;
  std::uint64_t messages_lost_ = 0;
  std::uint64_t bytes_sent_ = 0;
};

}  // namespace rigwire::emulators
