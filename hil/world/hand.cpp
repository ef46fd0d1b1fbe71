#include "hil/world/hand.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

namespace rigwire::hil {

using fields::in;

using Kind = HandSettings::Kind;

HandSettings::HandSettings(sim::Machine& machine) {
  if (const sim::ValvePort* valves = machine.valve_port()) {
    for (std::size_t i = 0; i < valves->actuators().size(); ++i) {
      rows_.push_back({std::string(valves->actuators()[i]), Kind::opening, i, 0.0});
    }
  }
  if (machine.power_unit_port() != nullptr) {
    rows_.push_back({"engine_speed", Kind::engine_speed, 0, 0.0});
    rows_.push_back({"engine_torque_limit", Kind::torque_limit, 0, 1.0});
  }
  if (machine.vehicle_port() != nullptr && machine.vehicle_port()->vehicle_sample(kStart).drives) {
    rows_.push_back({"travel_speed", Kind::travel_speed, 0, 0.0});
    rows_.push_back({"brake", Kind::brake, 0, 0.0});
    rows_.push_back({"parking_brake", Kind::parking_brake, 0, 0.0});
    rows_.push_back({"front_steer", Kind::front_steer, 0, 0.0});
    if (machine.vehicle_port()->steers_rear()) {
      rows_.push_back({"rear_steer", Kind::rear_steer, 0, 0.0});
    }
  }
}

std::vector<std::string> HandSettings::names() const {
  std::vector<std::string> names;
  std::ranges::transform(rows_, std::back_inserter(names), &Row::name);
  return names;
}

const HandSettings::Row* HandSettings::find(std::string_view name) const {
  const auto found = std::ranges::find(rows_, name, &Row::name);
  return found == rows_.end() ? nullptr : &*found;
}

void visit(fields::Visitor& v, HandSettings& p) {
  constexpr double kSteepest_deg = 90.0;
  for (HandSettings::Row& row : p.rows_) {
    switch (row.kind) {
      case Kind::opening:
        v.number(row.name, row.value, in("1").between(-1, 1),
                 "Set point of the valve section, of full spool travel.");
        break;
      case Kind::engine_speed:
        v.number(row.name, row.value, in("rpm").between(0, 10'000),
                 "Speed of the engine that drives the pumps, in place of its dial; within idle and "
                 "maximum.");
        break;
      case Kind::torque_limit:
        v.number(row.name, row.value, in("1").between(0, 1),
                 "Greatest share of the pump engine's torque.");
        break;
      case Kind::travel_speed:
        v.number(
            row.name, row.value, in("km/h").between(-100, 100),
            "Travel speed that the machine's own controller holds with the gears that it chooses, "
            "reverse negative.");
        break;
      case Kind::brake:
        v.number(row.name, row.value, in("1").between(0, 1), "Service brake, of its full torque.");
        break;
      case Kind::parking_brake: {
        bool on = row.value != 0.0;
        v.boolean(row.name, on, "Whether the parking brake is on.");
        row.value = on ? 1.0 : 0.0;
        break;
      }
      case Kind::front_steer:
        v.number(row.name, row.value, in("deg").between(-kSteepest_deg, kSteepest_deg),
                 "Angle of the front axle's equivalent wheel, or of the drum, left positive; "
                 "within what it has.");
        break;
      case Kind::rear_steer:
        v.number(row.name, row.value, in("deg").between(-kSteepest_deg, kSteepest_deg),
                 "Angle of the rear axle's equivalent wheel, or of the rear drum, left positive; "
                 "within what it has.");
        break;
    }
  }
}

Hand::Hand(sim::Machine& machine) : machine_(machine), settings_(machine) {}

bool Hand::holds(Kind kind) const {
  return std::ranges::any_of(settings_.rows(), [&](const HandSettings::Row& row) {
    return row.kind == kind && values_.contains(row.name);
  });
}

void Hand::lift() {
  if (valves_) {
    machine_.valve_port()->command(*valves_);
    valves_.reset();
  }
}

void Hand::lay(SimTime frontier, const Shelves& requests) {
  bool vehicle_anew = false;
  bool power_unit_anew = false;
  for (std::size_t station = 0; station < requests.stations(); ++station) {
    // The devices' last commands are kept: they apply again when an override is released.
    if (const auto* asked = requests.find<VehicleCommand>(station); asked && !asked->empty()) {
      vehicle_ = asked->back();
      vehicle_anew = true;
    }
    if (const auto* asked = requests.find<PowerUnitCommand>(station); asked && !asked->empty()) {
      power_unit_ = asked->back();
      power_unit_anew = true;
    }
  }
  const std::vector<Order>* const orders = requests.find<Order>(0);
  const bool changed = orders != nullptr && !orders->empty();
  for (const Order& order : changed ? std::span(*orders) : std::span<const Order>()) {
    if (order.value) {
      values_[order.row.name] = *order.value;
    } else {
      values_.erase(order.row.name);
    }
  }
  if (changed) {
    held_.clear();
    for (const HandSettings::Row& row : settings_.rows()) {
      if (values_.contains(row.name)) {
        held_.emplace_back(row.name);
      }
    }
  }
  if (values_.empty() && !changed) {
    return;
  }
  // Valves are overridden in every slice, since lift() restores them; the other ports only when
  // a command or an override has changed.
  lay_valves(frontier);
  lay_vehicle(frontier, changed || vehicle_anew);
  lay_power_unit(frontier, changed || power_unit_anew);
}

void Hand::lay_valves(SimTime frontier) {
  if (!holds(Kind::opening)) {
    return;
  }
  valves_ = machine_.valve_port()->commanded();
  ValveCommand block = *valves_;
  block.time = frontier;
  for (const HandSettings::Row& row : settings_.rows()) {
    if (const auto value = values_.find(row.name);
        row.kind == Kind::opening && value != values_.end()) {
      block.opening[row.actuator] = value->second;
      block.floating[row.actuator] = false;
    }
  }
  machine_.valve_port()->command(block);
}

/// Commands the vehicle port: the devices' last command with the overridden set points replaced.
void Hand::lay_vehicle(SimTime frontier, bool anew) {
  sim::VehiclePort* const port = machine_.vehicle_port();
  if (port == nullptr || !anew) {
    return;
  }
  VehicleCommand command = vehicle_;
  command.time = frontier;
  for (const HandSettings::Row& row : settings_.rows()) {
    const auto found = values_.find(row.name);
    if (found == values_.end()) {
      continue;
    }
    const double value = found->second;
    switch (row.kind) {
      case Kind::travel_speed:
        command.travel_speed_mps = value;
        command.automatic_gear = true;
        break;
      case Kind::brake:
        command.brake_share = value;
        break;
      case Kind::parking_brake:
        command.parking_brake = value != 0.0;
        break;
      case Kind::front_steer:
        command.front_steer_rad = value;
        break;
      case Kind::rear_steer:
        command.rear_steer_rad = value;
        break;
      case Kind::opening:
      case Kind::engine_speed:
      case Kind::torque_limit:
        break;
    }
  }
  port->command(command);
}

void Hand::lay_power_unit(SimTime frontier, bool anew) {
  sim::PowerUnitPort* const port = machine_.power_unit_port();
  if (port == nullptr || !anew) {
    return;
  }
  PowerUnitCommand command = power_unit_;
  command.time = frontier;
  for (const HandSettings::Row& row : settings_.rows()) {
    const auto found = values_.find(row.name);
    if (found == values_.end()) {
      continue;
    }
    if (row.kind == Kind::engine_speed) {
      command.speed_radps = found->second;
    } else if (row.kind == Kind::torque_limit) {
      command.torque_limit_share = found->second;
    }
  }
  port->command(command);
}

}  // namespace rigwire::hil
