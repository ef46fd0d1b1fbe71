// The field side of Modbus, on TCP or on a serial line (RTU): a thin, owning wrapper around
// libmodbus.
//
// Calls block, for the time-outs below at most, and never throw. Nothing is retried: after a
// time-out or a broken connection the wrapper closes (a late answer must not be taken for the next
// one), and the caller connects again. Addresses count from 0. Not thread-safe.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "protocols/modbus/constants.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::drivers {

/// A serial line, instead of TCP.
struct ModbusSerialPort {
  std::string path;  ///< Path of the port or pseudo-terminal.
  protocols::modbus::RtuTiming timing;
};

struct ModbusMasterSettings {
  std::string host = "127.0.0.1";  ///< Numeric IPv4.
  std::uint16_t port = 1502;
  std::optional<ModbusSerialPort> serial{};         ///< Set: RTU there; host and port are unused.
  std::uint8_t unit = 1;                            ///< 0 .. 255; 0 .. 247 on a serial line.
  std::chrono::milliseconds connect_timeout{1000};  ///< 1 ms .. 1 min.
  /// 1 ms .. 1 min; on a serial line it includes the time of request and answer on the line.
  std::chrono::milliseconds response_timeout{500};
};

/// How a call ended; true in a condition when it did what it was asked.
struct [[nodiscard]] ModbusOutcome {
  std::string error;  ///< Empty when done; else what failed, and why.
  /// Set when the device answered with an exception; the connection is sound then.
  std::optional<protocols::modbus::ExceptionCode> exception;
  explicit operator bool() const { return error.empty(); }
};

class ModbusMaster {
 public:
  /// Does not connect. Throws std::invalid_argument for a setting out of range.
  explicit ModbusMaster(const ModbusMasterSettings& settings);
  ~ModbusMaster();
  ModbusMaster(ModbusMaster&&) noexcept;
  ModbusMaster& operator=(ModbusMaster&&) noexcept;

  ModbusOutcome connect();
  void close();
  [[nodiscard]] bool connected() const;

  /// Fill `values`, 1 .. 125 registers.
  ModbusOutcome read_input_registers(std::uint16_t address, std::span<std::uint16_t> values);
  ModbusOutcome read_holding_registers(std::uint16_t address, std::span<std::uint16_t> values);
  ModbusOutcome write_register(std::uint16_t address, std::uint16_t value);
  /// 1 .. 123 registers in one request.
  ModbusOutcome write_registers(std::uint16_t address, std::span<const std::uint16_t> values);
  /// Function 23: the device writes first (1 .. 121 registers), then reads (1 .. 125).
  ModbusOutcome read_write_registers(std::uint16_t write_address,
                                     std::span<const std::uint16_t> written,
                                     std::uint16_t read_address, std::span<std::uint16_t> read);
  /// Any other function: sends `pdu` (function code first), puts the answer's PDU into `answer`,
  /// which should have room for 253 bytes, and its length into `size`. The answer may be an
  /// exception; it is not judged here.
  ModbusOutcome transact(std::span<const std::uint8_t> pdu, std::span<std::uint8_t> answer,
                         std::size_t& size);

 private:
  struct Connection;
  std::unique_ptr<Connection> connection_;
};

}  // namespace rigwire::drivers
