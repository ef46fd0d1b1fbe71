#include "emulators/modbus/modbus_service.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "protocols/modbus/rtu.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

namespace {

ExceptionResponse refuse(Function function, ExceptionCode code) {
  return {static_cast<std::uint8_t>(function), code};
}

/// Carries out a request to one unit. Function 23 checks that the read will be possible, then
/// writes, then reads (V1.1b3, section 6.17: the write comes first), so that a refused read writes
/// nothing. Function 22 reads and writes one holding register.
struct Dispatcher {
  SimTime now;
  ModbusUnit& unit;

  Response operator()(const ReadBits& request) const {
    ReadBitsResponse response{request.table, {}};
    response.bits.count = request.quantity;
    if (const auto exception = unit.read_bits(request.table, request.address, response.bits)) {
      return refuse(
          request.table == BitTable::coils ? Function::read_coils : Function::read_discrete_inputs,
          *exception);
    }
    return response;
  }

  Response operator()(const ReadRegisters& request) const {
    const Function function = request.table == RegisterTable::holding
                                  ? Function::read_holding_registers
                                  : Function::read_input_registers;
    return read(function, request.table, request.address, request.quantity);
  }

  Response operator()(const WriteCoil& request) const {
    BitBlock coil;
    coil.count = 1;
    coil.set(0, request.on);
    if (const auto exception = unit.write_coils(now, request.address, coil)) {
      return refuse(Function::write_coil, *exception);
    }
    return request;
  }

  Response operator()(const WriteRegister& request) const {
    if (const auto exception =
            unit.write_registers(now, request.address, std::span(&request.value, 1))) {
      return refuse(Function::write_register, *exception);
    }
    return request;
  }

  Response operator()(const WriteCoils& request) const {
    if (const auto exception = unit.write_coils(now, request.address, request.coils)) {
      return refuse(Function::write_coils, *exception);
    }
    return WriteManyResponse{Function::write_coils, request.address,
                             static_cast<std::uint16_t>(request.coils.count)};
  }

  Response operator()(const WriteRegisters& request) const {
    if (const auto exception =
            unit.write_registers(now, request.address, request.registers.view())) {
      return refuse(Function::write_registers, *exception);
    }
    return WriteManyResponse{Function::write_registers, request.address,
                             static_cast<std::uint16_t>(request.registers.count)};
  }

  Response operator()(const ReportServerId&) const {
    constexpr std::uint8_t kRunning = 0xFF;
    ServerIdResponse response;
    const std::string_view id = unit.server_id().substr(0, response.data.size() - 1);
    std::ranges::copy(id, response.data.begin());
    response.data[id.size()] = kRunning;
    response.size = id.size() + 1;
    return response;
  }

  Response operator()(const MaskWriteRegister& request) const {
    std::uint16_t value = 0;
    auto exception =
        unit.read_registers(RegisterTable::holding, request.address, std::span(&value, 1));
    if (!exception) {
      value = request.apply(value);
      exception = unit.write_registers(now, request.address, std::span(&value, 1));
    }
    if (exception) {
      return refuse(Function::mask_write_register, *exception);
    }
    return request;
  }

  Response operator()(const ReadWriteRegisters& request) const {
    constexpr Function kFunction = Function::read_write_registers;
    Response probe =
        read(kFunction, RegisterTable::holding, request.read_address, request.read_quantity);
    if (std::holds_alternative<ExceptionResponse>(probe)) {
      return probe;
    }
    if (const auto exception =
            unit.write_registers(now, request.write_address, request.registers.view())) {
      return refuse(kFunction, *exception);
    }
    return read(kFunction, RegisterTable::holding, request.read_address, request.read_quantity);
  }

  Response operator()(const ReadDeviceIdentification& request) const {
    // Last object of each access code (table in section 6.21).
    constexpr std::uint8_t kLastBasic = 0x02;
    constexpr std::uint8_t kLastRegular = 0x7F;
    constexpr std::uint8_t kRegularStreamAndIndividual = 0x82;
    const auto objects = unit.identification();
    DeviceIdentificationResponse response;
    response.access = request.access;
    response.conformity = kRegularStreamAndIndividual;
    const auto start =
        std::ranges::find(objects, request.object, &ModbusUnit::IdentificationObject::object);
    if (request.access == IdentificationAccess::individual) {
      if (start == objects.end() || !response.append(start->object, start->text)) {
        return refuse(Function::encapsulated_interface, ExceptionCode::illegal_data_address);
      }
      return response;
    }
    const std::uint8_t last =
        request.access == IdentificationAccess::basic ? kLastBasic : kLastRegular;
    // An unknown object restarts the stream at the beginning, as the section asks.
    for (auto at = start == objects.end() ? objects.begin() : start; at != objects.end(); ++at) {
      if (at->object > last) {
        break;
      }
      if (!response.append(at->object, at->text)) {
        response.more_follows = true;
        response.next_object = at->object;
        break;
      }
    }
    return response;
  }

 private:
  Response read(Function function, RegisterTable table, std::uint16_t address,
                std::uint16_t quantity) const {
    RegistersResponse response{function, {}};
    response.registers.count = quantity;
    const auto values = std::span(response.registers.values).first(quantity);
    if (const auto exception = unit.read_registers(table, address, values)) {
      return refuse(function, *exception);
    }
    return response;
  }
};

/// Returns whether a request is executed as a broadcast: only those whose answer has no content.
bool writes_only(const Request& request) {
  return std::holds_alternative<WriteCoil>(request) ||
         std::holds_alternative<WriteRegister>(request) ||
         std::holds_alternative<WriteCoils>(request) ||
         std::holds_alternative<WriteRegisters>(request) ||
         std::holds_alternative<MaskWriteRegister>(request);
}

}  // namespace

void SerialDiagnostics::exception(ExceptionCode code) {
  constexpr ExceptionCode kNegativeAcknowledge{0x07};
  count(SubFunction::bus_exception_error_count);
  if (code == kNegativeAcknowledge) {
    count(SubFunction::server_nak_count);
  }
  if (code == ExceptionCode::server_device_busy) {
    count(SubFunction::server_busy_count);
  }
}

// Executes a sub-function of function 08 (V1.1b3, section 6.8). Returns no answer for "force listen
// only mode", nor for a restart that ends that mode.
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
      events_ = 0;
      return encode_diagnostics(request.sub_function, request.data);
    case SubFunction::clear_overrun_counter:
      counters_.back() = 0;
      return encode_diagnostics(request.sub_function, request.data);
    case SubFunction::return_diagnostic_register:
      return encode_diagnostics(request.sub_function, 0);
    default: {
      const auto counter = static_cast<std::size_t>(request.sub_function) - kFirst;
      return encode_diagnostics(request.sub_function, counters_[counter]);
    }
  }
}

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

bool ModbusService::alive(Unit& unit) {
  if (std::exchange(unit.starts, unit.unit->starts()) != unit.starts) {
    unit.diagnostics = {};
  }
  return unit.unit->supplied();
}

void ModbusService::bus_message() {
  for (Unit& unit : units_) {
    if (alive(unit)) {
      unit.diagnostics.bus_message();
    }
  }
}

void ModbusService::communication_error() {
  for (Unit& unit : units_) {
    if (alive(unit)) {
      unit.diagnostics.communication_error();
    }
  }
}

void ModbusService::serve(SimTime now, std::uint8_t number, std::span<const std::uint8_t> pdu,
                          ModbusAnswer& answer) {
  Unit& unit = units_[places_[number] - 1U];
  answer.silent = false;
  answer.effects = {};
  unit.unit->advance(now);
  if (!alive(unit)) {
    ++received_.ignored;
    ++unit.unit->received().ignored;
    answer.silent = true;
    return;
  }
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
    unit.unit->advance(now);
    if (!alive(unit) || unit.diagnostics.listen_only() || !unit.unit->has_function(pdu[0]) ||
        (!faults_.empty() && faults_.effects(now, unit.number, request).silence)) {
      continue;
    }
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
  Response response = std::visit(Dispatcher{now, *unit.unit}, request);
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
