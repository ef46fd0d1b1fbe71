// Which of the machine's actuators each section of a device's valve block moves. Devices count
// sections from 0 in the order of their key `sections`; the machine counts its actuators.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sim/samples/valve_sample.h"

namespace rigwire::hil {

class ValveSections {
 public:
  /// The section of each name moves the actuator of that name. Throws std::invalid_argument for a
  /// name that is not one of `actuators`, and for one that comes twice.
  ValveSections(std::span<const std::string> names, std::span<const std::string_view> actuators);

  /// The device's set points laid over those of the machine; actuators that no section moves keep
  /// theirs. The time is the device's.
  void lay_over(const ValveCommand& device, ValveCommand& machine) const;
  /// What the device's transducers read: those of its own sections, 0 beyond the last.
  [[nodiscard]] ValveSample of_device(const ValveSample& machine) const;

 private:
  std::vector<std::size_t> actuators_;  ///< By section.
};

}  // namespace rigwire::hil
