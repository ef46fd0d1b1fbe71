#include "sim/driveline/engine.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace rigwire::sim {
namespace {

/// A value with its slope over speed.
struct Line {
  double value = 0.0;
  double slope = 0.0;
};

Line interpolate(const std::vector<TorquePoint>& points, double speed_radps) {
  if (speed_radps <= points.front().speed_radps) {
    return {points.front().torque_nm, 0.0};
  }
  for (std::size_t i = 1; i < points.size(); ++i) {
    if (speed_radps < points[i].speed_radps) {
      const TorquePoint& from = points[i - 1];
      const double slope =
          (points[i].torque_nm - from.torque_nm) / (points[i].speed_radps - from.speed_radps);
      return {from.torque_nm + slope * (speed_radps - from.speed_radps), slope};
    }
  }
  return {points.back().torque_nm, 0.0};
}

}  // namespace

Engine::Engine(const EngineParameters& parameters)
    : parameters_(parameters), reference_torque_nm_(parameters.greatest_torque_nm()) {}

double Engine::full_load_nm(double speed_radps) const {
  return interpolate(parameters_.full_load, speed_radps).value;
}

double Engine::friction_nm(double speed_radps) const {
  return parameters_.drag_nm + parameters_.drag_nmsprad * std::max(0.0, speed_radps);
}

EngineData engine_data(const EngineParameters& parameters) {
  const Engine engine(parameters);
  const auto point = [&engine](double speed_radps) {
    return EnginePoint{speed_radps, engine.full_load_nm(speed_radps),
                       engine.friction_nm(speed_radps)};
  };
  EngineData data;
  for (std::size_t i = 0; i < EngineData::kPoints; ++i) {
    const double way = static_cast<double>(i) / (EngineData::kPoints - 1);
    data.full_load[i] =
        point(parameters.idle_radps + way * (parameters.maximum_radps - parameters.idle_radps));
    data.reference_torque_nm = std::max(
        data.reference_torque_nm, data.full_load[i].torque_nm + data.full_load[i].friction_nm);
  }
  // The maximum indicated torque is at a corner of the curve.
  for (const TorquePoint& corner : parameters.full_load) {
    data.reference_torque_nm = std::max(data.reference_torque_nm,
                                        corner.torque_nm + engine.friction_nm(corner.speed_radps));
  }
  data.high_idle_radps = parameters.cut_off_radps;
  data.governor_nmsprad = parameters.governor_nmsprad;
  data.inertia_kgm2 = parameters.inertia_kgm2;
  return data;
}

double limit_share(const Engine& engine, double reference_nm, double torque_share,
                   double speed_radps) {
  const double full_load_nm = engine.full_load_nm(speed_radps);
  const double limit_nm = torque_share * reference_nm - engine.friction_nm(speed_radps);
  return full_load_nm > 0.0 ? std::clamp(limit_nm / full_load_nm, 0.0, 1.0) : 1.0;
}

void Engine::advance(double h, double speed_radps, const EngineDemand& demand) {
  if (demand.control == EngineControl::speed) {
    const bool taken_over = demand_.control != EngineControl::speed;
    if (taken_over) {
      integral_nm_ = 0.0;
    }
    const double error = demand.speed_radps - speed_radps;
    const EngineTorque now = torque(speed_radps);
    const bool at_limit = !taken_over && ((error > 0.0 && now.torque_nm >= now.greatest_nm) ||
                                          (error < 0.0 && now.torque_nm <= now.least_nm));
    if (!at_limit) {
      // PI governor, T = k (e + integral of e / T_i); no integration against a torque limit.
      integral_nm_ += h * parameters_.governor_nmsprad / parameters_.governor_integral_s * error;
      integral_nm_ = std::clamp(integral_nm_, -reference_torque_nm_, reference_torque_nm_);
    }
  }
  demand_ = demand;
  if (parameters_.torque_lag_s > 0.0) {
    // First-order lag of the torque, exact over h.
    lagged_share_ +=
        (demand.torque_share - lagged_share_) * -std::expm1(-h / parameters_.torque_lag_s);
  } else {
    lagged_share_ = demand.torque_share;
  }
}

EngineTorque Engine::torque(double speed_radps) const {
  const EngineParameters& p = parameters_;
  const Line least{-friction_nm(speed_radps), -p.drag_nmsprad};
  Line greatest = interpolate(p.full_load, speed_radps);
  if (speed_radps > p.maximum_radps) {
    // Cut-off: full load runs linearly down to friction between maximum and cut-off speed.
    const double span = p.cut_off_radps - p.maximum_radps;
    const double left = std::clamp((p.cut_off_radps - speed_radps) / span, 0.0, 1.0);
    const double slope = left > 0.0 ? -(greatest.value - least.value) / span : 0.0;
    greatest = {least.value + left * (greatest.value - least.value),
                left * greatest.slope + (1.0 - left) * least.slope + slope};
  }
  if (demand_.limit_share < 1.0 && greatest.value > 0.0) {
    greatest.value *= demand_.limit_share;
    greatest.slope *= demand_.limit_share;
  }

  if (!demand_.fuel) {
    return {least.value, p.drag_nmsprad, least.value, greatest.value};
  }

  // Proportional plus integral about the set speed, or the lagged share between the two limits.
  Line wanted;
  if (demand_.control == EngineControl::speed) {
    wanted = {p.governor_nmsprad * (demand_.speed_radps - speed_radps) + integral_nm_,
              -p.governor_nmsprad};
  } else {
    wanted = {least.value + lagged_share_ * (greatest.value - least.value),
              least.slope + lagged_share_ * (greatest.slope - least.slope)};
  }
  // Idle governor: proportional below idle, whichever torque is greater.
  const double idle_nm = p.governor_nmsprad * (p.idle_radps - speed_radps);
  if (idle_nm > wanted.value) {
    wanted = {idle_nm, -p.governor_nmsprad};
  }
  // A shift's ramp does not take the idle governor's torque away.
  const double idle_limit = idle_nm > 0.0 ? std::min(idle_nm, full_load_nm(speed_radps)) : 0.0;
  if (greatest.value < idle_limit) {
    greatest = {idle_limit, 0.0};
  }
  if (wanted.value >= greatest.value) {
    wanted = greatest;
  }
  if (wanted.value <= least.value) {
    wanted = least;
  }
  return {wanted.value, std::max(0.0, -wanted.slope), least.value, greatest.value};
}

}  // namespace rigwire::sim
