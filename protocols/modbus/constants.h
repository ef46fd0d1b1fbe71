// Numbers of the Modbus application protocol that every part of the family shares.
//
// Source: MODBUS Application Protocol Specification V1.1b3 (modbus.org, 2012): section 4.1 (sizes),
// 5.1 (function codes), 6 (quantities), 7 (exceptions); MODBUS Messaging on TCP/IP Implementation
// Guide V1.0b, section 3.1.3 (MBAP header).
#pragma once

#include <cstddef>
#include <cstdint>

namespace rigwire::protocols::modbus {

/// The functions that this code supports (V1.1b3, section 5.1).
enum class Function : std::uint8_t {
  read_coils = 1,
  read_discrete_inputs = 2,
  read_holding_registers = 3,
  read_input_registers = 4,
  write_coil = 5,
  write_register = 6,
  write_coils = 15,
  write_registers = 16,
  report_server_id = 17,
  mask_write_register = 22,
  read_write_registers = 23,
  encapsulated_interface = 43,
};

/// Set in the function code of an answer that carries an exception.
inline constexpr std::uint8_t kExceptionFlag = 0x80;

/// Section 7.
enum class ExceptionCode : std::uint8_t {
  illegal_function = 0x01,
  illegal_data_address = 0x02,
  illegal_data_value = 0x03,
  server_device_failure = 0x04,
  acknowledge = 0x05,
  server_device_busy = 0x06,
  memory_parity_error = 0x08,
  gateway_path_unavailable = 0x0A,
  gateway_target_failed = 0x0B,
};

/// The words of the specification for an exception code; "unknown exception" for any other number.
[[nodiscard]] const char* exception_text(ExceptionCode code);

// Sizes, in bytes.
inline constexpr std::size_t kPduMaximum = 253;     // serial ADU 256, less address 1 and CRC 2
inline constexpr std::size_t kMbapHeaderSize = 2    // transaction identifier
                                               + 2  // protocol identifier, 0 for Modbus
                                               + 2  // length of what follows
                                               + 1  // unit identifier
    ;
inline constexpr std::size_t kTcpAduMaximum = kMbapHeaderSize + kPduMaximum;
static_assert(kTcpAduMaximum == 260);

// Quantities that one request can carry (section 6).
inline constexpr std::size_t kReadBitsMaximum = 2000;
inline constexpr std::size_t kReadRegistersMaximum = 125;
inline constexpr std::size_t kWriteCoilsMaximum = 1968;
inline constexpr std::size_t kWriteRegistersMaximum = 123;
inline constexpr std::size_t kReadWriteReadMaximum = 125;
inline constexpr std::size_t kReadWriteWriteMaximum = 121;

/// Items in one table: addresses 0 .. 65535.
inline constexpr std::size_t kTableSize = 65536;

/// The four tables of a device's data model (section 4.3).
enum class Table : std::uint8_t { coils, discrete_inputs, holding_registers, input_registers };

// Function 5: the two values that exist.
inline constexpr std::uint16_t kCoilOn = 0xFF00;
inline constexpr std::uint16_t kCoilOff = 0x0000;

/// Function 43: the only encapsulated interface supported here, device identification (section
/// 6.21).
inline constexpr std::uint8_t kDeviceIdentificationInterface = 14;

}  // namespace rigwire::protocols::modbus
