#include "protocols/modbus/pdu.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <span>

#include "protocols/bytes.h"

namespace rigwire::protocols::modbus {

using Bytes = std::span<const std::uint8_t>;
using Decoding = std::variant<Request, Refusal>;
using SerialDecoding = std::variant<SerialRequest, Refusal>;

namespace {

/// Where the fields of a PDU are: the one table that the encoders and decoders of both directions
/// share. Offsets count from the function code. Source: V1.1b3, section 6.
namespace layout {

constexpr std::size_t kFunction = 0;

// Requests 1-6, 15, 16, 22 and the echoes of 5, 6, 15, 16, 22.
constexpr std::size_t kAddress = kFunction + 1;
constexpr std::size_t kQuantity = kAddress + 2;  // 5, 6: value; 22: AND mask
constexpr std::size_t kValue = kQuantity;
constexpr std::size_t kAndMask = kQuantity;
constexpr std::size_t kPlainSize = kQuantity + 2;  // 1-6, echoes of 15 and 16
constexpr std::size_t kOrMask = kAndMask + 2;
constexpr std::size_t kMaskWriteSize = kOrMask + 2;
constexpr std::size_t kWriteByteCount = kQuantity + 2;  // requests 15, 16
constexpr std::size_t kWriteData = kWriteByteCount + 1;
static_assert(kPlainSize == 5 && kMaskWriteSize == 7 && kWriteData == 6);

// Request 23.
constexpr std::size_t kReadAddress = kFunction + 1;
constexpr std::size_t kReadQuantity = kReadAddress + 2;
constexpr std::size_t kWriteAddress = kReadQuantity + 2;
constexpr std::size_t kWriteQuantity = kWriteAddress + 2;
constexpr std::size_t kReadWriteByteCount = kWriteQuantity + 2;
constexpr std::size_t kReadWriteData = kReadWriteByteCount + 1;
static_assert(kReadWriteData == 10);

// Responses 1-4, 17, 23.
constexpr std::size_t kByteCount = kFunction + 1;
constexpr std::size_t kData = kByteCount + 1;

// 43/14.
constexpr std::size_t kInterface = kFunction + 1;
constexpr std::size_t kAccess = kInterface + 1;
constexpr std::size_t kObject = kAccess + 1;
constexpr std::size_t kIdentificationRequestSize = kObject + 1;
constexpr std::size_t kConformity = kAccess + 1;
constexpr std::size_t kMoreFollows = kConformity + 1;
constexpr std::size_t kNextObject = kMoreFollows + 1;
constexpr std::size_t kObjectCount = kNextObject + 1;
constexpr std::size_t kObjects = kObjectCount + 1;
static_assert(kIdentificationRequestSize == 4 && kObjects == 7);

// Exceptions.
constexpr std::size_t kExceptionCode = kFunction + 1;
constexpr std::size_t kExceptionSize = kExceptionCode + 1;

}  // namespace layout

/// Appends fields to a PDU, most significant byte first.
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
Pdu encode_echo(const WriteCoil& message) {
  PduWriter writer(Function::write_coil);
  writer.word(message.address);
  writer.word(message.on ? kCoilOn : kCoilOff);
  return writer.take();
}
Pdu encode_echo(const WriteRegister& message) {
  PduWriter writer(Function::write_register);
  writer.word(message.address);
  writer.word(message.value);
  return writer.take();
}
Pdu encode_echo(const MaskWriteRegister& message) {
  PduWriter writer(Function::mask_write_register);
  writer.word(message.address);
  writer.word(message.and_mask);
  writer.word(message.or_mask);
  return writer.take();
}

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

Decoding decode_identification_request(Bytes pdu) {
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

// Responses.

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

Decoded<Response> decode_identification_response(Bytes pdu) {
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

constexpr std::size_t kSubFunction = 1;
constexpr std::size_t kDiagnosticsData = kSubFunction + 2;
constexpr std::size_t kDiagnosticsSize = kDiagnosticsData + 2;
constexpr std::uint16_t kClearLog = 0xFF00;

Refusal wrong_length(std::uint8_t function) {
  return {function, ExceptionCode::illegal_data_value, true};
}

bool spoken(SubFunction sub_function) {
  switch (sub_function) {
    case SubFunction::return_query_data:
    case SubFunction::restart_communications:
    case SubFunction::return_diagnostic_register:
    case SubFunction::force_listen_only:
    case SubFunction::clear_counters:
    case SubFunction::bus_message_count:
    case SubFunction::bus_communication_error_count:
    case SubFunction::bus_exception_error_count:
    case SubFunction::server_message_count:
    case SubFunction::server_no_response_count:
    case SubFunction::server_nak_count:
    case SubFunction::server_busy_count:
    case SubFunction::bus_character_overrun_count:
    case SubFunction::clear_overrun_counter:
      return true;
  }
  return false;
}

SerialDecoding decode_diagnostics(std::span<const std::uint8_t> pdu) {
  if (pdu.size() < kDiagnosticsData) {
    return wrong_length(kDiagnostics);
  }
  const auto sub_function = static_cast<SubFunction>(load_big<std::uint16_t>(pdu, kSubFunction));
  if (!spoken(sub_function)) {
    return Refusal{kDiagnostics, ExceptionCode::illegal_function, false};
  }
  const auto data = pdu.subspan(kDiagnosticsData);
  if (sub_function == SubFunction::return_query_data) {
    if (data.empty() || data.size() % 2 != 0) {
      return wrong_length(kDiagnostics);
    }
    return SerialRequest(Diagnostics{sub_function, 0, data});
  }
  if (pdu.size() != kDiagnosticsSize) {
    return wrong_length(kDiagnostics);
  }
  const auto value = load_big<std::uint16_t>(pdu, kDiagnosticsData);
  const bool allowed =
      value == 0 || (sub_function == SubFunction::restart_communications && value == kClearLog);
  if (!allowed) {
    return Refusal{kDiagnostics, ExceptionCode::illegal_data_value, false};
  }
  return SerialRequest(Diagnostics{sub_function, value, {}});
}

}  // namespace

bool operator==(const RegisterBlock& a, const RegisterBlock& b) {
  return std::ranges::equal(a.view(), b.view());
}

bool operator==(const BitBlock& a, const BitBlock& b) {
  return a.count == b.count && std::ranges::equal(a.bytes(), b.bytes());
}

RegisterBlock make_registers(std::span<const std::uint16_t> values) {
  assert(values.size() <= kReadRegistersMaximum);
  RegisterBlock block;
  block.count = values.size();
  std::ranges::copy(values, block.values.begin());
  return block;
}

bool DeviceIdentificationResponse::append(std::uint8_t object, std::string_view text) {
  if (text.size() > 255 || size + 2 + text.size() > objects.size()) {
    return false;
  }
  objects[size] = object;
  objects[size + 1] = static_cast<std::uint8_t>(text.size());
  std::ranges::copy(text, std::span(objects).subspan(size + 2).begin());
  size += 2 + text.size();
  ++count;
  return true;
}

std::optional<std::string_view> DeviceIdentificationResponse::find(std::uint8_t object) const {
  std::size_t at = 0;
  while (at + 2 <= size) {
    const std::size_t length = objects[at + 1];
    if (objects[at] == object && at + 2 + length <= size) {
      return std::string_view(reinterpret_cast<const char*>(&objects[at]) + 2, length);
    }
    at += 2 + length;
  }
  return std::nullopt;
}

const char* exception_text(ExceptionCode code) {
  switch (code) {
    case ExceptionCode::illegal_function:
      return "illegal function";
    case ExceptionCode::illegal_data_address:
      return "illegal data address";
    case ExceptionCode::illegal_data_value:
      return "illegal data value";
    case ExceptionCode::server_device_failure:
      return "server device failure";
    case ExceptionCode::acknowledge:
      return "acknowledge";
    case ExceptionCode::server_device_busy:
      return "server device busy";
    case ExceptionCode::memory_parity_error:
      return "memory parity error";
    case ExceptionCode::gateway_path_unavailable:
      return "gateway path unavailable";
    case ExceptionCode::gateway_target_failed:
      return "gateway target device failed to respond";
  }
  return "unknown exception";
}

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
      return decode_identification_request(pdu);
  }
  return refuse(pdu, ExceptionCode::illegal_function);
}

Pdu encode_request(const Request& request) {
  return std::visit(RequestEncoder{}, request);
}

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
      return decode_identification_response(pdu);
  }
  return Malformed{"function code that is not spoken here", 0};
}

Pdu encode_response(const Response& response) {
  return std::visit(ResponseEncoder{}, response);
}

std::optional<SerialDecoding> decode_serial_request(std::span<const std::uint8_t> pdu) {
  assert(!pdu.empty());
  switch (pdu[0]) {
    case kReadExceptionStatus:
      return pdu.size() == 1 ? SerialDecoding(ReadExceptionStatus{})
                             : SerialDecoding(wrong_length(pdu[0]));
    case kDiagnostics:
      return decode_diagnostics(pdu);
    case kGetCommEventCounter:
      return pdu.size() == 1 ? SerialDecoding(GetCommEventCounter{})
                             : SerialDecoding(wrong_length(pdu[0]));
    default:
      return std::nullopt;
  }
}

Pdu encode_exception_status(std::uint8_t status) {
  PduWriter writer(kReadExceptionStatus);
  writer.byte(status);
  return writer.take();
}

Pdu encode_diagnostics(SubFunction sub_function, std::uint16_t data) {
  PduWriter writer(kDiagnostics);
  writer.word(static_cast<std::uint16_t>(sub_function));
  writer.word(data);
  return writer.take();
}

Pdu encode_comm_event_counter(bool busy, std::uint16_t events) {
  PduWriter writer(kGetCommEventCounter);
  writer.word(busy ? 0xFFFF : 0x0000);
  writer.word(events);
  return writer.take();
}

}  // namespace rigwire::protocols::modbus
