// A valve driver behind a Modbus server, and a master's words for it.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "../modbus/modbus_client.h"
#include "emulators/modbus/modbus_server.h"
#include "emulators/valve_driver/valve_driver.h"

namespace rigwire::emulators {

class ValveDriverTest : public ::testing::Test {
 protected:
  explicit ValveDriverTest(const ValveDriverSettings& settings = {}) : driver_(settings) {
    server_.add_unit(1, driver_.unit());
    server_.connected(kStart, 1);
  }

  protocols::modbus::Response ask(SimTime now, const protocols::modbus::Request& request,
                                  std::uint8_t unit = 1) {
    server_.receive(now, 1, adu_of(request, 1, unit));
    return output_.latest();
  }
  protocols::modbus::Response write(SimTime now, std::uint16_t address,
                                    const std::vector<int>& values) {
    std::vector<std::uint16_t> raw;
    for (const int value : values) {
      raw.push_back(static_cast<std::uint16_t>(value));
    }
    return ask(now,
               protocols::modbus::WriteRegisters{address, protocols::modbus::make_registers(raw)});
  }
  static protocols::modbus::Response done(std::uint16_t address, std::uint16_t quantity) {
    return protocols::modbus::WriteManyResponse{protocols::modbus::Function::write_registers,
                                                address, quantity};
  }
  static protocols::modbus::Response refused(protocols::modbus::ExceptionCode code,
                                             std::uint8_t function = 16) {
    return protocols::modbus::ExceptionResponse{function, code};
  }
  std::vector<std::uint16_t> read(SimTime now, protocols::modbus::RegisterTable table,
                                  std::uint16_t address, std::uint16_t quantity) {
    const protocols::modbus::Response answer =
        ask(now, protocols::modbus::ReadRegisters{table, address, quantity});
    const auto* registers = std::get_if<protocols::modbus::RegistersResponse>(&answer);
    EXPECT_NE(registers, nullptr) << "refused";
    return registers == nullptr ? std::vector<std::uint16_t>(quantity)
                                : std::vector<std::uint16_t>(registers->registers.view().begin(),
                                                             registers->registers.view().end());
  }
  std::uint16_t input(SimTime now, std::uint16_t address) {
    return read(now, protocols::modbus::RegisterTable::input, address, 1)[0];
  }
  std::uint16_t holding(SimTime now, std::uint16_t address) {
    return read(now, protocols::modbus::RegisterTable::holding, address, 1)[0];
  }
  double opening(std::size_t section) const { return driver_.command().opening[section]; }

  RecordedStream output_;
  ValveDriver driver_;
  ModbusServer server_{{}, output_};
};

}  // namespace rigwire::emulators
