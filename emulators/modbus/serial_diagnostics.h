// What one unit of a serial Modbus line knows of its communication: the counters of function 8, the
// event counter of function 11, and whether it only listens.
//
// Source: MODBUS Application Protocol Specification V1.1b3, sections 6.8 and 6.9; MODBUS over
// Serial Line V1.02, section 6.1 (management of the counters). All counters wrap at 65535 and are 0
// at power-up.
#pragma once

#include <cstdint>
#include <optional>

#include "protocols/modbus/serial_functions.h"

namespace rigwire::emulators {

class SerialDiagnostics {
 public:
  /// A frame with a right check went over the line, for whomever.
  void bus_message() { ++counters_.bus_messages; }
  /// A frame with a wrong check, too short, or with characters in error.
  void communication_error() { ++counters_.communication_errors; }
  /// A request to this unit, or to all, is being worked on.
  void server_message() { ++counters_.server_messages; }
  /// It ended without an answer.
  void no_response() { ++counters_.no_responses; }
  void exception(protocols::modbus::ExceptionCode code);
  /// It was carried out without an exception; function 11 itself does not count.
  void event() { ++counters_.events; }

  [[nodiscard]] bool listen_only() const { return listen_only_; }
  [[nodiscard]] std::uint16_t events() const { return counters_.events; }

  /// Carries out function 8; nothing when it is not answered (the unit listens only, before or
  /// after).
  [[nodiscard]] std::optional<protocols::modbus::Pdu> diagnose(
      const protocols::modbus::Diagnostics& request);

 private:
  struct Counters {
    std::uint16_t bus_messages = 0;
    std::uint16_t communication_errors = 0;
    std::uint16_t exceptions = 0;
    std::uint16_t server_messages = 0;
    std::uint16_t no_responses = 0;
    std::uint16_t naks = 0;
    std::uint16_t busy = 0;
    std::uint16_t overruns = 0;  ///< Never: every byte that is on the line is taken.
    std::uint16_t events = 0;
  };

  [[nodiscard]] std::uint16_t value_of(protocols::modbus::SubFunction counter) const;

  Counters counters_;
  bool listen_only_ = false;
};

}  // namespace rigwire::emulators
