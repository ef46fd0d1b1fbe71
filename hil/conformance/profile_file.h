// The YAML file in which a device's claims stand that a conformance suite holds it to.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "conform/modbus/modbus_claims.h"
#include "conform/nmea/nmea_suite.h"
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

/// Of a receiver that speaks NMEA 0183.
struct NmeaProfile {
  conform::NmeaClaims claims;
};
void visit(fields::Visitor& v, NmeaProfile& p);
/// Throws std::invalid_argument.
void validate(const NmeaProfile& p);

/// The claims of a file. Throws ConfigurationError.
[[nodiscard]] conform::ModbusClaims read_modbus_profile(const std::string& file);
[[nodiscard]] conform::NmeaClaims read_nmea_profile(const std::string& file);
/// Of the file as it would be written anew.
[[nodiscard]] std::string hash_of(const std::string& profile_text);

/// A file that reads as these claims; `endpoint` is who was asked for them, or empty.
[[nodiscard]] std::string profile_text(const conform::ModbusClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::NmeaClaims& claims,
                                       const std::string& endpoint);

}  // namespace rigwire::hil
