#include "hil/wires/modbus_line_configuration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <stdexcept>
#include <tuple>

namespace rigwire::hil {
namespace {

TEST(ModbusLineConfiguration, a_fault_becomes_what_the_emulator_knows) {
  ModbusFaultConfiguration configured;
  configured.at = std::chrono::seconds(5);
  configured.unit = 7;
  configured.table = ModbusFaultTable::input;
  configured.first = 2;
  configured.last = 9;
  configured.settings = ModbusStuckFault{.value = 500};
  const emulators::ModbusFault fault = modbus_fault(configured);
  EXPECT_EQ(fault.kind, emulators::ModbusFaultKind::stuck);
  EXPECT_EQ(fault.begin, std::chrono::seconds(5));
  EXPECT_EQ(fault.end, std::chrono::seconds(15));
  EXPECT_EQ(fault.unit, 7);
  ASSERT_TRUE(fault.registers.has_value());
  EXPECT_EQ(fault.registers->table, protocols::modbus::Table::input_registers);
  EXPECT_EQ(fault.registers->last, 9);
  EXPECT_EQ(fault.value, 500);
}

TEST(ModbusLineConfiguration, every_fault_keeps_its_name) {
  const auto check = [&]<class Fault>(Fault) {
    ModbusFaultConfiguration configured;
    configured.settings = Fault{};
    EXPECT_EQ(emulators::name(modbus_fault(configured).kind), Fault::kNamed.name);
  };
  std::apply(
      [&](auto... faults) { (check(faults), ...); },
      std::tuple<ModbusDelayFault, ModbusExceptionFault, ModbusSilenceFault, ModbusLostAnswerFault,
                 ModbusJunkFault, ModbusSplitFault, ModbusTruncatedFault, ModbusStuckFault,
                 ModbusWrongCheckFault, ModbusWrongTransactionFault, ModbusDisconnectFault,
                 ModbusNoiseFault, ModbusParityFault>{});
}

TEST(ModbusLineConfiguration, faults_without_meaning_on_the_wire_are_refused) {
  ModbusLineConfiguration line;
  line.faults.resize(1);
  line.faults[0].settings = ModbusNoiseFault{};
  EXPECT_THROW(validate(line), std::invalid_argument);
  line.wire = emulators::ModbusWire::rtu;
  EXPECT_NO_THROW(validate(line));
  line.faults[0].settings = ModbusSilenceFault{};
  line.faults[0].first = 5;
  EXPECT_THROW(validate(line), std::invalid_argument) << "registers without a table";
}

}  // namespace
}  // namespace rigwire::hil
