#include "hil/wires/modbus_line_configuration.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace rigwire::hil {
namespace {

TEST(ModbusLineConfiguration, faults_without_meaning_on_the_wire_are_refused) {
  ModbusLineConfiguration line;
  line.faults.resize(1);
  line.faults[0].what = emulators::ModbusNoiseFault{};
  EXPECT_THROW(validate(line), std::invalid_argument);
  line.wire = emulators::ModbusWire::rtu;
  EXPECT_NO_THROW(validate(line));
  line.faults[0].what = emulators::ModbusSilenceFault{};
  line.faults[0].scope.first = 5;
  EXPECT_THROW(validate(line), std::invalid_argument) << "registers without a table";
}

}  // namespace
}  // namespace rigwire::hil
