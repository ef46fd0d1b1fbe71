// The units of one Modbus line and what becomes of a request to one of them, whatever frames it.
//
// Order of the checks: whether the unit has supply, the active faults (silence, disconnection, an
// exception to answer with), then function (01), then quantity, byte count and value (03), then
// address (02), then what only the device knows. A request acts at the instant given, at once and
// whole.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "emulators/device.h"
#include "emulators/modbus/modbus_faults.h"
#include "emulators/modbus/modbus_unit.h"
#include "protocols/modbus/pdu.h"
#include "sim/samples/time.h"

namespace rigwire::emulators {

/// What is to be sent, and how.
struct ModbusAnswer {
  bool silent = false;  ///< Nothing is.
  protocols::modbus::Pdu pdu;
  ModbusFaultEffects effects;
};

/// What one unit of a serial Modbus line knows of its communication: the counters of function 8,
/// the event counter of function 11, and whether it only listens.
///
/// Source: MODBUS Application Protocol Specification V1.1b3, sections 6.8 and 6.9; MODBUS over
/// Serial Line V1.02, section 6.1 (management of the counters). All counters wrap at 65535 and are
/// 0 at power-up.
class SerialDiagnostics {
 public:
  /// A frame with a right check went over the line, for whomever.
  void bus_message() { count(SubFunction::bus_message_count); }
  /// A frame with a wrong check, too short, or with characters in error.
  void communication_error() { count(SubFunction::bus_communication_error_count); }
  /// A request to this unit, or to all, is being worked on.
  void server_message() { count(SubFunction::server_message_count); }
  /// It ended without an answer.
  void no_response() { count(SubFunction::server_no_response_count); }
  void exception(protocols::modbus::ExceptionCode code);
  /// It was carried out without an exception; function 11 itself does not count.
  void event() { ++events_; }

  [[nodiscard]] bool listen_only() const { return listen_only_; }
  [[nodiscard]] std::uint16_t events() const { return events_; }

  /// Carries out function 8; nothing when it is not answered (the unit listens only, before or
  /// after).
  [[nodiscard]] std::optional<protocols::modbus::Pdu> diagnose(
      const protocols::modbus::Diagnostics& request);

 private:
  using SubFunction = protocols::modbus::SubFunction;
  static constexpr auto kFirst = static_cast<std::size_t>(SubFunction::bus_message_count);
  static constexpr auto kLast = static_cast<std::size_t>(SubFunction::bus_character_overrun_count);

  void count(SubFunction counter) { ++counters_[static_cast<std::size_t>(counter) - kFirst]; }

  /// By sub-function; the last one never counts: every byte that is on the line is taken.
  std::array<std::uint16_t, kLast - kFirst + 1> counters_{};
  std::uint16_t events_ = 0;
  bool listen_only_ = false;
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
  /// Carries out a write at all units; ignores any other request, as a broadcast is not answered.
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
    std::uint32_t starts = 1;  ///< Starts of the unit when its diagnostics began.
  };

  [[nodiscard]] const Unit* find(std::uint8_t number) const;
  /// Returns whether the unit has supply. Its counters restart when the supply comes.
  [[nodiscard]] static bool alive(Unit& unit);
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
