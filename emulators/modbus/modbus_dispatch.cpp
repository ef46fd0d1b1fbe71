#include "emulators/modbus/modbus_dispatch.h"

#include <algorithm>

namespace rigwire::emulators {
namespace {

using namespace protocols::modbus;

ExceptionResponse refuse(Function function, ExceptionCode code) {
  return {static_cast<std::uint8_t>(function), code};
}

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
    // Which objects an access code covers (table in section 6.21).
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

}  // namespace

Response dispatch(SimTime now, ModbusUnit& unit, const Request& request) {
  return std::visit(Dispatcher{now, unit}, request);
}

}  // namespace rigwire::emulators
