// Hydraulic valve driver on one of the rig's Modbus lines, or as a TCP server of its own.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "emulators/modbus/modbus_faults.h"
#include "emulators/supply.h"
#include "emulators/valve_amplifier/fault.h"
#include "emulators/valve_driver/valve_driver.h"
#include "hil/configuration/fault_window.h"
#include "hil/devices/device_configuration.h"

namespace rigwire::hil {

/// A fault of its amplifier or its supply, or of its own Modbus line.
struct ValveDriverFault {
  FaultPeriod when;
  emulators::ModbusFaultScope scope;  ///< Scope of a fault of the line.
  EitherOf<decltype(emulators::ValveDefect::what), decltype(emulators::SupplyFault::what),
           decltype(emulators::ModbusFault::what)>::Type what;
};
void visit(fields::Visitor& v, ValveDriverFault& p);

struct ValveDriverConfiguration final : DeviceConfigurationOf<ValveDriverConfiguration> {
  std::string line;                   ///< One of the rig's Modbus lines; empty: its own server.
  std::string address = "127.0.0.1";  ///< Where its own server listens.
  std::uint16_t port = 1502;
  bool allow_remote = false;  ///< Needed to listen where other machines reach it.
  std::uint8_t unit = 1;      ///< On its Modbus line, 1 .. 247.
  /// Delay of the answers of its own server.
  Duration processing_delay = std::chrono::microseconds(300);
  std::string map;  ///< File of the registers (hil/files/valve_map_file.h); empty: Rigwire's own.
  emulators::ValveDriverSettings driver;
  std::vector<ValveDriverFault> faults;

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void check_against_map(const std::string& at, RigCheck& check) const;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;

  /// Those of its own line.
  [[nodiscard]] std::vector<emulators::ModbusFault> line_faults() const;
};

/// The driver's settings, with its map read. Throws ConfigurationError.
[[nodiscard]] emulators::ValveDriverSettings driver_settings(
    const ValveDriverConfiguration& configuration);

}  // namespace rigwire::hil
