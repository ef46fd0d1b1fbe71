#include "protocols/can/wire_frame.h"

#include <algorithm>

namespace rigwire::protocols::can {
namespace {

constexpr bool arbitrates(FrameField field) {
  return field >= FrameField::identifier_28_21 && field <= FrameField::remote_request;
}

}  // namespace

// Writes the fields of the base or extended frame format (ISO 11898-1:2015, 10.4) up to the CRC
// sequence. After five equal bits it inserts a stuff bit of the other level (10.5).
WireFrame::WireFrame(const Frame& frame) {
  unsigned run = 0;
  bool last = true;
  const auto push = [&](std::uint32_t value, unsigned width, FrameField field) {
    for (unsigned i = width; i-- > 0;) {
      const bool recessive = ((value >> i) & 1U) != 0;
      const auto tag = static_cast<std::uint8_t>(field);
      bits_[size_++] = static_cast<std::uint8_t>(tag | (recessive ? kRecessive : 0U));
      run = recessive == last && run > 0 ? run + 1 : 1;
      last = recessive;
      if (run == 5) {
        last = !recessive;
        run = 1;
        bits_[size_++] = static_cast<std::uint8_t>(tag | kStuffBit | (last ? kRecessive : 0U));
      }
    }
  };
  using enum FrameField;
  const std::uint32_t remote = frame.remote ? 1U : 0U;
  const std::uint32_t base = (frame.extended ? frame.id >> 18U : frame.id) & 0x7FFU;
  push(0, 1, start_of_frame);
  push(base >> 3U, 8, identifier_28_21);
  push(base, 3, identifier_20_18);
  if (frame.extended) {
    push(1, 1, substitute_remote);
    push(1, 1, identifier_extension);
    push(frame.id >> 13U, 5, identifier_17_13);
    push(frame.id >> 5U, 8, identifier_12_5);
    push(frame.id, 5, identifier_4_0);
    push(remote, 1, remote_request);
    push(0, 1, reserved_1);
  } else {
    push(remote, 1, substitute_remote);
    push(0, 1, identifier_extension);
  }
  push(0, 1, reserved_0);
  push(frame.length, 4, length_code);
  if (!frame.remote) {
    for (unsigned i = 0; i < std::min<unsigned>(frame.length, 8U); ++i) {
      push(frame.data[i], 8, data);
    }
  }
  push(checksum(frame), 15, crc_sequence);
}

bool WireFrame::in_arbitration(unsigned bit) const {
  return bit < size_ && !is_stuff_bit(bit) && arbitrates(field(bit));
}

bool WireFrame::is_arbitration_stuff_bit(unsigned bit) const {
  return is_stuff_bit(bit) && (arbitrates(field(bit)) || field(bit) == FrameField::start_of_frame);
}

FrameField WireFrame::field(unsigned bit) const {
  if (bit < size_) {
    return static_cast<FrameField>(bits_[bit] & kField);
  }
  switch (bit - size_) {
    case 0:
      return FrameField::crc_delimiter;
    case 1:
      return FrameField::acknowledge_slot;
    case 2:
      return FrameField::acknowledge_delimiter;
    default:
      return bit <= last_bit() ? FrameField::end_of_frame : FrameField::intermission;
  }
}

unsigned first_difference(const WireFrame& a, const WireFrame& b) {
  const unsigned end = std::max(a.last_bit(), b.last_bit()) + 1;
  unsigned bit = 0;
  while (bit < end && a.recessive(bit) == b.recessive(bit)) {
    ++bit;
  }
  return bit;
}

}  // namespace rigwire::protocols::can
