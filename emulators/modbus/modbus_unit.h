// What one Modbus unit (slave) does, whatever line it is on.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "emulators/device.h"
#include "protocols/modbus/constants.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// What one unit (slave) does. Each call answers with an exception, or nothing when it is done; a
/// call that answers with an exception has changed nothing. Ranges never run past address 65535.
/// The default of every table is that the device does not have it.
class ModbusUnit {
 public:
  using Outcome = std::optional<protocols::modbus::ExceptionCode>;
  /// One text of the device identification: object number (V1.1b3, section 6.21) and value.
  struct IdentificationObject {
    std::uint8_t object = 0;
    std::string_view text;
  };

  virtual ~ModbusUnit() = default;

  /// Whether the unit has supply; without it the unit receives nothing.
  [[nodiscard]] virtual bool supplied() const { return true; }
  /// How often it has been switched on: what the line counts of it begins anew with each.
  [[nodiscard]] virtual std::uint32_t starts() const { return 1; }
  /// Lets the device behind the unit live up to `now`; the server calls it before each request.
  virtual void advance(SimTime /*now*/) {}

  /// Fills `values`. Without side effects: function 23 probes with it before it writes.
  virtual Outcome read_registers(protocols::modbus::RegisterTable /*table*/,
                                 std::uint16_t /*address*/,
                                 std::span<std::uint16_t> /*values*/) const {
    return kNoTable;
  }
  /// Holding registers, all or none.
  virtual Outcome write_registers(SimTime /*now*/, std::uint16_t /*address*/,
                                  std::span<const std::uint16_t> /*values*/) {
    return kNoTable;
  }
  /// Fills bits.count items.
  virtual Outcome read_bits(protocols::modbus::BitTable /*table*/, std::uint16_t /*address*/,
                            protocols::modbus::BitBlock& /*bits*/) const {
    return kNoTable;
  }
  /// Coils, all or none.
  virtual Outcome write_coils(SimTime /*now*/, std::uint16_t /*address*/,
                              const protocols::modbus::BitBlock& /*coils*/) {
    return kNoTable;
  }
  /// Function 17; the device is reported as running.
  [[nodiscard]] virtual std::string_view server_id() const = 0;
  /// Function 43/14, ascending by object, the first three (vendor, product code, revision) always.
  [[nodiscard]] virtual std::span<const IdentificationObject> identification() const = 0;
  /// Whether the device has this function at all; one that it has not is answered with exception 01
  /// whatever the request.
  [[nodiscard]] virtual bool has_function(std::uint8_t /*function*/) const { return true; }
  /// Function 7, serial lines only: eight bits that mean what the device likes.
  [[nodiscard]] virtual std::uint8_t exception_status() const { return 0; }
  /// A request to this unit was carried out and is answered without an exception.
  virtual void served(SimTime now) = 0;

  /// Requests to this unit, kept by the server. accepted: answered without an exception. ignored:
  /// refused with one. malformed: PDU of a wrong length. bytes: of the PDUs.
  [[nodiscard]] const ReceiveCounters& received() const { return received_; }
  [[nodiscard]] ReceiveCounters& received() { return received_; }
  /// The beginning of the PDU that came last, kept by the server.
  [[nodiscard]] const LastRequest& last_request() const { return last_request_; }
  [[nodiscard]] LastRequest& last_request() { return last_request_; }

 private:
  static constexpr auto kNoTable = protocols::modbus::ExceptionCode::illegal_function;

  ReceiveCounters received_;
  LastRequest last_request_;
};

/// A device that is a unit of a Modbus line. The line (ModbusServer on TCP) frames and answers; the
/// device only knows its registers, so that it is the same on every kind of line.
class ModbusDevice : public Device {
 public:
  /// What the line asks. Lives as long as the device; its advance() is this device's.
  [[nodiscard]] virtual ModbusUnit& unit() = 0;
};

}  // namespace rigwire::emulators
