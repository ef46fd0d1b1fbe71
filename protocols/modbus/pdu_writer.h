// Appends fields to a PDU, most significant byte first. Used by the encoders of this folder only.
#pragma once

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>

#include "protocols/bytes.h"
#include "protocols/modbus/pdu.h"

namespace rigwire::protocols::modbus {

class PduWriter {
 public:
  explicit PduWriter(Function function) { byte(static_cast<std::uint8_t>(function)); }
  explicit PduWriter(std::uint8_t function) { byte(function); }

  void byte(std::uint8_t value) {
    assert(pdu_.size < kPduMaximum);
    pdu_.bytes[pdu_.size++] = value;
  }
  void word(std::uint16_t value) {
    assert(pdu_.size + 2 <= kPduMaximum);
    store_big(std::span(pdu_.bytes), pdu_.size, value);
    pdu_.size += 2;
  }
  void bytes(std::span<const std::uint8_t> values) {
    assert(pdu_.size + values.size() <= kPduMaximum);
    std::ranges::copy(values, std::span(pdu_.bytes).subspan(pdu_.size).begin());
    pdu_.size += values.size();
  }
  /// Byte count, then the words.
  void counted_words(std::span<const std::uint16_t> values) {
    byte(static_cast<std::uint8_t>(2 * values.size()));
    for (const std::uint16_t value : values) {
      word(value);
    }
  }
  [[nodiscard]] Pdu take() const { return pdu_; }

 private:
  Pdu pdu_;
};

// The three messages that are the same as request and as response.
[[nodiscard]] inline Pdu encode_echo(const WriteCoil& message) {
  PduWriter writer(Function::write_coil);
  writer.word(message.address);
  writer.word(message.on ? kCoilOn : kCoilOff);
  return writer.take();
}
[[nodiscard]] inline Pdu encode_echo(const WriteRegister& message) {
  PduWriter writer(Function::write_register);
  writer.word(message.address);
  writer.word(message.value);
  return writer.take();
}
[[nodiscard]] inline Pdu encode_echo(const MaskWriteRegister& message) {
  PduWriter writer(Function::mask_write_register);
  writer.word(message.address);
  writer.word(message.and_mask);
  writer.word(message.or_mask);
  return writer.take();
}

}  // namespace rigwire::protocols::modbus
