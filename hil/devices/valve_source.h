// What a device's client asks of the machine's valves, for others of the rig that follow it.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "emulators/backends.h"
#include "hil/world/valve_sections.h"

namespace rigwire::hil {

class ValveSource {
 public:
  /// The valves must outlive it. Throws as ValveSections.
  ValveSource(const emulators::ValveBackend& valves, std::span<const std::string> sections,
              std::span<const std::string_view> actuators)
      : valves_(valves), sections_(sections, actuators) {}

  /// Its set points, by the machine's actuators, over those of `machine`.
  void lay_over(ValveCommand& machine) const { sections_.lay_over(valves_.command(), machine); }

 private:
  const emulators::ValveBackend& valves_;
  ValveSections sections_;
};

}  // namespace rigwire::hil
