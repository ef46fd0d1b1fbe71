// The functions that exist on serial lines only: 7 (read exception status), 8 (diagnostics) and 11
// (get communication event counter), both directions. On TCP they are functions that nobody has.
//
// Source: MODBUS Application Protocol Specification V1.1b3, sections 6.7 to 6.9; order of the
// checks of function 8 after figure 18 there: sub-function (01), then data (03). Sub-function 03
// (delimiter of the ASCII mode) and function 12 (event log) are not spoken.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <variant>

#include "protocols/modbus/pdu.h"

namespace rigwire::protocols::modbus {

inline constexpr std::uint8_t kReadExceptionStatus = 7;
inline constexpr std::uint8_t kDiagnostics = 8;
inline constexpr std::uint8_t kGetCommEventCounter = 11;

/// Section 6.8.1.
enum class SubFunction : std::uint16_t {
  return_query_data = 0,
  restart_communications = 1,
  return_diagnostic_register = 2,
  force_listen_only = 4,
  clear_counters = 10,
  bus_message_count = 11,
  bus_communication_error_count = 12,
  bus_exception_error_count = 13,
  server_message_count = 14,
  server_no_response_count = 15,
  server_nak_count = 16,
  server_busy_count = 17,
  bus_character_overrun_count = 18,
  clear_overrun_counter = 20,
};

struct ReadExceptionStatus {
  friend bool operator==(const ReadExceptionStatus&, const ReadExceptionStatus&) = default;
};
/// `data` is 0, for restart_communications 0 or FF00 hex (clear the event log too), for
/// return_query_data the bytes of `query`.
struct Diagnostics {
  SubFunction sub_function = SubFunction::return_query_data;
  std::uint16_t data = 0;
  std::span<const std::uint8_t> query;  ///< Points into the request; an even number of bytes.
};
struct GetCommEventCounter {
  friend bool operator==(const GetCommEventCounter&, const GetCommEventCounter&) = default;
};
using SerialRequest = std::variant<ReadExceptionStatus, Diagnostics, GetCommEventCounter>;

/// Nothing when the function is none of these. Precondition: pdu is not empty.
[[nodiscard]] std::optional<std::variant<SerialRequest, Refusal>> decode_serial_request(
    std::span<const std::uint8_t> pdu);

/// Answers. A diagnostics answer with a counter carries it as `data`; an echo is the request.
[[nodiscard]] Pdu encode_exception_status(std::uint8_t status);
[[nodiscard]] Pdu encode_diagnostics(SubFunction sub_function, std::uint16_t data);
/// `busy`: a command from before is still being worked on.
[[nodiscard]] Pdu encode_comm_event_counter(bool busy, std::uint16_t events);

}  // namespace rigwire::protocols::modbus
