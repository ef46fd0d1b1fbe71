// Responses, both directions.
#include <algorithm>

#include "protocols/bytes.h"
#include "protocols/modbus/pdu.h"
#include "protocols/modbus/pdu_layout.h"
#include "protocols/modbus/pdu_writer.h"

namespace rigwire::protocols::modbus {
namespace {

using Bytes = std::span<const std::uint8_t>;

std::uint16_t word(Bytes pdu, std::size_t offset) {
  return load_big<std::uint16_t>(pdu, offset);
}

/// Messages with a byte count: their size once the count is known.
Decoded<Response> decode_counted(Bytes pdu) {
  if (pdu.size() < layout::kData) {
    return Incomplete{layout::kData, pdu.size()};
  }
  const auto function = static_cast<Function>(pdu[0]);
  const std::size_t count = pdu[layout::kByteCount];
  const std::size_t size = layout::kData + count;
  if (size > kPduMaximum) {
    return Malformed{"byte count beyond the PDU", layout::kByteCount};
  }
  if (function == Function::report_server_id) {
    if (pdu.size() < size) {
      return Incomplete{size, pdu.size()};
    }
    ServerIdResponse response;
    response.size = count;
    std::ranges::copy(pdu.subspan(layout::kData, count), response.data.begin());
    return {Response(response), size};
  }
  const bool bits = function == Function::read_coils || function == Function::read_discrete_inputs;
  if (count == 0 || count > 250 || (!bits && count % 2 != 0)) {
    return Malformed{"byte count that no request asks for", layout::kByteCount};
  }
  if (pdu.size() < size) {
    return Incomplete{size, pdu.size()};
  }
  if (bits) {
    ReadBitsResponse response;
    response.table = function == Function::read_coils ? BitTable::coils : BitTable::discrete_inputs;
    response.bits.count = 8 * count;
    std::ranges::copy(pdu.subspan(layout::kData, count), response.bits.packed.begin());
    return {Response(response), size};
  }
  RegistersResponse response{function, {}};
  response.registers.count = count / 2;
  for (std::size_t i = 0; i < response.registers.count; ++i) {
    response.registers.values[i] = word(pdu, layout::kData + 2 * i);
  }
  return {Response(response), size};
}

Decoded<Response> decode_echo(Bytes pdu) {
  const auto function = static_cast<Function>(pdu[0]);
  const std::size_t size =
      function == Function::mask_write_register ? layout::kMaskWriteSize : layout::kPlainSize;
  if (pdu.size() < size) {
    return Incomplete{size, pdu.size()};
  }
  const std::uint16_t address = word(pdu, layout::kAddress);
  const std::uint16_t second = word(pdu, layout::kValue);
  switch (function) {
    case Function::write_coil:
      if (second != kCoilOn && second != kCoilOff) {
        return Malformed{"coil value neither 0000 nor FF00", layout::kValue};
      }
      return {Response(WriteCoil{address, second == kCoilOn}), size};
    case Function::write_register:
      return {Response(WriteRegister{address, second}), size};
    case Function::mask_write_register:
      return {Response(MaskWriteRegister{address, second, word(pdu, layout::kOrMask)}), size};
    default: {
      const std::size_t maximum =
          function == Function::write_coils ? kWriteCoilsMaximum : kWriteRegistersMaximum;
      if (second == 0 || second > maximum) {
        return Malformed{"quantity that no request can have", layout::kQuantity};
      }
      return {Response(WriteManyResponse{function, address, second}), size};
    }
  }
}

Decoded<Response> decode_identification(Bytes pdu) {
  if (pdu.size() < layout::kObjects) {
    return Incomplete{layout::kObjects, pdu.size()};
  }
  if (pdu[layout::kInterface] != kDeviceIdentificationInterface) {
    return Malformed{"encapsulated interface other than 14", layout::kInterface};
  }
  const std::uint8_t access = pdu[layout::kAccess];
  const std::uint8_t more = pdu[layout::kMoreFollows];
  if (access < 1 || access > 4) {
    return Malformed{"identification access outside 1..4", layout::kAccess};
  }
  if (more != 0x00 && more != 0xFF) {
    return Malformed{"more-follows neither 00 nor FF", layout::kMoreFollows};
  }
  DeviceIdentificationResponse response;
  response.access = static_cast<IdentificationAccess>(access);
  response.conformity = pdu[layout::kConformity];
  response.more_follows = more == 0xFF;
  response.next_object = pdu[layout::kNextObject];
  response.count = pdu[layout::kObjectCount];
  std::size_t end = layout::kObjects;
  for (std::size_t i = 0; i < response.count; ++i) {
    const std::size_t text = end + 2;  // identifier, length
    const std::size_t next = text + (text <= pdu.size() ? pdu[end + 1] : 0U);
    if (next > kPduMaximum) {
      return Malformed{"object beyond the PDU", end};
    }
    if (next > pdu.size()) {
      return Incomplete{next, pdu.size()};
    }
    end = next;
  }
  response.size = end - layout::kObjects;
  std::ranges::copy(pdu.subspan(layout::kObjects, response.size), response.objects.begin());
  return {Response(response), end};
}

Decoded<Response> decode_exception(Bytes pdu) {
  if (pdu.size() < layout::kExceptionSize) {
    return Incomplete{layout::kExceptionSize, pdu.size()};
  }
  return {Response(ExceptionResponse{static_cast<std::uint8_t>(pdu[0] & ~kExceptionFlag),
                                     static_cast<ExceptionCode>(pdu[layout::kExceptionCode])}),
          layout::kExceptionSize};
}

/// One overload per response.
struct ResponseEncoder {
  Pdu operator()(const ReadBitsResponse& r) const {
    PduWriter writer(r.table == BitTable::coils ? Function::read_coils
                                                : Function::read_discrete_inputs);
    writer.byte(static_cast<std::uint8_t>(r.bits.bytes().size()));
    writer.bytes(r.bits.bytes());
    return writer.take();
  }
  Pdu operator()(const RegistersResponse& r) const {
    PduWriter writer(r.function);
    writer.counted_words(r.registers.view());
    return writer.take();
  }
  Pdu operator()(const WriteCoil& r) const { return encode_echo(r); }
  Pdu operator()(const WriteRegister& r) const { return encode_echo(r); }
  Pdu operator()(const MaskWriteRegister& r) const { return encode_echo(r); }
  Pdu operator()(const WriteManyResponse& r) const {
    PduWriter writer(r.function);
    writer.word(r.address);
    writer.word(r.quantity);
    return writer.take();
  }
  Pdu operator()(const ServerIdResponse& r) const {
    PduWriter writer(Function::report_server_id);
    writer.byte(static_cast<std::uint8_t>(r.size));
    writer.bytes(r.view());
    return writer.take();
  }
  Pdu operator()(const DeviceIdentificationResponse& r) const {
    PduWriter writer(Function::encapsulated_interface);
    writer.byte(kDeviceIdentificationInterface);
    writer.byte(static_cast<std::uint8_t>(r.access));
    writer.byte(r.conformity);
    writer.byte(r.more_follows ? 0xFF : 0x00);
    writer.byte(r.next_object);
    writer.byte(r.count);
    writer.bytes(std::span(r.objects).first(r.size));
    return writer.take();
  }
  Pdu operator()(const ExceptionResponse& r) const {
    PduWriter writer(static_cast<std::uint8_t>(r.function | kExceptionFlag));
    writer.byte(static_cast<std::uint8_t>(r.code));
    return writer.take();
  }
};

}  // namespace

Decoded<Response> decode_response(std::span<const std::uint8_t> pdu) {
  if (pdu.empty()) {
    return Incomplete{layout::kExceptionSize, 0};
  }
  if ((pdu[0] & kExceptionFlag) != 0) {
    return decode_exception(pdu);
  }
  switch (static_cast<Function>(pdu[layout::kFunction])) {
    case Function::read_coils:
    case Function::read_discrete_inputs:
    case Function::read_holding_registers:
    case Function::read_input_registers:
    case Function::read_write_registers:
    case Function::report_server_id:
      return decode_counted(pdu);
    case Function::write_coil:
    case Function::write_register:
    case Function::write_coils:
    case Function::write_registers:
    case Function::mask_write_register:
      return decode_echo(pdu);
    case Function::encapsulated_interface:
      return decode_identification(pdu);
  }
  return Malformed{"function code that is not spoken here", 0};
}

Pdu encode_response(const Response& response) {
  return std::visit(ResponseEncoder{}, response);
}

}  // namespace rigwire::protocols::modbus
