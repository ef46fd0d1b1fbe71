#include "emulators/modbus/modbus_unit.h"

namespace rigwire::emulators {

using namespace protocols::modbus;

ModbusUnit::Outcome ModbusUnit::read_registers(RegisterTable /*table*/, std::uint16_t /*address*/,
                                               std::span<std::uint16_t> /*values*/) const {
  return ExceptionCode::illegal_function;
}
ModbusUnit::Outcome ModbusUnit::write_registers(SimTime /*now*/, std::uint16_t /*address*/,
                                                std::span<const std::uint16_t> /*values*/) {
  return ExceptionCode::illegal_function;
}
ModbusUnit::Outcome ModbusUnit::read_bits(BitTable /*table*/, std::uint16_t /*address*/,
                                          BitBlock& /*bits*/) const {
  return ExceptionCode::illegal_function;
}
ModbusUnit::Outcome ModbusUnit::write_coils(SimTime /*now*/, std::uint16_t /*address*/,
                                            const BitBlock& /*coils*/) {
  return ExceptionCode::illegal_function;
}

}  // namespace rigwire::emulators
