// Faults of a valve amplifier: those that it reports, and defects and events that are injected.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <variant>

#include "fields/rules.h"
#include "sim/samples/fault_book.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

/// What an amplifier reports. The first one stays until it is reset.
enum class ValveFault : std::uint16_t {
  none = 0,
  watchdog = 1,             ///< The master stopped sending.
  open_coil = 2,            ///< A driven coil takes no current.
  over_current = 3,         ///< A driven coil takes more than the stage can give.
  under_voltage = 4,        ///< The supply voltage is too low.
  spool_not_following = 5,  ///< Measured position off the set point for too long.
  sensor = 6,               ///< No position is measured.
  over_temperature = 7,     ///< The output stage is too hot.
  configuration = 8,        ///< Parameters that contradict each other.
};
inline constexpr std::size_t kValveFaults = 9;

/// Defects of one section.
struct SectionDefect {
  std::size_t section = 0;  ///< From 0.

  friend bool operator==(const SectionDefect&, const SectionDefect&) = default;
};
void visit(fields::Visitor& v, SectionDefect& p);

struct OpenCoilDefect : SectionDefect {
  static constexpr fields::Named kNamed{"open", "A wire of a section's coil is broken."};
};
struct ShortedCoilDefect : SectionDefect {
  static constexpr fields::Named kNamed{"short", "A section's coil is a short circuit."};
};
struct StuckSpoolDefect : SectionDefect {
  static constexpr fields::Named kNamed{"stuck_spool", "A section's spool stays where it is."};
};
struct LostSensorDefect : SectionDefect {
  static constexpr fields::Named kNamed{"sensor_failure", "A section's position is not measured."};
};
struct ConnectorOffDefect : SectionDefect {
  static constexpr fields::Named kNamed{"unplugged",
                                        "Neither coil nor sensor of a section is connected."};
};
/// In place of the supply's own voltage.
struct SupplyVoltageDefect {
  static constexpr fields::Named kNamed{"supply", "The supply's voltage is `value`."};

  double value_v = 0.0;
};
/// In place of that of the driver's surroundings.
struct AmbientTemperatureDefect {
  static constexpr fields::Named kNamed{"ambient", "The temperature around the driver is `value`."};

  double value_c = 0.0;
};
void visit(fields::Visitor& v, SupplyVoltageDefect& p);
void visit(fields::Visitor& v, AmbientTemperatureDefect& p);

/// What happens to the amplifier and its surroundings.
struct ValveDefect {
  FaultPeriod when;
  std::variant<OpenCoilDefect, ShortedCoilDefect, StuckSpoolDefect, LostSensorDefect,
               ConnectorOffDefect, SupplyVoltageDefect, AmbientTemperatureDefect>
      what;
};
void visit(fields::Visitor& v, ValveDefect& p);

/// Where several set the same voltage or temperature, the last listed one holds.
using ValveDefects = FaultBook<ValveDefect>;

/// Returns the section that a defect concerns; nullopt for a defect of the surroundings.
[[nodiscard]] std::optional<std::size_t> section_of(const ValveDefect& defect);

/// What holds at one instant.
struct ValveDefectState {
  std::array<bool, kValveSections> coil_open{};
  std::array<bool, kValveSections> coil_shorted{};
  std::array<bool, kValveSections> spool_stuck{};
  std::array<bool, kValveSections> sensor_lost{};
  double supply_voltage_v = 0.0;
  double ambient_c = 0.0;
};

/// `supply_voltage_v` and `ambient_c`: without defects.
[[nodiscard]] ValveDefectState defect_state(const ValveDefects& defects, SimTime now,
                                            double supply_voltage_v, double ambient_c);

}  // namespace rigwire::emulators
