#include "protocols/modbus/serial_functions.h"

#include "protocols/bytes.h"
#include "protocols/modbus/pdu_writer.h"

namespace rigwire::protocols::modbus {
namespace {

using Decoding = std::variant<SerialRequest, Refusal>;

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

Decoding decode_diagnostics(std::span<const std::uint8_t> pdu) {
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

std::optional<Decoding> decode_serial_request(std::span<const std::uint8_t> pdu) {
  assert(!pdu.empty());
  switch (pdu[0]) {
    case kReadExceptionStatus:
      return pdu.size() == 1 ? Decoding(ReadExceptionStatus{}) : Decoding(wrong_length(pdu[0]));
    case kDiagnostics:
      return decode_diagnostics(pdu);
    case kGetCommEventCounter:
      return pdu.size() == 1 ? Decoding(GetCommEventCounter{}) : Decoding(wrong_length(pdu[0]));
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
