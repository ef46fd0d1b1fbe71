#include "emulators/modbus/serial_diagnostics.h"

#include <algorithm>

namespace rigwire::emulators {

using namespace protocols::modbus;

void SerialDiagnostics::exception(ExceptionCode code) {
  constexpr ExceptionCode kNegativeAcknowledge{0x07};
  ++counters_.exceptions;
  if (code == kNegativeAcknowledge) {
    ++counters_.naks;
  }
  if (code == ExceptionCode::server_device_busy) {
    ++counters_.busy;
  }
}

std::optional<Pdu> SerialDiagnostics::diagnose(const Diagnostics& request) {
  switch (request.sub_function) {
    case SubFunction::return_query_data: {
      Pdu echo = encode_diagnostics(SubFunction::return_query_data, 0);
      echo.size -= 2;
      std::ranges::copy(request.query, echo.bytes.begin() + static_cast<std::ptrdiff_t>(echo.size));
      echo.size += request.query.size();
      return echo;
    }
    case SubFunction::restart_communications: {
      const bool silent = listen_only_;
      *this = {};
      return silent ? std::nullopt
                    : std::optional(encode_diagnostics(request.sub_function, request.data));
    }
    case SubFunction::force_listen_only:
      listen_only_ = true;
      return std::nullopt;
    case SubFunction::clear_counters:
      counters_ = {};
      return encode_diagnostics(request.sub_function, request.data);
    case SubFunction::clear_overrun_counter:
      counters_.overruns = 0;
      return encode_diagnostics(request.sub_function, request.data);
    default:
      return encode_diagnostics(request.sub_function, value_of(request.sub_function));
  }
}

std::uint16_t SerialDiagnostics::value_of(SubFunction counter) const {
  switch (counter) {
    case SubFunction::bus_message_count:
      return counters_.bus_messages;
    case SubFunction::bus_communication_error_count:
      return counters_.communication_errors;
    case SubFunction::bus_exception_error_count:
      return counters_.exceptions;
    case SubFunction::server_message_count:
      return counters_.server_messages;
    case SubFunction::server_no_response_count:
      return counters_.no_responses;
    case SubFunction::server_nak_count:
      return counters_.naks;
    case SubFunction::server_busy_count:
      return counters_.busy;
    case SubFunction::bus_character_overrun_count:
      return counters_.overruns;
    default:
      return 0;  // the diagnostic register
  }
}

}  // namespace rigwire::emulators
