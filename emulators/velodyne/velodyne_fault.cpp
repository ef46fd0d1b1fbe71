#include "emulators/velodyne/velodyne_fault.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace rigwire::emulators {

std::string_view name(VelodyneFaultKind kind) {
  static constexpr std::array<std::string_view, 12> kNames{
      "lost_packets",  "swapped_packets", "duplicated_packets", "dead_laser",
      "dirty_window",  "motor_stall",     "pulse_loss",         "pulse_noise",
      "sentence_loss", "clock_offset",    "hour_overrun",       "factory_bytes"};
  return kNames[static_cast<std::size_t>(kind)];
}

const VelodyneFault* find_fault(std::span<const VelodyneFault> faults, VelodyneFaultKind kind,
                                SimTime instant) {
  const auto found = std::ranges::find_if(faults, [&](const VelodyneFault& fault) {
    return fault.kind == kind && fault.holds(instant);
  });
  return found == faults.end() ? nullptr : &*found;
}

}  // namespace rigwire::emulators
