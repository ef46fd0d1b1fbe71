// How the machine moves and what its ports read, as the recording's messages have it: together with
// the poses of its links all that a replay of the motion needs (hil/files/motion_file.h).
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "hil/world/truth_observer.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// rigwire.Motion: {"links": {LINK: {velocity_mps, rate_radps, acceleration_mps2,
/// angular_acceleration_radps2}}, "valves", "vehicle", "power_unit": {member: number or list}};
/// vectors in the world's axes, ports where the machine has them, by sim/samples/port_members.h.
[[nodiscard]] std::string motion_line(const TruthRecord& record,
                                      std::span<const std::string> links);

/// Names of a machine's joints, as its truth fields have them.
class JointNames {
 public:
  JointNames(std::span<const sim::TruthField> fields, std::span<const std::string_view> links);

  /// Returns whether the machine has no joints; then no message is written.
  [[nodiscard]] bool empty() const { return joints_.empty(); }
  /// foxglove.JointStates: angles in rad, rates in rad/s, where the truth has them. `timestamp` as
  /// JSON.
  [[nodiscard]] std::string line(std::span<const double> truth, std::string_view timestamp) const;

 private:
  struct Joint {
    std::string name;
    std::ptrdiff_t angle = -1;  ///< Among the numbers of the truth; -1: not there.
    std::ptrdiff_t rate = -1;
  };
  std::vector<Joint> joints_;
};

}  // namespace rigwire::hil
