// Requests, both directions.
#include <algorithm>

#include "protocols/bytes.h"
#include "protocols/modbus/pdu.h"
#include "protocols/modbus/pdu_layout.h"
#include "protocols/modbus/pdu_writer.h"

namespace rigwire::protocols::modbus {
namespace {

using Bytes = std::span<const std::uint8_t>;
using Decoding = std::variant<Request, Refusal>;

std::uint16_t word(Bytes pdu, std::size_t offset) {
  return load_big<std::uint16_t>(pdu, offset);
}

Refusal refuse(Bytes pdu, ExceptionCode code) {
  return {static_cast<std::uint8_t>(pdu[0] & ~kExceptionFlag), code, false};
}
Refusal wrong_value(Bytes pdu) {
  return refuse(pdu, ExceptionCode::illegal_data_value);
}
Refusal wrong_address(Bytes pdu) {
  return refuse(pdu, ExceptionCode::illegal_data_address);
}
Refusal wrong_length(Bytes pdu) {
  Refusal refusal = wrong_value(pdu);
  refusal.wrong_length = true;
  return refusal;
}

bool in_range(std::size_t quantity, std::size_t maximum) {
  return quantity >= 1 && quantity <= maximum;
}
bool past_the_table(std::uint16_t address, std::size_t quantity) {
  return address + quantity > kTableSize;
}

Decoding decode_read(Bytes pdu, std::size_t maximum) {
  if (pdu.size() != layout::kPlainSize) {
    return wrong_length(pdu);
  }
  const std::uint16_t address = word(pdu, layout::kAddress);
  const std::uint16_t quantity = word(pdu, layout::kQuantity);
  if (!in_range(quantity, maximum)) {
    return wrong_value(pdu);
  }
  if (past_the_table(address, quantity)) {
    return wrong_address(pdu);
  }
  switch (static_cast<Function>(pdu[0])) {
    case Function::read_coils:
      return ReadBits{BitTable::coils, address, quantity};
    case Function::read_discrete_inputs:
      return ReadBits{BitTable::discrete_inputs, address, quantity};
    case Function::read_holding_registers:
      return ReadRegisters{RegisterTable::holding, address, quantity};
    default:
      return ReadRegisters{RegisterTable::input, address, quantity};
  }
}

Decoding decode_write_coil(Bytes pdu) {
  if (pdu.size() != layout::kPlainSize) {
    return wrong_length(pdu);
  }
  const std::uint16_t value = word(pdu, layout::kValue);
  if (value != kCoilOn && value != kCoilOff) {
    return wrong_value(pdu);
  }
  return WriteCoil{word(pdu, layout::kAddress), value == kCoilOn};
}

Decoding decode_write_register(Bytes pdu) {
  if (pdu.size() != layout::kPlainSize) {
    return wrong_length(pdu);
  }
  return WriteRegister{word(pdu, layout::kAddress), word(pdu, layout::kValue)};
}

Decoding decode_mask_write(Bytes pdu) {
  if (pdu.size() != layout::kMaskWriteSize) {
    return wrong_length(pdu);
  }
  return MaskWriteRegister{word(pdu, layout::kAddress), word(pdu, layout::kAndMask),
                           word(pdu, layout::kOrMask)};
}

RegisterBlock load_registers(Bytes pdu, std::size_t offset, std::size_t count) {
  RegisterBlock block;
  block.count = count;
  for (std::size_t i = 0; i < count; ++i) {
    block.values[i] = word(pdu, offset + 2 * i);
  }
  return block;
}

Decoding decode_write_coils(Bytes pdu) {
  if (pdu.size() < layout::kWriteData) {
    return wrong_length(pdu);
  }
  const std::size_t quantity = word(pdu, layout::kQuantity);
  const std::size_t byte_count = pdu[layout::kWriteByteCount];
  if (!in_range(quantity, kWriteCoilsMaximum) || byte_count != (quantity + 7) / 8) {
    return wrong_value(pdu);
  }
  if (pdu.size() != layout::kWriteData + byte_count) {
    return wrong_length(pdu);
  }
  if (past_the_table(word(pdu, layout::kAddress), quantity)) {
    return wrong_address(pdu);
  }
  WriteCoils request{word(pdu, layout::kAddress), {}};
  request.coils.count = quantity;
  std::ranges::copy(pdu.subspan(layout::kWriteData), request.coils.packed.begin());
  for (std::size_t padding = quantity; padding < byte_count * 8; ++padding) {
    request.coils.set(padding, false);
  }
  return request;
}

Decoding decode_write_registers(Bytes pdu) {
  if (pdu.size() < layout::kWriteData) {
    return wrong_length(pdu);
  }
  const std::size_t quantity = word(pdu, layout::kQuantity);
  const std::size_t byte_count = pdu[layout::kWriteByteCount];
  if (!in_range(quantity, kWriteRegistersMaximum) || byte_count != 2 * quantity) {
    return wrong_value(pdu);
  }
  if (pdu.size() != layout::kWriteData + byte_count) {
    return wrong_length(pdu);
  }
  if (past_the_table(word(pdu, layout::kAddress), quantity)) {
    return wrong_address(pdu);
  }
  return WriteRegisters{word(pdu, layout::kAddress),
                        load_registers(pdu, layout::kWriteData, quantity)};
}

Decoding decode_read_write(Bytes pdu) {
  if (pdu.size() < layout::kReadWriteData) {
    return wrong_length(pdu);
  }
  const std::uint16_t read_quantity = word(pdu, layout::kReadQuantity);
  const std::size_t write_quantity = word(pdu, layout::kWriteQuantity);
  const std::size_t byte_count = pdu[layout::kReadWriteByteCount];
  if (!in_range(read_quantity, kReadWriteReadMaximum) ||
      !in_range(write_quantity, kReadWriteWriteMaximum) || byte_count != 2 * write_quantity) {
    return wrong_value(pdu);
  }
  if (pdu.size() != layout::kReadWriteData + byte_count) {
    return wrong_length(pdu);
  }
  if (past_the_table(word(pdu, layout::kReadAddress), read_quantity) ||
      past_the_table(word(pdu, layout::kWriteAddress), write_quantity)) {
    return wrong_address(pdu);
  }
  return ReadWriteRegisters{word(pdu, layout::kReadAddress), read_quantity,
                            word(pdu, layout::kWriteAddress),
                            load_registers(pdu, layout::kReadWriteData, write_quantity)};
}

Decoding decode_identification(Bytes pdu) {
  if (pdu.size() > layout::kInterface &&
      pdu[layout::kInterface] != kDeviceIdentificationInterface) {
    return refuse(pdu, ExceptionCode::illegal_function);
  }
  if (pdu.size() != layout::kIdentificationRequestSize) {
    return wrong_length(pdu);
  }
  const std::uint8_t access = pdu[layout::kAccess];
  if (access < static_cast<std::uint8_t>(IdentificationAccess::basic) ||
      access > static_cast<std::uint8_t>(IdentificationAccess::individual)) {
    return wrong_value(pdu);
  }
  return ReadDeviceIdentification{static_cast<IdentificationAccess>(access), pdu[layout::kObject]};
}

/// One overload per request.
struct RequestEncoder {
  Pdu operator()(const ReadBits& r) const {
    return plain(r.table == BitTable::coils ? Function::read_coils : Function::read_discrete_inputs,
                 r.address, r.quantity);
  }
  Pdu operator()(const ReadRegisters& r) const {
    return plain(r.table == RegisterTable::holding ? Function::read_holding_registers
                                                   : Function::read_input_registers,
                 r.address, r.quantity);
  }
  Pdu operator()(const WriteCoil& r) const { return encode_echo(r); }
  Pdu operator()(const WriteRegister& r) const { return encode_echo(r); }
  Pdu operator()(const MaskWriteRegister& r) const { return encode_echo(r); }
  Pdu operator()(const WriteCoils& r) const {
    PduWriter writer(Function::write_coils);
    writer.word(r.address);
    writer.word(static_cast<std::uint16_t>(r.coils.count));
    writer.byte(static_cast<std::uint8_t>(r.coils.bytes().size()));
    writer.bytes(r.coils.bytes());
    return writer.take();
  }
  Pdu operator()(const WriteRegisters& r) const {
    PduWriter writer(Function::write_registers);
    writer.word(r.address);
    writer.word(static_cast<std::uint16_t>(r.registers.count));
    writer.counted_words(r.registers.view());
    return writer.take();
  }
  Pdu operator()(const ReportServerId&) const {
    return PduWriter(Function::report_server_id).take();
  }
  Pdu operator()(const ReadWriteRegisters& r) const {
    PduWriter writer(Function::read_write_registers);
    writer.word(r.read_address);
    writer.word(r.read_quantity);
    writer.word(r.write_address);
    writer.word(static_cast<std::uint16_t>(r.registers.count));
    writer.counted_words(r.registers.view());
    return writer.take();
  }
  Pdu operator()(const ReadDeviceIdentification& r) const {
    PduWriter writer(Function::encapsulated_interface);
    writer.byte(kDeviceIdentificationInterface);
    writer.byte(static_cast<std::uint8_t>(r.access));
    writer.byte(r.object);
    return writer.take();
  }

 private:
  static Pdu plain(Function function, std::uint16_t address, std::uint16_t quantity) {
    PduWriter writer(function);
    writer.word(address);
    writer.word(quantity);
    return writer.take();
  }
};

}  // namespace

std::variant<Request, Refusal> decode_request(std::span<const std::uint8_t> pdu) {
  assert(!pdu.empty());
  switch (static_cast<Function>(pdu[layout::kFunction])) {
    case Function::read_coils:
    case Function::read_discrete_inputs:
      return decode_read(pdu, kReadBitsMaximum);
    case Function::read_holding_registers:
    case Function::read_input_registers:
      return decode_read(pdu, kReadRegistersMaximum);
    case Function::write_coil:
      return decode_write_coil(pdu);
    case Function::write_register:
      return decode_write_register(pdu);
    case Function::write_coils:
      return decode_write_coils(pdu);
    case Function::write_registers:
      return decode_write_registers(pdu);
    case Function::report_server_id:
      return pdu.size() == 1 ? Decoding(ReportServerId{}) : Decoding(wrong_length(pdu));
    case Function::mask_write_register:
      return decode_mask_write(pdu);
    case Function::read_write_registers:
      return decode_read_write(pdu);
    case Function::encapsulated_interface:
      return decode_identification(pdu);
  }
  return refuse(pdu, ExceptionCode::illegal_function);
}

Pdu encode_request(const Request& request) {
  return std::visit(RequestEncoder{}, request);
}

}  // namespace rigwire::protocols::modbus
