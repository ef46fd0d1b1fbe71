// How well a unit's magnetometer measures, and the Earth's field that it is in.
#pragma once

#include <numbers>

#include "fields/visitor.h"
#include "sim/imu/magnetometer.h"

namespace rigwire::hil {

/// There is none unless it is switched on: without, the unit says that the field is not available.
struct MagnetometerConfiguration {
  bool present = false;
  double strength_t = 48.7e-6;
  double declination_rad = 3.0 * std::numbers::pi / 180.0;
  double inclination_rad = 65.0 * std::numbers::pi / 180.0;
  sim::MagnetometerParameters sensor;
};

inline void visit(fields::Visitor& v, MagnetometerConfiguration& p) {
  v.boolean("present", p.present, "Whether the unit has one.");
  v.number("strength", p.strength_t, fields::plain().between(0, 1e-3),
           "Of the Earth's field, T; one vector for the whole scene.");
  v.number("declination", p.declination_rad, fields::in("deg").between(-180, 180),
           "From true to magnetic north, east positive.");
  v.number("inclination", p.inclination_rad, fields::in("deg").between(-90, 90),
           "Downward positive.");
  v.vector3("hard_iron", p.sensor.hard_iron_t, fields::plain(),
            "Of the machine, T, sensor's axes.");
  v.number("noise_density", p.sensor.random.noise_density, fields::plain().at_least(0),
           "T/sqrt(Hz).");
  v.number("turn_on_bias", p.sensor.turn_on_bias_t, fields::plain().at_least(0),
           "T, standard deviation.");
}

/// As the sensor wants it.
[[nodiscard]] inline sim::MagnetometerParameters parameters_of(const MagnetometerConfiguration& p) {
  sim::MagnetometerParameters parameters = p.sensor;
  parameters.earth_field_W_t =
      sim::earth_field_t(p.strength_t, p.declination_rad, p.inclination_rad);
  return parameters;
}

}  // namespace rigwire::hil
