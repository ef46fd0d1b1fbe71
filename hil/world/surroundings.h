// What goes wrong around the devices of a rig: with the air, and with the parts of its machine that
// can fail. Truth is computed ahead, so that what is begun during a run holds from the next slice
// on.
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "fields/visitor.h"
#include "hil/executive/station.h"
#include "hil/world/world_sensor.h"
#include "sim/engine/power_unit_fault.h"
#include "sim/weather/air_fault.h"

namespace rigwire::hil {

/// The list of faults of something that has no other keys.
template <class Fault>
struct FaultsAlone {
  std::vector<Fault> faults;
};
template <class Fault>
void visit(fields::Visitor& v, FaultsAlone<Fault>& p) {
  v.list("faults", p.faults, "What goes wrong with it, and when.");
}

struct SurroundingsConfiguration {
  FaultsAlone<sim::AirFault> air;
  FaultsAlone<sim::EngineFault> engine;  ///< The machine's.
  FaultsAlone<sim::PumpFault> pumps;
};
inline void visit(fields::Visitor& v, SurroundingsConfiguration& p) {
  v.section("air", p.air, "What comes into the air.");
  v.section("engine", p.engine, "The machine's engine.");
  v.section("pumps", p.pumps, "The machine's pumps.");
}

/// Names of the surroundings in a rig's list of faults, and the keys of their own lists.
struct SurroundingsTarget {
  std::string_view name;  ///< Name for the key `on`.
  std::string_view key;   ///< Key in SurroundingsConfiguration.
};
inline constexpr std::string_view kSurroundings = "surroundings";
inline constexpr std::array<SurroundingsTarget, 3> kSurroundingsTargets{
    {{"air", "air"}, {"machine.engine", "engine"}, {"machine.pumps", "pumps"}}};

/// Station without a device, which passes faults and orders to the truth.
class SurroundingsStation final : public Station {
 public:
  SurroundingsStation();
  [[nodiscard]] SimTime next_event() const override { return kNever; }
  [[nodiscard]] SimTime next_wakeup() const override { return kNever; }
  void advance(SimTime /*now*/) override {}
  std::size_t take(StationIndex /*self*/, const Shelves& /*samples*/) override { return 0; }
};

/// Lets faults of the air begin and end. `before_the_first` is called, with the end of the last
/// slice, when one is about to begin that no file had.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_air(
    StationIndex station, std::shared_ptr<sim::AirFaults> faults,
    std::function<void(SimTime)> before_the_first);
/// Lets engine and pumps fail, step by step. The port must outlive it.
[[nodiscard]] std::unique_ptr<WorldSensor> make_world_power_unit_faults(
    StationIndex station, sim::PowerUnitDefectPort& port, const SurroundingsConfiguration& faults);

}  // namespace rigwire::hil
