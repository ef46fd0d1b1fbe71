// A frame as the levels on the wire, bit by bit, and what each of them belongs to.
//
// Source: ISO 11898-1:2015, 10.4 (frame formats), 10.5 (bit stuffing). Recessive is true. For what
// happens within a frame: errors, collisions. For its length alone use bits.h, which is much
// quicker.
#pragma once

#include <array>
#include <cstdint>

#include "protocols/can/bits.h"
#include "protocols/can/controller_report.h"
#include "protocols/can/frame.h"

namespace rigwire::protocols::can {

/// Start of frame .. CRC of the longest frame: 118 bits and a stuff bit per four after the first.
inline constexpr unsigned kMostStuffedBits = 118 + 117 / 4;
static_assert(kMostStuffedBits == 147);

class WireFrame {
 public:
  WireFrame() = default;
  explicit WireFrame(const Frame& frame);

  /// Bits from start of frame to the end of the CRC sequence: number of the CRC delimiter.
  [[nodiscard]] unsigned stuffed_bits() const { return size_; }
  /// Numbers of single bits, start of frame 0, stuff bits counted.
  [[nodiscard]] unsigned acknowledge_slot() const { return size_ + 1; }
  [[nodiscard]] unsigned last_bit() const { return size_ + kTrailerBits - 1; }

  /// What the transmitter sends; recessive from the CRC delimiter on.
  [[nodiscard]] bool recessive(unsigned bit) const {
    return bit >= size_ || (bits_[bit] & kRecessive) != 0;
  }
  [[nodiscard]] bool is_stuff_bit(unsigned bit) const {
    return bit < size_ && (bits_[bit] & kStuffBit) != 0;
  }
  /// Where a transmitter that reads dominant for its recessive bit has lost arbitration:
  /// identifier, SRR, IDE and RTR, without stuff bits.
  [[nodiscard]] bool in_arbitration(unsigned bit) const;
  /// Whether the bit is a stuff bit in front of the RTR bit's end.
  [[nodiscard]] bool is_arbitration_stuff_bit(unsigned bit) const;
  /// A stuff bit belongs to the field of the bit before it.
  [[nodiscard]] FrameField field(unsigned bit) const;

 private:
  static constexpr std::uint8_t kRecessive = 0x80;
  static constexpr std::uint8_t kStuffBit = 0x40;
  static constexpr std::uint8_t kField = 0x3F;

  std::array<std::uint8_t, kMostStuffedBits> bits_{};
  unsigned size_ = 0;
};

/// Number of the first bit in which both differ; the greater last_bit() + 1 when there is none.
[[nodiscard]] unsigned first_difference(const WireFrame& a, const WireFrame& b);

}  // namespace rigwire::protocols::can
