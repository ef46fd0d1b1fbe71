// The YAML file in which a device's claims stand that a conformance suite holds it to.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "conform/modbus/modbus_claims.h"
#include "fields/rules.h"

namespace rigwire::hil {

/// As the file has it. Ranges are texts: "0-15", or "7".
struct ModbusProfile {
  std::uint8_t unit = 1;
  std::vector<double> functions;
  std::vector<std::string> coils;
  std::vector<std::string> discrete_inputs;
  std::vector<std::string> holding_registers;
  std::vector<std::string> input_registers;
  std::vector<std::string> writable_coils;
  std::vector<std::string> writable_registers;
  std::chrono::nanoseconds answer_within = std::chrono::milliseconds{100};
  std::chrono::nanoseconds patience = std::chrono::seconds{1};
  protocols::modbus::SerialCharacter character = protocols::modbus::SerialCharacter::even_8e1;
};
void visit(fields::Visitor& v, ModbusProfile& p);
/// Throws std::invalid_argument: no ranges, or such as overlap or are beyond what can be read.
void validate(const ModbusProfile& p);

/// The claims of a file, and the hash of what it says. Throws ConfigurationError.
struct ReadProfile {
  conform::ModbusClaims claims;
  std::string hash;
};
[[nodiscard]] ReadProfile read_modbus_profile(const std::string& file);

/// A file that reads as these claims.
[[nodiscard]] std::string profile_text(const conform::ModbusClaims& claims,
                                       const std::string& endpoint);

}  // namespace rigwire::hil
