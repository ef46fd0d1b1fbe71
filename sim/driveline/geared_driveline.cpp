#include "sim/driveline/geared_driveline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rigwire::sim {
namespace {

const GearedParameters& checked(const GearedParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

GearedDriveline::GearedDriveline(const GearedParameters& parameters)
    : ClutchedDriveline(checked(parameters).engine, parameters.clutch, parameters.axles),
      gearbox_(parameters.gearbox),
      shift_(parameters.gearbox) {}

bool GearedDriveline::has(const GearSelection& selection) const {
  return selection.gear <= static_cast<int>(gearbox_.forward.size()) &&
         selection.gear >= -static_cast<int>(gearbox_.reverse.size()) &&
         (!selection.crawler_group || gearbox_.crawler_factor > 0.0);
}

double GearedDriveline::gear_ratio(const GearSelection& selection) const {
  if (selection.gear == 0 || !has(selection)) {
    return 0.0;
  }
  const double factor = selection.crawler_group ? gearbox_.crawler_factor : 1.0;
  return selection.gear > 0
             ? gearbox_.forward[static_cast<std::size_t>(selection.gear - 1)] * factor
             : -gearbox_.reverse[static_cast<std::size_t>(-(selection.gear + 1))] * factor;
}

int GearedDriveline::select_gear(double rate_radps, double target_radps, int lower) const {
  const int way = target_radps < 0.0 ? -1 : 1;
  const std::vector<double>& gears = way < 0 ? gearbox_.reverse : gearbox_.forward;
  const int asked = shift_.target().gear;
  if (gears.empty()) {
    return 0;
  }
  const EngineParameters& p = engine().engine().parameters();
  const double crawler = shift_.target().crawler_group ? gearbox_.crawler_factor : 1.0;
  const double selected = p.idle_radps + kSelected * (p.maximum_radps - p.idle_radps);
  // Engine speed in a gear: ratio times the gearbox's output.
  const auto turns = [&](int gear, double wheel_radps) {
    return gears[static_cast<std::size_t>(gear - 1)] * crawler * axle_ratio() *
           std::max(0.0, way * wheel_radps);
  };
  const int count = static_cast<int>(gears.size());
  int best = 1;
  int reached = 1;
  for (int gear = 2; gear <= count; ++gear) {
    best = turns(gear, target_radps) >= selected ? gear : best;
    const bool launches = gears[static_cast<std::size_t>(gear - 1)] >= kLaunches * gears.front();
    reached = launches || turns(gear, rate_radps) >= selected ? gear : reached;
  }
  const int wanted = std::max(1, std::min(best - lower, reached));
  const int present = way * asked;
  const bool keeps = present > wanted && present <= best - lower && present <= count &&
                     turns(present, rate_radps) >= kLeft * selected;
  return way * (keeps ? present : wanted);
}

void GearedDriveline::request(const VehicleCommand& command) {
  const GearSelection wanted{command.gear, command.crawler_group};
  if (has(wanted)) {
    shift_.request(wanted);
  }
}

bool GearedDriveline::permitted(double output_radps) const {
  const GearSelection& target = shift_.target();
  const EngineParameters& engine = this->engine().engine().parameters();
  // The new gear may turn the engine up to its maximum, or backwards up to idle.
  const double input = gear_ratio(target) * output_radps;
  const bool group_may_change = target.crawler_group == shift_.engaged().crawler_group ||
                                std::abs(output_radps) < gearbox_.group_change_radps * axle_ratio();
  return group_may_change && input <= engine.maximum_radps && input >= -engine.idle_radps;
}

void GearedDriveline::advance(double h, double output_radps, Transmission& transmission) {
  shift_.advance(h, permitted(output_radps));

  const GearSelection& engaged = shift_.engaged();
  transmission.gear = engaged.gear;
  transmission.crawler_group = engaged.crawler_group;
  transmission.ratio = gear_ratio(engaged);
  transmission.shifting = shift_.shifting();
  transmission.capacity_share = shift_.torque_share();
  transmission.demand = driver_demand();
  if (shift_.synchronising() && shift_.target().gear != 0) {
    const EngineParameters& engine = this->engine().engine().parameters();
    // Synchronising: the engine governed to the speed that the new gear will give it.
    transmission.demand.control = EngineControl::speed;
    transmission.demand.speed_radps = std::clamp(gear_ratio(shift_.target()) * output_radps,
                                                 engine.idle_radps, engine.maximum_radps);
  } else if (shift_.shifting()) {
    transmission.demand.limit_share = shift_.torque_share();
  }
}

}  // namespace rigwire::sim
