// What the transducers of a machine's ports read, as numbers under names: for recordings and
// replays.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "sim/samples/power_unit_sample.h"
#include "sim/samples/valve_sample.h"
#include "sim/samples/vehicle_sample.h"

namespace rigwire {

/// One member of a sample. All are listed but the time.
struct PortMember {
  std::string_view name;  ///< With its unit: "supply_pressure_pa".
  std::size_t count = 1;  ///< How many numbers it has.
  bool steps = false;     ///< A state (a gear, a lock), which has no values in between.
};

[[nodiscard]] std::vector<PortMember> members_of(const ValveSample& sample);
[[nodiscard]] std::vector<PortMember> members_of(const VehicleSample& sample);
[[nodiscard]] std::vector<PortMember> members_of(const PowerUnitSample& sample);

/// Appends all numbers, in the order of members_of(); truth values are 0 and 1.
void append_numbers(const ValveSample& sample, std::vector<double>& numbers);
void append_numbers(const VehicleSample& sample, std::vector<double>& numbers);
void append_numbers(const PowerUnitSample& sample, std::vector<double>& numbers);

/// Writes such numbers back. Precondition: as many numbers as append_numbers() gives. A state that
/// is not a number stays as it is in the sample.
void take_numbers(std::span<const double> numbers, ValveSample& sample);
void take_numbers(std::span<const double> numbers, VehicleSample& sample);
void take_numbers(std::span<const double> numbers, PowerUnitSample& sample);

}  // namespace rigwire
