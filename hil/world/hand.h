// Manual override of the machine: set points of its ports that act in place of the client's, each
// until it is released.
//
// The client's set points are still received: the last one acts again when the override is
// released. The valves' are restored before the devices' commands of each slice are taken, and the
// overrides applied again after them, so that no step of the physics uses an overridden set point
// of a client.
//
// An Order comes with the requests of a slice and acts from the beginning of that slice. All
// functions are called on the thread of the truth.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "fields/visitor.h"
#include "hil/executive/shelves.h"
#include "sim/machine.h"

namespace rigwire::hil {

/// The set points of a machine that can be overridden, with their values: read like any structure.
class HandSettings {
 public:
  enum class Kind {
    opening,
    engine_speed,
    torque_limit,
    travel_speed,
    brake,
    parking_brake,
    front_steer,
    rear_steer,
  };
  struct Row {
    std::string name;
    Kind kind = Kind::opening;
    std::size_t actuator = 0;  ///< Index of the actuator of an opening.
    double value = 0.0;        ///< Value that the port takes; 0 or 1 for a switch.
  };

  /// Lists the set points that the machine has.
  explicit HandSettings(sim::Machine& machine);

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::vector<std::string> names() const;
  /// Returns the row of that name; null: there is none.
  [[nodiscard]] const Row* find(std::string_view name) const;

  friend void visit(fields::Visitor& v, HandSettings& p);

 private:
  std::vector<Row> rows_;
};
void visit(fields::Visitor& v, HandSettings& p);

class Hand {
 public:
  /// The machine must outlive it.
  explicit Hand(sim::Machine& machine);

  /// Returns what can be set, each with its value at rest.
  [[nodiscard]] const HandSettings& settings() const { return settings_; }

  /// Request to the truth; an empty `value` releases the set point. Rows are those of settings().
  struct Order {
    HandSettings::Row row;
    std::optional<double> value;
  };

  /// Restores the devices' valve commands; to be called before those of a slice are taken.
  void lift();
  /// Takes the orders and applies the overrides; to be called after the devices' commands, which
  /// `requests` has, are taken.
  void lay(SimTime frontier, const Shelves& requests);
  /// Returns the set points that are overridden at present; the names live as long as this object.
  [[nodiscard]] const std::vector<std::string_view>& held() const { return held_; }

 private:
  void lay_valves(SimTime frontier);
  void lay_vehicle(SimTime frontier, bool anew);
  void lay_power_unit(SimTime frontier, bool anew);
  [[nodiscard]] bool holds(HandSettings::Kind kind) const;

  sim::Machine& machine_;
  HandSettings settings_;
  std::map<std::string, double> values_;  ///< Values of the overridden set points.
  std::vector<std::string_view> held_;
  /// Command of the devices while an actuator is overridden.
  std::optional<ValveCommand> valves_;
  VehicleCommand vehicle_;       ///< Last command of the devices.
  PowerUnitCommand power_unit_;  ///< Last command of the devices.
};

}  // namespace rigwire::hil
