// A CANopen rotary encoder: bus, the two links whose angle it reads, and what it is at delivery.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "emulators/canopen/rotary_encoder.h"
#include "emulators/own_clock.h"
#include "hil/devices/device_configuration.h"
#include "hil/devices/mounting.h"
#include "hil/devices/node_faults.h"

namespace rigwire::hil {

/// Absolute rotary encoder (CANopen, CiA 406) between two links of the machine.
struct EncoderConfiguration final : DeviceConfigurationOf<EncoderConfiguration> {
  std::string bus = "can";  ///< One of the rig's buses.
  emulators::OwnClockSettings clock;
  std::vector<NodeFault<EncoderSample, emulators::SupplyFault, emulators::PaceFault,
                        emulators::RefusalFault>>
      faults;
  JointConfiguration joint;
  emulators::RotaryEncoderSettings encoder;
  std::string settings_file;  ///< What "save" writes; empty: kept for the run.

  void visit(fields::Visitor& v) override;
  void validate() const override;
  void check(const std::string& at, RigCheck& check) const override;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override;
  [[nodiscard]] std::vector<LiveKey> live_keys() const override;
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
  [[nodiscard]] std::optional<std::string> electronic_data_sheet() const override;
};

}  // namespace rigwire::hil
