#include "sim/roller/supplements.h"

#include <algorithm>
#include <cmath>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;
using fields::plain;

namespace {

constexpr double kStanding_mps = 1e-3;  // Below, nothing is sprinkled.

void check_filling(double capacity_kg, double initial_kg) {
  fields::require(initial_kg <= capacity_kg, "initial", in("kg").print(initial_kg),
                  "at most capacity, " + in("kg").print(capacity_kg));
}

}  // namespace

void visit(fields::Visitor& v, SprinklerParameters& p) {
  v.number("capacity", p.capacity_kg, in("kg").between(0, 1e6), "Water that the tank holds.");
  v.number("initial", p.initial_kg, in("kg").between(0, 1e6), "Water at the start.");
  v.number("flow", p.flow_kgps, in("kg/s").between(0, 10'000),
           "Water used while the machine moves.");
  v.number("x", p.x_m, in("m").between(-100, 100), "x of the tank's centre in the frame.");
  v.number("height", p.height_m, in("m").at_least(0).at_most(100),
           "Height of the tank's centre above ground.");
}

void visit(fields::Visitor& v, SpreaderParameters& p) {
  v.number("capacity", p.capacity_kg, in("kg").between(0, 1e6), "Chips that the hopper holds.");
  v.number("initial", p.initial_kg, in("kg").between(0, 1e6), "Chips at the start.");
  v.number("width", p.width_m, in("mm").at_least(0).at_most(10'000), "Width that is spread.");
  v.number("rate_max", p.rate_max_kgpm2, in("kg/m2").between(0, 10'000),
           "Most chips that are spread on an area.");
  v.number("x", p.x_m, in("m").between(-100, 100), "x of the hopper's centre in the frame.");
  v.number("height", p.height_m, in("m").at_least(0).at_most(100),
           "Height of the hopper's centre above ground.");
}

void visit(fields::Visitor& v, EdgeCutterParameters& p) {
  v.number("lift", p.lift_m, in("mm").at_least(0).at_most(10'000),
           "Height of the wheel when raised.");
  v.number("lift_time", p.lift_time_s, in("s").between(0.001, 1e5), "Time over the whole lift.");
  v.number("press_share", p.press_share, plain().between(0, 0.99),
           "Share of the lift at which the wheel touches the mat.");
  v.number("lateral", p.lateral_n, in("kN").between(0, 1e6),
           "Lateral reaction on the frame, pressed down and moving.");
  v.number("moving", p.moving_mps, in("m/s").between(1e-4, 300),
           "Speed from which the lateral reaction is full.");
  v.number("x", p.x_m, in("m").between(-100, 100), "x of the wheel in the frame.");
  v.number("y", p.y_m, in("m").between(-100, 100),
           "y of the wheel in the frame; the reaction points away from its side.");
}

void validate(const SprinklerParameters& p) {
  fields::check(p);
  check_filling(p.capacity_kg, p.initial_kg);
}

void validate(const SpreaderParameters& p) {
  fields::check(p);
  check_filling(p.capacity_kg, p.initial_kg);
}

void validate(const EdgeCutterParameters& p) {
  fields::check(p);
}

void Sprinkler::step(double h, double speed_mps) {
  if (std::abs(speed_mps) > kStanding_mps) {
    mass_kg_ = std::max(0.0, mass_kg_ - parameters_.flow_kgps * h);
  }
}

void ChipSpreader::command(double rate_kgpm2) {
  if (std::isfinite(rate_kgpm2)) {
    rate_kgpm2_ = std::clamp(rate_kgpm2, 0.0, parameters_.rate_max_kgpm2);
  }
}

void ChipSpreader::step(double h, double speed_mps) {
  // Mass flow = speed x width x rate.
  mass_kg_ = std::max(0.0, mass_kg_ - std::abs(speed_mps) * parameters_.width_m * rate_kgpm2_ * h);
}

void EdgeCutter::command(double share) {
  if (std::isfinite(share)) {
    wanted_ = std::clamp(share, 0.0, 1.0);
  }
}

void EdgeCutter::step(double h) {
  const double way = h / parameters_.lift_time_s;
  share_ += std::clamp(wanted_ - share_, -way, way);
}

double EdgeCutter::lateral_n(double speed_mps) const {
  // Side force grows linearly with the press and with the speed up to moving_mps.
  const double pressed = std::max(0.0, share_ - parameters_.press_share);
  const double moving = std::min(1.0, std::abs(speed_mps) / parameters_.moving_mps);
  const double away = parameters_.y_m > 0.0 ? -1.0 : 1.0;
  return away * parameters_.lateral_n * moving * pressed / (1.0 - parameters_.press_share);
}

}  // namespace rigwire::sim
