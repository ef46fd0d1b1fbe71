#include "sim/driveline/hydrostatic_drive.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

void require(bool fine, const char* where, const char* member, double found, const char* allowed) {
  if (!fine) {
    std::ostringstream message;
    message << where << "." << member << ": found " << found << ", allowed " << allowed;
    throw std::invalid_argument(message.str());
  }
}

// First-order lag towards a constant over h, exactly.
double lag(double value, double target, double h, double time_constant_s) {
  return time_constant_s > 0.0 ? target + (value - target) * std::exp(-h / time_constant_s)
                               : target;
}

}  // namespace

void validate(const HydrostaticDriveParameters& p, const char* where) {
  const auto positive = [where](const char* member, double value) {
    require(std::isfinite(value) && value > 0.0, where, member, value, "finite and > 0");
  };
  const auto not_negative = [where](const char* member, double value) {
    require(std::isfinite(value) && value >= 0.0, where, member, value, "finite and >= 0");
  };
  positive("motor_displacement_m3prad", p.motor_displacement_m3prad);
  positive("pump_displacement_m3prad", p.pump_displacement_m3prad);
  positive("oil_volume_m3", p.oil_volume_m3);
  positive("bulk_modulus_pa", p.bulk_modulus_pa);
  not_negative("leakage_m3pspa", p.leakage_m3pspa);
  positive("relief_pressure_pa", p.relief_pressure_pa);
  not_negative("charge_pressure_pa", p.charge_pressure_pa);
  not_negative("motor_friction_nmsprad", p.motor_friction_nmsprad);
  positive("ramp_mps2", p.ramp_mps2);
  not_negative("swash_time_constant_s", p.swash_time_constant_s);
  positive("speed_max_mps", p.speed_max_mps);
  positive("engine_idle_radps", p.engine_idle_radps);
  require(std::isfinite(p.engine_rated_radps) && p.engine_rated_radps >= p.engine_idle_radps, where,
          "engine_rated_radps", p.engine_rated_radps, "finite and >= engine_idle_radps");
  positive("engine_torque_nm", p.engine_torque_nm);
  require(p.engine_droop >= 0.0 && p.engine_droop <= 0.5, where, "engine_droop", p.engine_droop,
          "0 .. 0.5");
  not_negative("engine_time_constant_s", p.engine_time_constant_s);
}

HydrostaticDrive::HydrostaticDrive(const HydrostaticDriveParameters& parameters, double radius_m)
    : parameters_(parameters),
      radius_m_(radius_m),
      engine_speed_radps_(parameters.engine_idle_radps),
      limit_pa_(parameters.bypass ? 0.0 : parameters.relief_pressure_pa),
      divided_(parameters.flow_divider) {
  validate(parameters, "hydrostatic drive");
}

void HydrostaticDrive::begin(double h) {
  const HydrostaticDriveParameters& p = parameters_;
  const double wanted = std::clamp(demand_.travel_speed_mps, -p.speed_max_mps, p.speed_max_mps);
  const double away = wanted - set_point_mps_;
  const double ramp_s = std::min(h, std::abs(away) / p.ramp_mps2);
  // Over the step: the ramp's mean while it lasts, then its end.
  const double after = std::abs(away) <= p.ramp_mps2 * h
                           ? wanted
                           : set_point_mps_ + std::copysign(p.ramp_mps2 * h, away);
  mean_set_point_mps_ = after - (after - set_point_mps_) * 0.5 * ramp_s / h;
  set_point_mps_ = after;

  const double governor =
      std::clamp(demand_.engine_speed_radps, p.engine_idle_radps, p.engine_rated_radps);
  const double load = std::clamp(pump_torque_nm() / p.engine_torque_nm, -1.0, 1.0) * p.engine_droop;
  engine_speed_radps_ =
      lag(engine_speed_radps_, governor * (1.0 - load), h, p.engine_time_constant_s);

  // The lever asks for a displacement: flow follows the engine's droop. An engine that still runs
  // down from a higher speed gets less of it.
  const double asked_flow = 2.0 * p.motor_displacement_m3prad * set_point_mps_ / radius_m_;
  const double asked =
      asked_flow / (std::max(governor, engine_speed_radps_) * p.pump_displacement_m3prad);
  swash_ = lag(swash_, std::clamp(asked, -1.0, 1.0), h, p.swash_time_constant_s);

  if (demand_.flow_divider != divided_ && !p.flow_divider) {
    divided_ = demand_.flow_divider;
    if (!divided_) {
      pressure_pa_.fill(0.5 * (pressure_pa_[0] + pressure_pa_[1]));
    }
  }

  // Torque limit: displacement times pressure is at most the engine's torque. The flow's slope
  // against pressure goes into the solve, where it acts as a leak.
  const double pressure = pressure_pa();
  const double full = p.pump_displacement_m3prad * swash_ * pressure;
  limited_swash_ = swash_;
  double slope = 0.0;
  if (full > p.engine_torque_nm) {
    limited_swash_ = swash_ * p.engine_torque_nm / full;
    slope = engine_speed_radps_ * p.pump_displacement_m3prad * limited_swash_ / pressure;
  }
  pump_flow_m3ps_ = engine_speed_radps_ * p.pump_displacement_m3prad * limited_swash_;

  const double share = divided_ ? 0.5 : 1.0;
  const double capacity = share * p.oil_volume_m3 / p.bulk_modulus_pa;
  for (std::size_t i = 0; i < circuits(); ++i) {
    HydrostaticCircuit& circuit = circuits_[i];
    const double flow = share * (pump_flow_m3ps_ + slope * pressure);
    const double scale = 1.0 / (1.0 + h * share * (p.leakage_m3pspa + slope) / capacity);
    circuit.law.offset = (pressure_pa_[i] + h * flow / capacity) * scale;
    circuit.law.gain = h / capacity * scale;
    circuit.displacement_m3prad = {divided_ && i == 1 ? 0.0 : p.motor_displacement_m3prad,
                                   divided_ && i == 0 ? 0.0 : p.motor_displacement_m3prad};
    if (p.bypass) {
      circuit.law = {};
    }
  }
}

void HydrostaticDrive::finish(const std::array<double, 2>& pressures_pa) {
  pressure_pa_ = {pressures_pa[0], divided_ ? pressures_pa[1] : pressures_pa[0]};
}

double HydrostaticDrive::pressure_pa() const {
  return 0.5 * (pressure_pa_[0] + pressure_pa_[1]);
}

double HydrostaticDrive::gauge_pressure_pa() const {
  return parameters_.charge_pressure_pa +
         std::max(std::abs(pressure_pa_[0]), std::abs(pressure_pa_[1]));
}

double HydrostaticDrive::pump_torque_nm() const {
  return parameters_.pump_displacement_m3prad * limited_swash_ * pressure_pa();
}

double HydrostaticDrive::engine_torque_share() const {
  return std::clamp(pump_torque_nm() / parameters_.engine_torque_nm, -1.0, 1.0);
}

}  // namespace rigwire::sim
