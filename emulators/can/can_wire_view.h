// A frame as nodes with the segment's bit rate read it off the wire.
//
// That of a sender with the same rate is the frame itself. One with another rate is sampled at 80 %
// of each of the segment's bits, from the edge of its start of frame on, without resynchronisation.
#pragma once

#include <cstdint>

#include "protocols/can/wire_frame.h"

namespace rigwire::emulators {

class CanWireView {
 public:
  CanWireView() = default;
  CanWireView(const protocols::can::Frame& frame, std::uint32_t sender_bps,
              std::uint32_t segment_bps)
      : wire_(frame), sender_bps_(sender_bps), segment_bps_(segment_bps) {}

  [[nodiscard]] bool readable() const { return sender_bps_ == segment_bps_; }
  [[nodiscard]] const protocols::can::WireFrame& wire() const { return wire_; }
  /// The sender's bit in the segment's bit of that number.
  [[nodiscard]] unsigned bit_at(unsigned bit) const {
    return readable() ? bit : sampled(bit, segment_bps_, sender_bps_);
  }
  [[nodiscard]] bool recessive(unsigned bit) const { return wire_.recessive(bit_at(bit)); }

  /// In which of the segment's bits a node with another rate finds the frame wrong: a stuff error
  /// in what it samples, or the checksum at the end.
  [[nodiscard]] unsigned misread_at(std::uint32_t reader_bps) const {
    unsigned run = 0;
    bool last = true;
    for (unsigned sample = 0;; ++sample) {
      const unsigned bit = sampled(sample, reader_bps, segment_bps_);
      const bool level = recessive(bit);
      run = level == last && run > 0 ? run + 1 : 1;
      last = level;
      if (run == 6 || bit_at(bit) > wire_.acknowledge_slot()) {
        return bit;
      }
    }
  }

 private:
  static constexpr unsigned sampled(unsigned bit, std::uint32_t reader_bps,
                                    std::uint32_t writer_bps) {
    return static_cast<unsigned>((bit * 10ULL + 8U) * writer_bps / (10ULL * reader_bps));
  }

  protocols::can::WireFrame wire_;
  std::uint32_t sender_bps_ = 1;
  std::uint32_t segment_bps_ = 1;
};

}  // namespace rigwire::emulators
