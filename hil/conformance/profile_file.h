// The YAML file with a device's claims, against which a conformance suite checks it.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "conform/canopen/canopen_suite.h"
#include "conform/gige_vision/gige_vision_suite.h"
#include "conform/iso_valves/iso_valves_suite.h"
#include "conform/j1939/j1939_suite.h"
#include "conform/modbus/modbus_claims.h"
#include "conform/nmea/nmea_suite.h"
#include "conform/ubx/ubx_suite.h"
#include "conform/velodyne/velodyne_log.h"
#include "fields/rules.h"

namespace rigwire::hil {

/// Profile file of a Modbus device. Ranges are texts: "0-15", or "7".
struct ModbusProfile {
  std::uint8_t unit = 1;
  std::vector<double> functions;
  std::vector<std::string> coils;
  std::vector<std::string> discrete_inputs;
  std::vector<std::string> holding_registers;
  std::vector<std::string> input_registers;
  std::vector<std::string> writable_coils;
  std::vector<std::string> writable_registers;
  std::vector<std::string> files;  ///< "4:0-9": records of a file.
  std::vector<std::string> writable_files;
  std::vector<double> queues;
  std::chrono::nanoseconds answer_within = std::chrono::milliseconds{100};
  std::chrono::nanoseconds patience = std::chrono::seconds{1};
  protocols::modbus::SerialCharacter character = protocols::modbus::SerialCharacter::even_8e1;
};
void visit(fields::Visitor& v, ModbusProfile& p);
/// Throws std::invalid_argument: no ranges, or such as overlap or are beyond what can be read.
void validate(const ModbusProfile& p);

/// Profile file of a receiver that speaks NMEA 0183.
struct NmeaProfile {
  conform::NmeaClaims claims;
};
void visit(fields::Visitor& v, NmeaProfile& p);
/// Throws std::invalid_argument.
void validate(const NmeaProfile& p);

/// Profile file of a u-blox receiver.
struct UbxProfile {
  conform::UbxClaims claims;
  std::chrono::nanoseconds answer_within = std::chrono::milliseconds{500};
  std::chrono::nanoseconds patience = std::chrono::milliseconds{1500};
};
void visit(fields::Visitor& v, UbxProfile& p);
/// Throws std::invalid_argument for a message that does not exist or cannot be polled.
void validate(const UbxProfile& p);

/// Profile file of a CANopen node. Objects are texts: "1018:1".
struct CanopenProfile {
  std::uint8_t node = 1;
  std::vector<std::string> objects;
  std::chrono::nanoseconds patience = std::chrono::milliseconds{500};
};
void visit(fields::Visitor& v, CanopenProfile& p);
/// Throws std::invalid_argument for a text that names no object.
void validate(const CanopenProfile& p);

/// Profile file of a J1939 node. Groups sent periodically are texts: "61444 every 20 ms".
struct J1939Profile {
  std::uint8_t address = 0;
  std::vector<std::string> periodic;
  std::vector<double> requested;
  std::chrono::nanoseconds patience = std::chrono::milliseconds{500};
};
void visit(fields::Visitor& v, J1939Profile& p);
/// Throws std::invalid_argument for a text that names no group or no period.
void validate(const J1939Profile& p);

/// Profile file of a block of auxiliary valves on ISO 11783.
struct IsoValveProfile {
  std::uint8_t address = 0x80;
  unsigned first_valve = 0;
  unsigned valves = 1;
  int function = -1;  ///< -1: not claimed.
  bool measured_flow = true;
  std::chrono::nanoseconds command_timeout{0};
  std::chrono::nanoseconds patience = std::chrono::milliseconds{500};
};
void visit(fields::Visitor& v, IsoValveProfile& p);
/// Throws std::invalid_argument for valves beyond the last possible one.
void validate(const IsoValveProfile& p);

/// Profile file of a spinning lidar.
struct VelodyneProfile {
  conform::VelodyneClaims claims;
};
void visit(fields::Visitor& v, VelodyneProfile& p);
/// Throws std::invalid_argument for an unknown model, return mode or pulse state.
void validate(const VelodyneProfile& p);

/// Profile file of a GigE Vision camera. Registers are texts: "0xA104", with a written value
/// "0xA104 = 1".
struct GigeVisionProfile {
  std::string acquisition_start;
  std::string acquisition_stop;
  std::string payload_size;
  double rate_hz = 0.0;
  std::chrono::nanoseconds answer_within = std::chrono::milliseconds{100};
  std::chrono::nanoseconds patience = std::chrono::milliseconds{500};
};
void visit(fields::Visitor& v, GigeVisionProfile& p);
/// Throws std::invalid_argument for what names no register.
void validate(const GigeVisionProfile& p);

/// The claims of a file. Throws ConfigurationError.
[[nodiscard]] conform::ModbusClaims read_modbus_profile(const std::string& file);
[[nodiscard]] conform::NmeaClaims read_nmea_profile(const std::string& file);
[[nodiscard]] conform::UbxClaims read_ubx_profile(const std::string& file);
[[nodiscard]] conform::J1939Claims read_j1939_profile(const std::string& file);
[[nodiscard]] conform::IsoValveClaims read_iso_valve_profile(const std::string& file);
[[nodiscard]] conform::CanopenClaims read_canopen_profile(const std::string& file);
[[nodiscard]] conform::VelodyneClaims read_velodyne_profile(const std::string& file);
[[nodiscard]] conform::GigeVisionClaims read_gige_vision_profile(const std::string& file);
/// Returns the hash (FNV-1a, 64 bits, in 16 hexadecimal digits) of a profile that profile_text()
/// wrote without an endpoint.
[[nodiscard]] std::string hash_of(const std::string& profile_text);

/// Returns a file that reads as these claims; `endpoint` is the device that was asked, or empty.
[[nodiscard]] std::string profile_text(const conform::ModbusClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::NmeaClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::UbxClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::J1939Claims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::IsoValveClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::CanopenClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::VelodyneClaims& claims,
                                       const std::string& endpoint);
[[nodiscard]] std::string profile_text(const conform::GigeVisionClaims& claims,
                                       const std::string& endpoint);

}  // namespace rigwire::hil
