#include "conform/modbus/modbus_suite.h"

#include <algorithm>
#include <iterator>

namespace rigwire::conform {

namespace modbus = protocols::modbus;

namespace {

CaseResult run_case(const ModbusCase& of, ModbusDevice& device) {
  return try_case(
      of.identity, *device.bounds, [&] { return ModbusTrial(of.identity, device); },
      [&](ModbusTrial& trial) { of.run(trial); });
}

/// Reads of the ranges' items: all that is there between the two, halving what is refused.
void find_items(ModbusTrial& trial, std::uint8_t function, unsigned most, unsigned first,
                unsigned after, std::vector<AddressRange>& found) {
  while (first < after) {
    const unsigned count = std::min(most, after - first);
    const auto answer = trial.ask(fields_pdu(function, {first, count}));
    if (!answer) {
      return;
    }
    if (answer->front() == function) {
      const auto last = static_cast<std::uint16_t>(first + count - 1);
      if (!found.empty() && found.back().last + 1U == first) {
        found.back().last = last;
      } else {
        found.push_back({static_cast<std::uint16_t>(first), last});
      }
    } else if (count > 1) {
      find_items(trial, function, count / 2, first, first + count, found);
    }
    first += count;
  }
}

}  // namespace

std::vector<ModbusCase> modbus_cases() {
  std::vector<ModbusCase> all;
  for (auto* chapter : {modbus_tcp_cases, modbus_exception_cases, modbus_reading_cases,
                        modbus_writing_cases, modbus_file_cases, modbus_identity_cases,
                        modbus_serial_cases, modbus_timing_cases, modbus_robustness_cases}) {
    std::ranges::move(chapter(), std::back_inserter(all));
  }
  return all;
}

SuiteResult run_modbus_suite(ModbusDevice& device, const SuiteOptions& options) {
  SuiteResult result;
  result.suite = device.serial() ? "modbus-rtu" : "modbus-tcp";
  result.endpoint = device.endpoint.text();
  device.bounds->begin();
  device.line = device.connect();
  for (const ModbusCase& each : modbus_cases()) {
    if (!is_wanted(each.identity.id, options.wanted)) {
      continue;
    }
    const auto hindered = hindrance(each.identity, missing(each.needs, device), options);
    result.cases.push_back(hindered ? *hindered : run_case(each, device));
  }
  device.line.reset();
  return result;
}

ModbusClaims survey_modbus(ModbusDevice& device, unsigned addresses) {
  ModbusClaims claims = device.claims;
  device.bounds->begin();
  ModbusTrial trial({}, device);
  // Exception 1 means that the device does not know the function. A device that closes the
  // connection counts as knowing it.
  const auto knows = [&](const Pdu& request) {
    const auto answer = trial.ask(request);
    if (!answer) {
      const bool ended = trial.line().closed();
      trial.reopen();
      return ended;
    }
    return answer->size() != 2 || (answer->front() & modbus::kExceptionFlag) == 0 ||
           (*answer)[1] != static_cast<std::uint8_t>(modbus::ExceptionCode::illegal_function);
  };
  const std::uint32_t after = std::min<std::uint32_t>(addresses, modbus::kTableSize);
  claims.functions.clear();
  for (std::uint8_t code = 1; code <= 4; ++code) {
    std::vector<AddressRange>& table = claims.tables[code - 1U];
    table.clear();
    if (!knows(fields_pdu(code, {0, 1}))) {
      continue;
    }
    claims.functions.push_back(code);
    find_items(
        trial, code,
        static_cast<unsigned>(code <= 2 ? modbus::kReadBitsMaximum : modbus::kReadRegistersMaximum),
        0, after, table);
  }
  // Writing functions are probed with requests that change nothing: too short, or of no items.
  const std::vector<Pdu> harmless{with(fields_pdu(5, {0}), {0}),
                                  with(fields_pdu(6, {0}), {0}),
                                  {7},
                                  fields_pdu(8, {0, 0}),
                                  {11},
                                  {12},
                                  with(fields_pdu(15, {0, 0}), {0}),
                                  with(fields_pdu(16, {0, 0}), {0}),
                                  {17},
                                  {20, 0},
                                  {21, 0},
                                  fields_pdu(22, {0xFFFF, 0xFFFF, 0}),
                                  with(fields_pdu(23, {0, 0, 0, 0}), {0}),
                                  {24, 0},
                                  {43, modbus::kDeviceIdentificationInterface, 1, 0}};
  for (const Pdu& request : harmless) {
    if (knows(request)) {
      claims.functions.push_back(request.front());
    }
  }
  return claims;
}

}  // namespace rigwire::conform
