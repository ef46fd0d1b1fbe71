#include "protocols/modbus/pdu.h"

#include <algorithm>

namespace rigwire::protocols::modbus {

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

}  // namespace rigwire::protocols::modbus
