#include "hil/configuration/modbus_line.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "hil/configuration/problems.h"
#include "hil/configuration/rig.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;

const std::string kPit = std::string(RIGWIRE_CONFIG_DIR) + "/rigs/excavator_pit.yaml";

RigConfiguration load(const std::vector<std::string>& sets) {
  return load_rig(kPit, sets).configuration;
}

std::string problems_of(const std::vector<std::string>& sets) {
  try {
    (void)load_rig(kPit, sets);
  } catch (const ConfigurationError& error) {
    return error.what();
  }
  return "no problem";
}

TEST(ModbusLineConfiguration, a_device_takes_a_unit_of_a_serial_line) {
  const RigConfiguration rig =
      load({"modbus.cab.wire=rtu", "modbus.cab.path=/tmp/rigwire/cab", "modbus.cab.baud=9600",
            "modbus.cab.parity=odd", "modbus.cab.response_delay.distribution=uniform",
            "devices.valves.line=cab", "devices.valves.unit=3"});
  const ModbusLineConfiguration& line = rig.modbus.at("cab");
  EXPECT_EQ(line.wire, emulators::ModbusWire::rtu);
  EXPECT_EQ(line.line.timing.baud, 9600U);
  EXPECT_EQ(line.line.timing.character, SerialCharacter::odd_8o1);
  const auto& valves = std::get<ValveDriverConfiguration>(rig.devices.at("valves").settings);
  EXPECT_EQ(valves.line, "cab");
  EXPECT_EQ(valves.unit, 3);
}

TEST(ModbusLineConfiguration, keys_of_the_other_wire_are_refused) {
  EXPECT_THAT(problems_of({"modbus.cab.wire=rtu", "modbus.cab.port=1503"}),
              HasSubstr("only with wire: tcp"));
  EXPECT_THAT(problems_of({"modbus.cab.baud=9600"}), HasSubstr("only with wire: rtu"));
  EXPECT_THAT(problems_of({"modbus.cab.wire=rtu", "devices.valves.line=cab",
                           "devices.valves.processing_delay=1 ms"}),
              HasSubstr("the line has its own"));
}

TEST(ModbusLineConfiguration, lines_and_units_must_exist_and_be_free) {
  EXPECT_THAT(problems_of({"modbus.cab.wire=rtu", "devices.valves.line=cap"}),
              HasSubstr("no such Modbus line"));
  EXPECT_THAT(problems_of({"modbus.cab.port=1502"}), HasSubstr("already taken"));
}

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
  std::size_t index = 0;
  const auto check = [&]<class Fault>(Fault) {
    ModbusFaultConfiguration configured;
    configured.settings = Fault{};
    EXPECT_EQ(emulators::name(modbus_fault(configured).kind), kModbusFaultTypes[index++].name);
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
