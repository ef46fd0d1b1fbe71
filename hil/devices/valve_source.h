// What all devices that drive valves have: what their client asks of the machine's valves, for
// others of the rig that follow it, and the faults of their amplifier.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "emulators/backends.h"
#include "emulators/valve_amplifier/settings.h"
#include "hil/configuration/fault_window.h"
#include "hil/world/ports.h"

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

/// What a defect is called, with its section: "open_coil boom".
[[nodiscard]] inline auto valve_fault_names(const emulators::ValveAmplifierSettings& settings) {
  return [sections = settings.sections](const emulators::ValveDefect& defect) {
    const auto section = section_of(defect);
    return section ? kind_name(defect) + " " + sections.at(*section) : kind_name(defect);
  };
}
[[nodiscard]] inline std::vector<FaultWindow> valve_fault_windows(
    const emulators::ValveAmplifierSettings& settings, std::string_view device) {
  return fault_windows(settings.defects, device, valve_fault_names(settings));
}

}  // namespace rigwire::hil
