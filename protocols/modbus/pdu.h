// Modbus protocol data units: requests and responses to bytes and back, both directions, pure.
//
// Functions 1-6, 15, 16, 17, 22, 23 and 43/14 (device identification), and on serial lines 7, 8 and
// 11. All integers are most significant byte first; coils are packed least
// significant bit first. A whole PDU is offered to the decoders: the framing below knows its length
// (mbap.h on TCP, rtu.h on serial lines).
//
// Source: MODBUS Application Protocol Specification V1.1b3, section 6; order of the checks after
// the state diagrams there (figures 11-31): function (01), then quantity, byte count and value
// (03), then address (02). What only the device can know (which addresses exist, which values are
// allowed) is checked by the device, after all of this.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "protocols/modbus/constants.h"
#include "protocols/result.h"

namespace rigwire::protocols::modbus {

/// Register values of one message, at most kReadRegistersMaximum; no allocation.
struct RegisterBlock {
  std::array<std::uint16_t, kReadRegistersMaximum> values{};
  std::size_t count = 0;

  [[nodiscard]] std::span<const std::uint16_t> view() const {
    return std::span(values).first(count);
  }
  /// Equal in the used part.
  friend bool operator==(const RegisterBlock& a, const RegisterBlock& b);
};
/// Precondition: values.size() <= kReadRegistersMaximum.
[[nodiscard]] RegisterBlock make_registers(std::span<const std::uint16_t> values);

/// Coils or discrete inputs of one message, packed as on the wire: item i is bit i % 8 of byte
/// i / 8. Padding bits are 0.
struct BitBlock {
  std::array<std::uint8_t, (kReadBitsMaximum + 7) / 8> packed{};
  std::size_t count = 0;  ///< Items.

  [[nodiscard]] bool test(std::size_t item) const {
    return ((packed[item / 8] >> (item % 8)) & 1U) != 0;
  }
  void set(std::size_t item, bool on) {
    const auto bit = static_cast<std::uint8_t>(1U << (item % 8));
    packed[item / 8] =
        static_cast<std::uint8_t>(on ? packed[item / 8] | bit : packed[item / 8] & ~bit);
  }
  [[nodiscard]] std::span<const std::uint8_t> bytes() const {
    return std::span(packed).first((count + 7) / 8);
  }
  /// Equal in the used part.
  friend bool operator==(const BitBlock& a, const BitBlock& b);
};

enum class BitTable : std::uint8_t { coils, discrete_inputs };
enum class RegisterTable : std::uint8_t { holding, input };

// --- Requests. `address` counts from 0, as on the wire (documents that count from 1 add 1). ---

/// Functions 1 and 2.
struct ReadBits {
  BitTable table = BitTable::coils;
  std::uint16_t address = 0;
  std::uint16_t quantity = 1;  ///< 1 .. 2000.
  friend bool operator==(const ReadBits&, const ReadBits&) = default;
};
/// Functions 3 and 4.
struct ReadRegisters {
  RegisterTable table = RegisterTable::holding;
  std::uint16_t address = 0;
  std::uint16_t quantity = 1;  ///< 1 .. 125.
  friend bool operator==(const ReadRegisters&, const ReadRegisters&) = default;
};
/// Function 5; the response is the same message.
struct WriteCoil {
  std::uint16_t address = 0;
  bool on = false;
  friend bool operator==(const WriteCoil&, const WriteCoil&) = default;
};
/// Function 6; the response is the same message.
struct WriteRegister {
  std::uint16_t address = 0;
  std::uint16_t value = 0;
  friend bool operator==(const WriteRegister&, const WriteRegister&) = default;
};
/// Function 15.
struct WriteCoils {
  std::uint16_t address = 0;
  BitBlock coils;  ///< 1 .. 1968.
  friend bool operator==(const WriteCoils&, const WriteCoils&) = default;
};
/// Function 16.
struct WriteRegisters {
  std::uint16_t address = 0;
  RegisterBlock registers;  ///< 1 .. 123.
  friend bool operator==(const WriteRegisters&, const WriteRegisters&) = default;
};
/// Function 17.
struct ReportServerId {
  friend bool operator==(const ReportServerId&, const ReportServerId&) = default;
};
/// Function 22: result = (old AND and_mask) OR (or_mask AND NOT and_mask). The response is the same
/// message.
struct MaskWriteRegister {
  std::uint16_t address = 0;
  std::uint16_t and_mask = 0xFFFF;
  std::uint16_t or_mask = 0;

  [[nodiscard]] std::uint16_t apply(std::uint16_t old) const {
    return static_cast<std::uint16_t>((old & and_mask) | (or_mask & ~and_mask));
  }
  friend bool operator==(const MaskWriteRegister&, const MaskWriteRegister&) = default;
};
/// Function 23: the server writes first, then reads.
struct ReadWriteRegisters {
  std::uint16_t read_address = 0;
  std::uint16_t read_quantity = 1;  ///< 1 .. 125.
  std::uint16_t write_address = 0;
  RegisterBlock registers;  ///< To write, 1 .. 121.
  friend bool operator==(const ReadWriteRegisters&, const ReadWriteRegisters&) = default;
};
/// How much of the identification is wanted (section 6.21).
enum class IdentificationAccess : std::uint8_t {
  basic = 1,
  regular = 2,
  extended = 3,
  individual = 4,
};
/// Function 43, interface 14.
struct ReadDeviceIdentification {
  IdentificationAccess access = IdentificationAccess::basic;
  std::uint8_t object = 0;  ///< First object wanted; the one object for `individual`.
  friend bool operator==(const ReadDeviceIdentification&,
                         const ReadDeviceIdentification&) = default;
};

using Request =
    std::variant<ReadBits, ReadRegisters, WriteCoil, WriteRegister, WriteCoils, WriteRegisters,
                 ReportServerId, MaskWriteRegister, ReadWriteRegisters, ReadDeviceIdentification>;

// --- Responses. ---

/// Functions 1 and 2. On the wire the count is in bytes, so a decoded count is a multiple of 8.
struct ReadBitsResponse {
  BitTable table = BitTable::coils;
  BitBlock bits;
  friend bool operator==(const ReadBitsResponse&, const ReadBitsResponse&) = default;
};
/// Functions 3, 4 and 23.
struct RegistersResponse {
  Function function = Function::read_holding_registers;
  RegisterBlock registers;
  friend bool operator==(const RegistersResponse&, const RegistersResponse&) = default;
};
/// Functions 15 and 16.
struct WriteManyResponse {
  Function function = Function::write_registers;
  std::uint16_t address = 0;
  std::uint16_t quantity = 0;
  friend bool operator==(const WriteManyResponse&, const WriteManyResponse&) = default;
};
/// Function 17: what it holds is the device's own affair; here it is an identifier text followed by
/// the run indicator (FF on, 00 off).
struct ServerIdResponse {
  std::array<std::uint8_t, kPduMaximum - 2> data{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> view() const { return std::span(data).first(size); }
  friend bool operator==(const ServerIdResponse&, const ServerIdResponse&) = default;
};
/// Function 43/14. `objects` holds `count` times (identifier, length, text).
struct DeviceIdentificationResponse {
  static constexpr std::size_t kHeaderSize = 1    // function
                                             + 1  // interface
                                             + 1  // access code of the request
                                             + 1  // conformity level
                                             + 1  // more follows: FF or 00
                                             + 1  // next object identifier
                                             + 1  // number of objects
      ;
  IdentificationAccess access = IdentificationAccess::basic;
  std::uint8_t conformity = 0x81;
  bool more_follows = false;
  std::uint8_t next_object = 0;
  std::uint8_t count = 0;
  std::array<std::uint8_t, kPduMaximum - kHeaderSize> objects{};
  std::size_t size = 0;  ///< Used bytes of `objects`.

  /// False when the object does not fit any more (or is longer than 255 bytes).
  [[nodiscard]] bool append(std::uint8_t object, std::string_view text);
  /// The text of one object, if present. Lives as long as this response.
  [[nodiscard]] std::optional<std::string_view> find(std::uint8_t object) const;
  friend bool operator==(const DeviceIdentificationResponse&,
                         const DeviceIdentificationResponse&) = default;
};
struct ExceptionResponse {
  std::uint8_t function = 0;  ///< Function of the request, without the exception flag.
  ExceptionCode code = ExceptionCode::illegal_function;
  friend bool operator==(const ExceptionResponse&, const ExceptionResponse&) = default;
};

using Response = std::variant<ReadBitsResponse, RegistersResponse, WriteCoil, WriteRegister,
                              WriteManyResponse, ServerIdResponse, MaskWriteRegister,
                              DeviceIdentificationResponse, ExceptionResponse>;

/// Encoded bytes, function code first; no allocation.
struct Pdu {
  std::array<std::uint8_t, kPduMaximum> bytes{};
  std::size_t size = 0;
  [[nodiscard]] std::span<const std::uint8_t> view() const { return std::span(bytes).first(size); }
};

/// A request that a server answers with an exception before it looks at its registers.
struct Refusal {
  std::uint8_t function = 0;  ///< Function as received, without the exception flag.
  ExceptionCode code = ExceptionCode::illegal_function;
  bool wrong_length = false;  ///< The PDU is shorter or longer than its function requires.
  friend bool operator==(const Refusal&, const Refusal&) = default;
};

/// What a server does with a PDU. Precondition: pdu is not empty. A PDU longer or shorter than its
/// function and byte count say is refused with exception 03. Ranges that run past address 65535
/// are refused with exception 02. A decoded request can be encoded again to the same bytes, except
/// for the padding bits of function 15.
[[nodiscard]] std::variant<Request, Refusal> decode_request(std::span<const std::uint8_t> pdu);

/// Precondition: quantities within the limits in constants.h.
[[nodiscard]] Pdu encode_request(const Request& request);

/// Incomplete when the PDU ends early, malformed when a field has a value that no server may send.
[[nodiscard]] Decoded<Response> decode_response(std::span<const std::uint8_t> pdu);

/// Precondition: quantities within the limits in constants.h.
[[nodiscard]] Pdu encode_response(const Response& response);

// --- Serial lines only: 7 (read exception status), 8 (diagnostics) and 11 (get communication event
// counter), both directions. On TCP no device has these functions.
//
// Source: V1.1b3, sections 6.7 to 6.9; order of the checks of function 8 after figure 18 there:
// sub-function (01), then data (03). Sub-function 03 (delimiter of the ASCII mode) and function 12
// (event log) are not supported. ---
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
