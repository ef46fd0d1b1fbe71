// A device that plays a file on a wire: what a real device, or a recorded run, once sent. It
// answers nothing; what clients ask is counted as unanswered.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "hil/devices/device_configuration.h"
#include "hil/files/replay_source.h"

namespace rigwire::hil {

enum class ReplayWire { pty, udp, can };

struct ReplayConfiguration final : DeviceConfigurationOf<ReplayConfiguration> {
  ReplaySourceSettings source;
  ReplayWire wire = ReplayWire::pty;
  std::string path;
  unsigned ports = 1;
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  ///< 0: each datagram to the port that it went to.
  bool allow_remote = false;
  std::string bus = "can";

  void visit(fields::Visitor& v) override;
  void validate() const override {}
  void check(const std::string& at, RigCheck& check) const override;
  void check_source(const std::string& at, RigCheck& check) const;
  void each_fault(const FaultEar& take) override;
  [[nodiscard]] std::vector<fields::Named> fault_kinds() const override { return {}; }
  [[nodiscard]] DevicePlan plan(const RigView& rig) const override;
  [[nodiscard]] std::optional<BusShare> bus_share(std::string_view name) const override;
  [[nodiscard]] DeviceDescription describe() const override;
  [[nodiscard]] std::unique_ptr<Device> make(Site& site) const override;
};

}  // namespace rigwire::hil
