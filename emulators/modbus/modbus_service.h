// The units of one Modbus line and what becomes of a request to one of them, whatever frames it.
//
// Order of what is looked at: the faults of the moment (silence, disconnection, an exception that
// the line is told to give), then function (01), then quantity, byte count and value (03), then
// address (02), then what only the device knows. A request acts at the instant given, at once and
// whole.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "emulators/modbus/modbus_faults.h"
#include "emulators/modbus/modbus_unit.h"
#include "emulators/modbus/serial_diagnostics.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// What is to be sent, and how.
struct ModbusAnswer {
  bool silent = false;  ///< Nothing is.
  protocols::modbus::Pdu pdu;
  ModbusFaultEffects effects;
};

class ModbusService {
 public:
  /// Throws std::invalid_argument for a fault that the wire cannot have.
  ModbusService(ModbusWire wire, const std::vector<ModbusFault>& faults, std::uint64_t seed);

  /// `unit` must outlive the service. Throws std::invalid_argument when the number is not 1 .. 247
  /// or is taken.
  void add_unit(std::uint8_t number, ModbusUnit& unit);
  [[nodiscard]] bool has(std::uint8_t number) const { return find(number) != nullptr; }
  /// The number of the unit added first; 0 without any.
  [[nodiscard]] std::uint8_t first() const { return units_.empty() ? 0 : units_.front().number; }

  /// Preconditions: has(number), pdu is not empty. Never throws.
  void serve(SimTime now, std::uint8_t number, std::span<const std::uint8_t> pdu,
             ModbusAnswer& answer);
  /// Carries out a write at all units; everything else is ignored, as nobody would answer.
  void broadcast(SimTime now, std::span<const std::uint8_t> pdu);

  /// News of the line for the counters of every unit.
  void bus_message();
  void communication_error();

  [[nodiscard]] ModbusFaultSchedule& faults() { return faults_; }
  /// accepted: carried out and answered without an exception. ignored: refused with one, unheard,
  /// and unanswered. malformed: PDU of a wrong length. bytes: not counted here.
  [[nodiscard]] ReceiveCounters& received() { return received_; }
  [[nodiscard]] const ReceiveCounters& received() const { return received_; }

 private:
  struct Unit {
    std::uint8_t number = 0;
    ModbusUnit* unit = nullptr;
    SerialDiagnostics diagnostics;
  };

  [[nodiscard]] const Unit* find(std::uint8_t number) const;
  void refuse(Unit& unit, std::uint8_t function, protocols::modbus::ExceptionCode code,
              bool wrong_length, ModbusAnswer& answer);
  void carry_out(SimTime now, Unit& unit, const protocols::modbus::Request& request,
                 ModbusAnswer& answer);
  /// Functions 7, 8 and 11; false when it is none of them.
  bool serve_serial(SimTime now, Unit& unit, std::span<const std::uint8_t> pdu,
                    ModbusAnswer& answer);
  void lay_stuck_over(SimTime now, const Unit& unit, const protocols::modbus::Request& request,
                      protocols::modbus::Response& response);
  void count_served(SimTime now, Unit& unit);

  ModbusWire wire_;
  ModbusFaultSchedule faults_;
  std::vector<Unit> units_;
  std::array<std::uint8_t, 256> places_{};  ///< By number: index in units_ plus 1, 0 = none.
  ReceiveCounters received_;
};

}  // namespace rigwire::emulators
