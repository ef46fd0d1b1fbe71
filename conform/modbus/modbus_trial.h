// A case of the Modbus suites while it runs: requests as bytes, one after the other, over TCP or a
// serial line, and what is expected of the answers.
//
// Whatever a case is about, each answer has to be framed as the guides ask: on TCP the header of
// the request with the right length; on a serial line address and check (MODBUS Messaging on TCP/IP
// Implementation Guide V1.0b, 3.1.3; MODBUS over Serial Line V1.02, 2.5.1).
#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "conform/bounds.h"
#include "conform/byte_line.h"
#include "conform/modbus/modbus_claims.h"
#include "conform/trial.h"
#include "protocols/modbus/mbap.h"

namespace rigwire::conform {

using Pdu = std::vector<std::uint8_t>;

/// The document whose sections most cases cite.
inline constexpr const char* kApplicationProtocol = "Modbus application protocol V1.1b3";

/// A request of a function with 16-bit fields: code, then each, most significant byte first.
[[nodiscard]] Pdu fields_pdu(std::uint8_t function, std::initializer_list<unsigned> words);
/// `pdu` with these bytes behind it.
[[nodiscard]] Pdu with(Pdu pdu, std::initializer_list<unsigned> bytes);

/// The device under test, over several cases.
struct ModbusDevice {
  Endpoint endpoint;
  ModbusClaims claims;
  std::unique_ptr<ByteLine> line;  ///< Serial: kept open; TCP: new for each case.
  std::uint16_t transaction = 0;   ///< Identifier of the last request.
  std::shared_ptr<Bounds> bounds = std::make_shared<Bounds>();

  [[nodiscard]] bool serial() const { return endpoint.kind == Endpoint::Kind::serial; }
  /// Opens a new connection to the device, within the bounds. Throws Unreachable, TimeIsUp.
  [[nodiscard]] std::unique_ptr<ByteLine> connect() const;
};

class ModbusTrial : public Trial {
 public:
  /// Opens the way to the device. Throws Unreachable.
  ModbusTrial(CaseIdentity identity, ModbusDevice& device);

  [[nodiscard]] const ModbusClaims& claims() const { return device_->claims; }
  [[nodiscard]] const Endpoint& endpoint() const { return device_->endpoint; }
  [[nodiscard]] bool serial() const { return device_->serial(); }

  /// Returns a request that every device answers, if only with an exception: one item that it has.
  [[nodiscard]] Pdu any_request() const;
  /// Sends a request and waits for the answer. Returns nullopt if no answer came in time or its
  /// framing was wrong, which is recorded as a failure; the case may end then.
  [[nodiscard]] std::optional<Pdu> ask(const Pdu& request);
  /// Returns the time that the last answer took.
  [[nodiscard]] std::chrono::nanoseconds took() const { return took_; }

  /// Checks that the answer is this exception.
  bool refuses(const Pdu& request, protocols::modbus::ExceptionCode code);
  /// Checks that the answer is no exception and has the request's function. Returns the bytes after
  /// the function, else nullopt.
  [[nodiscard]] std::optional<Pdu> accepts(const Pdu& request);
  /// Values of `count` registers from there (functions 3 and 4); nothing where it failed.
  [[nodiscard]] std::optional<std::vector<std::uint16_t>> registers(std::uint8_t function,
                                                                    unsigned address,
                                                                    unsigned count);
  /// Coils or discrete inputs (functions 1 and 2).
  [[nodiscard]] std::optional<std::vector<bool>> bits(std::uint8_t function, unsigned address,
                                                      unsigned count);

  // Below the requests.

  /// A new connection; of a serial line its input is thrown away, for at most kDrain.
  void reopen();
  /// A connection beside the first.
  [[nodiscard]] std::unique_ptr<ByteLine> another() const { return device_->connect(); }
  [[nodiscard]] ByteLine& line() { return *device_->line; }
  /// Bytes as they are. False when the device takes none.
  bool send(std::span<const std::uint8_t> bytes, std::string words);
  /// Nothing comes within this time.
  bool silent(std::chrono::milliseconds within, const std::string& about);
  /// A data unit framed for the line: on TCP with the next transaction number.
  [[nodiscard]] std::vector<std::uint8_t> framed(const Pdu& request);
  /// One answer to what was sent last; as ask().
  [[nodiscard]] std::optional<Pdu> answer();
  /// The header of an answer, of the next that comes, of TCP; `others` keeps what came behind it.
  [[nodiscard]] std::optional<protocols::modbus::MbapHeader> header_of_next(Pdu& pdu);

 private:
  [[nodiscard]] std::optional<Pdu> tcp_answer(ByteLine::Clock::time_point deadline);
  [[nodiscard]] std::optional<Pdu> serial_answer(ByteLine::Clock::time_point deadline);

  ModbusDevice* device_;
  std::vector<std::uint8_t> arrived_;  ///< And not used.
  ByteLine::Clock::time_point asked_;
  std::chrono::nanoseconds took_{};
};

/// What a case needs of the device's claims.
struct ModbusNeeds {
  std::uint8_t function = 0;      ///< Claimed; 0: none.
  std::uint8_t and_function = 0;  ///< Claimed, too; 0: none.
  std::uint8_t without = 0;       ///< Not claimed; 0: none.
  bool tcp = false;
  bool serial = false;
  bool writable_coils = false;
  bool writable_registers = false;
  bool file = false;
  bool writable_file = false;
  bool queue = false;
};
/// Why it cannot be tried; empty when it can.
[[nodiscard]] std::string missing(const ModbusNeeds& needs, const ModbusDevice& device);

struct ModbusCase {
  CaseIdentity identity;
  ModbusNeeds needs;
  std::function<void(ModbusTrial&)> run;
};

// The chapters.
[[nodiscard]] std::vector<ModbusCase> modbus_reading_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_writing_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_file_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_identity_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_exception_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_tcp_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_serial_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_timing_cases();
[[nodiscard]] std::vector<ModbusCase> modbus_robustness_cases();

}  // namespace rigwire::conform
