// A rig of ours that runs beside, for who wants to be a client of one of its devices: `rigwire run
// --isolated` in a process and a folder of its own, which end with it.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/child.h"

namespace rigwire::hil {

class RigProcess {
 public:
  /// Returns when every wire is open. Throws drivers::EndpointError with what it said when it ends
  /// before or is not ready in 30 s.
  explicit RigProcess(const std::string& rig, const std::vector<std::string>& sets = {});
  /// Ends the run and removes its folder.
  ~RigProcess();
  RigProcess(const RigProcess&) = delete;
  RigProcess& operator=(const RigProcess&) = delete;

  /// Where a device's wire is: "tcp 127.0.0.1:1502". Throws std::invalid_argument for a device that
  /// the rig does not have.
  [[nodiscard]] std::string wire(const std::string& device) const;
  /// What the run has in place of a key of its rig, "devices.lidar.position_port"; nothing where
  /// it has the rig's own.
  [[nodiscard]] std::optional<std::string> replaced(const std::string& key) const;
  /// Ends the run. Returns by how much it fell behind the clock because this machine was too slow
  /// for it, s: its periods and time-outs were as much longer.
  [[nodiscard]] double finish();

 private:
  [[nodiscard]] std::filesystem::path report() const { return folder_ / "report.json"; }

  std::filesystem::path folder_;
  std::optional<drivers::Child> process_;
  std::map<std::string, std::string> wires_;     ///< By device.
  std::map<std::string, std::string> replaced_;  ///< By key.
};

}  // namespace rigwire::hil
