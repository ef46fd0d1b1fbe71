// A hand on the machine's sticks, beside its client's: set points of the machine's ports that hold
// in place of what the client asks for, each until it is released.
//
// Under the hand the client's set points go on: what it asked for last holds again when the hand
// lets go. The valves' are put back before the devices' commands of each slice and laid over again
// behind them, so that no step of the physics sees anything but the hand's.
//
// order() may come from any thread, and acts from the beginning of the next slice that is computed;
// everything else is on the thread of the truth.
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

/// What a hand can set of one machine, with the values that it is given: read like any structure.
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
    std::size_t actuator = 0;  ///< Of an opening.
    double value = 0.0;        ///< As the port takes it; of what is on or off 0 or 1.
  };

  /// Of what the machine has.
  explicit HandSettings(sim::Machine& machine);

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::vector<std::string> names() const;
  /// Null: there is none of that name.
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

  /// What can be set, each with its value at rest.
  [[nodiscard]] const HandSettings& settings() const { return settings_; }

  /// What is asked of the truth: `value` nothing: it is released. Rows are those of settings().
  struct Order {
    HandSettings::Row row;
    std::optional<double> value;
  };

  /// Before the devices' commands of a slice are taken.
  void lift();
  /// Behind them: `requests` has what they are, and the orders.
  void lay(SimTime frontier, const Shelves& requests);
  /// Of the set points that it holds at present; the names hold as long as the hand.
  [[nodiscard]] const std::vector<std::string_view>& held() const { return held_; }

 private:
  void lay_valves(SimTime frontier);
  void lay_vehicle(SimTime frontier, bool anew);
  void lay_power_unit(SimTime frontier, bool anew);
  [[nodiscard]] bool holds(HandSettings::Kind kind) const;

  sim::Machine& machine_;
  HandSettings settings_;
  std::map<std::string, double> values_;  ///< Of what is held.
  std::vector<std::string_view> held_;
  std::optional<ValveCommand> valves_;  ///< The client's, while the hand holds an actuator.
  VehicleCommand vehicle_;              ///< The client's.
  PowerUnitCommand power_unit_;         ///< Likewise.
};

}  // namespace rigwire::hil
