#include "protocols/can/bits.h"

#include <algorithm>

namespace rigwire::protocols::can {
namespace {

constexpr std::uint32_t kCrcPolynomial = 0x4599;  // ISO 11898-1: x15+x14+x10+x8+x7+x4+x3+1

/// Counts the bits of the stuffed part as they are sent.
class StuffedBits {
 public:
  void push(std::uint32_t value, unsigned width) {
    for (unsigned i = width; i-- > 0;) {
      const unsigned bit = (value >> i) & 1U;
      crc_ = ((crc_ << 1U) ^ ((((crc_ >> 14U) & 1U) ^ bit) != 0U ? kCrcPolynomial : 0U)) & 0x7FFFU;
      send(bit);
    }
  }

  unsigned finish() {
    const std::uint32_t crc = crc_;
    for (unsigned i = 15; i-- > 0;) {
      send((crc >> i) & 1U);
    }
    return count_;
  }

 private:
  void send(unsigned bit) {
    ++count_;
    run_ = bit == last_ ? run_ + 1 : 1;
    last_ = bit;
    if (run_ == 5) {
      ++count_;
      last_ = 1U - bit;
      run_ = 1;
    }
  }

  std::uint32_t crc_ = 0;
  unsigned count_ = 0;
  unsigned last_ = 2;  // neither 0 nor 1: the idle bus does not take part in stuffing
  unsigned run_ = 0;
};

unsigned data_bytes(const Frame& frame) {
  return frame.remote ? 0U : std::min<unsigned>(frame.length, 8U);
}

}  // namespace

unsigned unstuffed_bits(const Frame& frame) {
  return (frame.extended ? kExtendedOverheadBits : kBaseOverheadBits) + 8U * data_bytes(frame);
}

unsigned exact_bits(const Frame& frame) {
  const std::uint32_t remote = frame.remote ? 1U : 0U;
  StuffedBits bits;
  bits.push(0, 1);  // SOF
  if (frame.extended) {
    bits.push(frame.id >> 18U, 11);
    bits.push(0b11, 2);  // SRR, IDE
    bits.push(frame.id, 18);
    bits.push(remote, 1);
    bits.push(0, 2);  // r1, r0
  } else {
    bits.push(frame.id, 11);
    bits.push(remote, 1);
    bits.push(0, 2);  // IDE, r0
  }
  bits.push(frame.length, 4);
  for (unsigned i = 0; i < data_bytes(frame); ++i) {
    bits.push(frame.data[i], 8);
  }
  return bits.finish() + kTrailerBits + kInterframeBits;
}

unsigned worst_case_bits(const Frame& frame) {
  // One stuff bit per four bits after the first, over the stuffed part.
  const unsigned stuffed = unstuffed_bits(frame) - kTrailerBits - kInterframeBits;
  return unstuffed_bits(frame) + (stuffed - 1) / 4;
}

std::uint32_t arbitration_field(const Frame& frame) {
  const std::uint32_t remote = frame.remote ? 1U : 0U;
  if (frame.extended) {
    return (((frame.id >> 18U) & 0x7FFU) << 21U) | (0b11U << 19U) | ((frame.id & 0x3FFFFU) << 1U) |
           remote;
  }
  return ((frame.id & 0x7FFU) << 21U) | (remote << 20U);
}

}  // namespace rigwire::protocols::can
