// What can go wrong with a valve amplifier: what it reports, and what somebody does to it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fields/rules.h"
#include "sim/samples/time.h"
#include "sim/samples/valve_sample.h"

namespace rigwire::emulators {

/// What an amplifier reports. The first one stays until it is reset.
enum class ValveFault : std::uint16_t {
  none = 0,
  watchdog = 1,             ///< The master was silent.
  open_coil = 2,            ///< A driven coil takes no current.
  over_current = 3,         ///< A driven coil takes more than the stage can give.
  under_voltage = 4,        ///< Of the electrical supply.
  spool_not_following = 5,  ///< Measured position off the set point for too long.
  sensor = 6,               ///< No position is measured.
  over_temperature = 7,     ///< Of the output stage.
  configuration = 8,        ///< Parameters that contradict each other.
};
inline constexpr std::size_t kValveFaults = 9;

/// What happens to the amplifier's surroundings.
enum class ValveDefectKind : std::uint8_t {
  open_coil,            ///< Of one section: a broken wire.
  short_circuit,        ///< Of one section's coil.
  stuck_spool,          ///< Of one section: the spool stays where it is then.
  sensor_failure,       ///< Of one section: no position.
  connector_off,        ///< Of one section: neither coil nor sensor.
  supply_voltage,       ///< `value`, V, in place of the supply's own.
  ambient_temperature,  ///< `value`, degC, in place of the driver's surroundings.
};

/// One of them, from an instant for a while.
struct ValveDefect {
  ValveDefectKind kind = ValveDefectKind::open_coil;
  std::size_t section = 0;  ///< From 0; not of supply and surroundings.
  Duration start{0};        ///< After the start of the run.
  Duration duration{0};     ///< 0: to the end of the run.
  double value = 0.0;

  friend bool operator==(const ValveDefect&, const ValveDefect&) = default;
};

/// The unit of `value` is the kind's own, its range also.
void visit(fields::Visitor& v, ValveDefect& p);

/// What holds at one instant.
struct ValveDefectState {
  std::array<bool, kValveSections> coil_open{};
  std::array<bool, kValveSections> coil_shorted{};
  std::array<bool, kValveSections> spool_stuck{};
  std::array<bool, kValveSections> sensor_lost{};
  double supply_voltage_v = 0.0;
  double ambient_c = 0.0;
};

/// The defects of a run. Of several that set the same voltage or temperature the last listed holds.
class ValveDefects {
 public:
  explicit ValveDefects(std::vector<ValveDefect> defects) : defects_(std::move(defects)) {}

  /// From its start on, up to but without its end. `supply_voltage_v` and `ambient_c`: without
  /// defects.
  [[nodiscard]] ValveDefectState at(SimTime now, double supply_voltage_v, double ambient_c) const;
  /// The next start or end later than `now`.
  [[nodiscard]] SimTime next_change(SimTime now) const;

 private:
  std::vector<ValveDefect> defects_;
};

}  // namespace rigwire::emulators
