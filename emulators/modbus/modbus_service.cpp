#include "emulators/modbus/modbus_service.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "emulators/modbus/modbus_dispatch.h"
#include "protocols/modbus/rtu.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

namespace {

/// Of broadcast requests only those that ask for no answer's content.
bool writes_only(const Request& request) {
  return std::holds_alternative<WriteCoil>(request) ||
         std::holds_alternative<WriteRegister>(request) ||
         std::holds_alternative<WriteCoils>(request) ||
         std::holds_alternative<WriteRegisters>(request) ||
         std::holds_alternative<MaskWriteRegister>(request);
}

}  // namespace

ModbusService::ModbusService(ModbusWire wire, const std::vector<ModbusFault>& faults,
                             std::uint64_t seed)
    : wire_(wire), faults_(faults, wire, seed) {}

void ModbusService::add_unit(std::uint8_t number, ModbusUnit& unit) {
  if (number < 1 || number > kUnitMaximum) {
    throw std::invalid_argument("modbus unit: found " + std::to_string(number) +
                                ", allowed 1 .. 247");
  }
  if (has(number)) {
    throw std::invalid_argument("modbus unit " + std::to_string(number) + " is there twice");
  }
  units_.push_back({number, &unit, {}});
  places_[number] = static_cast<std::uint8_t>(units_.size());
}

const ModbusService::Unit* ModbusService::find(std::uint8_t number) const {
  const std::size_t place = places_[number];
  return place == 0 ? nullptr : &units_[place - 1];
}

void ModbusService::bus_message() {
  for (Unit& unit : units_) {
    unit.diagnostics.bus_message();
  }
}

void ModbusService::communication_error() {
  for (Unit& unit : units_) {
    unit.diagnostics.communication_error();
  }
}

void ModbusService::serve(SimTime now, std::uint8_t number, std::span<const std::uint8_t> pdu,
                          ModbusAnswer& answer) {
  Unit& unit = units_[places_[number] - 1U];
  answer.silent = false;
  answer.effects = {};
  unit.unit->advance(now);
  unit.unit->received().bytes += pdu.size();
  unit.unit->last_request().note(now, pdu);
  const auto decoded = decode_request(pdu);
  const auto* request = std::get_if<Request>(&decoded);
  if (!faults_.empty()) {
    answer.effects = faults_.effects(now, number, request);
  }
  const ModbusFaultEffects& effects = answer.effects;
  if (effects.silence) {
    ++received_.ignored;
    ++unit.unit->received().ignored;
    answer.silent = true;
    return;
  }
  if (wire_ == ModbusWire::rtu) {
    if (unit.diagnostics.listen_only() && pdu[0] != kDiagnostics) {
      answer.silent = true;
      return;
    }
    unit.diagnostics.server_message();
  }
  if (effects.code && *effects.code != ExceptionCode::acknowledge) {
    refuse(unit, pdu[0], *effects.code, false, answer);
  } else if (!unit.unit->has_function(pdu[0])) {
    refuse(unit, pdu[0], ExceptionCode::illegal_function, false, answer);
  } else if (wire_ == ModbusWire::tcp || !serve_serial(now, unit, pdu, answer)) {
    if (request != nullptr) {
      carry_out(now, unit, *request, answer);
    } else {
      const auto& refusal = std::get<Refusal>(decoded);
      refuse(unit, refusal.function, refusal.code, refusal.wrong_length, answer);
    }
  }
  if (effects.code == ExceptionCode::acknowledge) {  // accepted, and worked on
    answer.pdu = encode_response(ExceptionResponse{
        static_cast<std::uint8_t>(pdu[0] & ~kExceptionFlag), ExceptionCode::acknowledge});
  }
  answer.silent = answer.silent || effects.lost_answer;
  if (answer.silent) {
    unit.diagnostics.no_response();
  }
}

void ModbusService::broadcast(SimTime now, std::span<const std::uint8_t> pdu) {
  const auto decoded = decode_request(pdu);
  const auto* request = std::get_if<Request>(&decoded);
  if (request == nullptr || !writes_only(*request)) {
    ++received_.ignored;
    return;
  }
  ModbusAnswer unsent;
  for (Unit& unit : units_) {
    if (unit.diagnostics.listen_only() || !unit.unit->has_function(pdu[0]) ||
        (!faults_.empty() && faults_.effects(now, unit.number, request).silence)) {
      continue;
    }
    unit.unit->advance(now);
    unit.unit->received().bytes += pdu.size();
    unit.unit->last_request().note(now, pdu);
    unit.diagnostics.server_message();
    unit.diagnostics.no_response();
    carry_out(now, unit, *request, unsent);
  }
}

void ModbusService::refuse(Unit& unit, std::uint8_t function, ExceptionCode code, bool wrong_length,
                           ModbusAnswer& answer) {
  for (ReceiveCounters* counters : {&received_, &unit.unit->received()}) {
    ++(wrong_length ? counters->malformed : counters->ignored);
  }
  unit.diagnostics.exception(code);
  answer.pdu = encode_response(
      ExceptionResponse{static_cast<std::uint8_t>(function & ~kExceptionFlag), code});
}

void ModbusService::count_served(SimTime now, Unit& unit) {
  ++received_.accepted;
  ++unit.unit->received().accepted;
  unit.unit->served(now);
}

void ModbusService::carry_out(SimTime now, Unit& unit, const Request& request,
                              ModbusAnswer& answer) {
  Response response = dispatch(now, *unit.unit, request);
  if (const auto* exception = std::get_if<ExceptionResponse>(&response)) {
    refuse(unit, exception->function, exception->code, false, answer);
    return;
  }
  unit.diagnostics.event();
  count_served(now, unit);
  if (!faults_.empty()) {
    lay_stuck_over(now, unit, request, response);
  }
  answer.pdu = encode_response(response);
}

bool ModbusService::serve_serial(SimTime now, Unit& unit, std::span<const std::uint8_t> pdu,
                                 ModbusAnswer& answer) {
  const auto decoded = decode_serial_request(pdu);
  if (!decoded) {
    return false;
  }
  const bool only_listened = unit.diagnostics.listen_only();
  if (const auto* refusal = std::get_if<Refusal>(&*decoded)) {
    refuse(unit, refusal->function, refusal->code, refusal->wrong_length, answer);
    answer.silent = only_listened;
    return true;
  }
  const auto& request = std::get<SerialRequest>(*decoded);
  if (const auto* diagnostics = std::get_if<Diagnostics>(&request)) {
    if (only_listened && diagnostics->sub_function != SubFunction::restart_communications) {
      answer.silent = true;
      return true;
    }
    unit.diagnostics.event();
    const auto pdu_out = unit.diagnostics.diagnose(*diagnostics);
    answer.silent = !pdu_out.has_value();
    answer.pdu = pdu_out.value_or(Pdu{});
  } else if (std::holds_alternative<ReadExceptionStatus>(request)) {
    unit.diagnostics.event();
    answer.pdu = encode_exception_status(unit.unit->exception_status());
  } else {
    answer.pdu = encode_comm_event_counter(false, unit.diagnostics.events());
  }
  count_served(now, unit);
  return true;
}

void ModbusService::lay_stuck_over(SimTime now, const Unit& unit, const Request& request,
                                   Response& response) {
  auto* registers = std::get_if<RegistersResponse>(&response);
  if (registers == nullptr) {
    return;
  }
  const auto values = std::span(registers->registers.values).first(registers->registers.count);
  if (const auto* read = std::get_if<ReadRegisters>(&request)) {
    faults_.hold_stuck(
        now, unit.number,
        read->table == RegisterTable::holding ? Table::holding_registers : Table::input_registers,
        read->address, values);
  } else if (const auto* both = std::get_if<ReadWriteRegisters>(&request)) {
    faults_.hold_stuck(now, unit.number, Table::holding_registers, both->read_address, values);
  }
}

}  // namespace rigwire::emulators
