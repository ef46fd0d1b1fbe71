#include "protocols/can/bits.h"

#include <algorithm>
#include <array>

namespace rigwire::protocols::can {
namespace {

constexpr std::uint32_t kCrcPolynomial = 0x4599;  // ISO 11898-1: x15+x14+x10+x8+x7+x4+x3+1
constexpr unsigned kCrcBits = 15;
constexpr unsigned kLongestRun = 5;  // After five equal bits comes a stuff bit.

constexpr std::uint32_t crc_step(std::uint32_t crc, unsigned bit) {
  return ((crc << 1U) ^ (((crc >> 14U) & 1U) != bit ? kCrcPolynomial : 0U)) & 0x7FFFU;
}

/// The remainder that eight bits leave of the upper eight of the register.
constexpr std::array<std::uint16_t, 256> make_crc_table() {
  std::array<std::uint16_t, 256> table{};
  for (unsigned byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte << 7U;
    for (unsigned i = 0; i < 8; ++i) {
      crc = crc_step(crc, 0);
    }
    table[byte] = static_cast<std::uint16_t>(crc);
  }
  return table;
}

/// What stuffing remembers: the last bit sent and how many equal ones it ends, 1 .. 5; 2 (run - 1)
/// + bit.
constexpr unsigned kStuffStates = 2 * kLongestRun;
struct StuffStep {
  std::uint8_t state;
  std::uint8_t stuff_bits;
};
constexpr StuffStep stuff_step(StuffStep from, unsigned bit) {
  const unsigned run = bit == (from.state & 1U) ? from.state / 2U + 2U : 1U;
  if (run < kLongestRun) {
    return {static_cast<std::uint8_t>(2 * (run - 1) + bit), from.stuff_bits};
  }
  return {static_cast<std::uint8_t>(1U - bit), static_cast<std::uint8_t>(from.stuff_bits + 1U)};
}
using StuffTable = std::array<std::array<StuffStep, 256>, kStuffStates>;
constexpr StuffTable make_stuff_table() {
  StuffTable table{};
  for (unsigned state = 0; state < kStuffStates; ++state) {
    for (unsigned byte = 0; byte < 256; ++byte) {
      StuffStep step{static_cast<std::uint8_t>(state), 0};
      for (unsigned i = 8; i-- > 0;) {
        step = stuff_step(step, (byte >> i) & 1U);
      }
      table[state][byte] = step;
    }
  }
  return table;
}

constexpr std::array<std::uint16_t, 256> kCrcTable = make_crc_table();
constexpr StuffTable kStuffTable = make_stuff_table();

unsigned data_bytes(const Frame& frame) {
  return frame.remote ? 0U : std::min<unsigned>(frame.length, 8U);
}

/// Start of frame, arbitration and control field, and how many bits that is.
struct Head {
  std::uint64_t bits;
  unsigned width;
};
Head head_of(const Frame& frame) {
  const std::uint64_t remote = frame.remote ? 1U : 0U;
  const std::uint64_t length = frame.length & 0xFU;
  if (frame.extended) {
    const std::uint64_t base = (frame.id >> 18U) & 0x7FFU;
    const std::uint64_t extension = frame.id & 0x3FFFFU;
    return {(base << 27U) | (0b11ULL << 25U) | (extension << 7U) | (remote << 6U) | length, 39};
  }
  const std::uint64_t base = frame.id & 0x7FFU;
  return {(base << 7U) | (remote << 6U) | length, 19};
}

}  // namespace

unsigned unstuffed_bits(const Frame& frame) {
  return (frame.extended ? kExtendedOverheadBits : kBaseOverheadBits) + 8U * data_bytes(frame);
}

std::uint16_t checksum(const Frame& frame) {
  // Zeros in front of the first bit leave the register at zero, so the head is taken as bytes.
  const Head head = head_of(frame);
  std::uint32_t crc = 0;
  const auto push = [&crc](std::uint64_t byte) {
    crc = ((crc << 8U) & 0x7FFFU) ^ kCrcTable[((crc >> 7U) ^ byte) & 0xFFU];
  };
  for (unsigned shift = head.width > 24 ? 40 : 24; shift > 0;) {
    shift -= 8;
    push(head.bits >> shift);
  }
  for (unsigned i = 0; i < data_bytes(frame); ++i) {
    push(frame.data[i]);
  }
  return static_cast<std::uint16_t>(crc);
}

unsigned exact_bits(const Frame& frame) {
  // Pads to whole bytes: alternating bits before the start of frame that end with a recessive one.
  // They need no stuff bits, and the start of frame begins a run of its own after them.
  const Head head = head_of(frame);
  const unsigned bytes = data_bytes(frame);
  const unsigned padding = (8U - (head.width + kCrcBits) % 8U) % 8U;
  StuffStep state{1, 0};  // One recessive bit.
  unsigned stuff_bits = 0;
  const auto push = [&state, &stuff_bits](std::uint64_t byte) {
    state = kStuffTable[state.state][byte & 0xFFU];
    stuff_bits += state.stuff_bits;
  };
  std::uint64_t carry = ((0x5555'5555ULL & ((1ULL << padding) - 1U)) << head.width) | head.bits;
  unsigned width = padding + head.width;
  const auto drain = [&] {
    while (width >= 8) {
      width -= 8;
      push(carry >> width);
    }
    carry &= (1ULL << width) - 1U;
  };
  drain();
  for (unsigned i = 0; i < bytes; ++i) {
    carry = (carry << 8U) | frame.data[i];
    width += 8;
    drain();
  }
  carry = (carry << kCrcBits) | checksum(frame);
  width += kCrcBits;
  drain();
  return unstuffed_bits(frame) + stuff_bits;
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
