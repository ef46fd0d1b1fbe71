// What all devices that drive valves have: what their client asks of the machine's valves, for
// others of the rig that follow it, and the faults of their amplifier.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <variant>
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

/// What a fault is called, one of a valve section with its name: "open boom".
template <class Fault>
[[nodiscard]] std::string valve_fault_name(const Fault& fault,
                                           const emulators::ValveAmplifierSettings& settings) {
  const auto section = std::visit(
      []<class What>(const What& what) -> std::optional<std::size_t> {
        if constexpr (std::is_base_of_v<emulators::SectionDefect, What>) {
          return what.section;
        } else {
          return std::nullopt;
        }
      },
      fault.what);
  return section && *section < settings.sections.size()
             ? kind_name(fault) + " " + settings.sections[*section]
             : kind_name(fault);
}
[[nodiscard]] inline auto valve_fault_names(const emulators::ValveAmplifierSettings& settings) {
  return [settings](const emulators::ValveDefect& defect) {
    return valve_fault_name(defect, settings);
  };
}

}  // namespace rigwire::hil
