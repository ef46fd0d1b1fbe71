#include "sim/imu/magnetometer.h"

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

namespace {

const MagnetometerParameters& checked(const MagnetometerParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

Eigen::Vector3d earth_field_t(double strength_t, double declination_rad, double inclination_rad) {
  // Declination from north to east, inclination downward.
  const double level = strength_t * std::cos(inclination_rad);
  return {level * std::sin(declination_rad), level * std::cos(declination_rad),
          -strength_t * std::sin(inclination_rad)};
}

void visit(fields::Visitor& v, MagnetometerParameters& p) {
  v.vector3("hard_iron", p.hard_iron_t, in("T").between(-1, 1),
            "Field of the machine's own magnets, in the sensor's axes.");
  v.number("noise_density", p.random.noise_density, in("T/sqrt(Hz)").at_least(0),
           "White noise of the field.");
  v.number("turn_on_bias", p.turn_on_bias_t, in("T").at_least(0),
           "Standard deviation of the bias, drawn at each start.");
}

void visit(fields::Visitor& v, MagnetometerConfiguration& p) {
  v.boolean("present", p.present, "Whether the unit has a magnetometer.");
  v.only_if(p.present, "present", "present: true", [&p](fields::Visitor& w) {
    w.number("strength", p.strength_t, in("T").between(0, 1e-3),
             "Strength of the Earth's field, one vector for the whole scene.");
    w.number("declination", p.declination_rad, in("deg").between(-180, 180),
             "From true to magnetic north, east positive.");
    w.number("inclination", p.inclination_rad, in("deg").between(-90, 90),
             "Dip of the Earth's field below the horizontal.");
    visit(w, p.sensor);
  });
}

MagnetometerParameters parameters_of(const MagnetometerConfiguration& configuration) {
  MagnetometerParameters parameters = configuration.sensor;
  parameters.earth_field_W_t = earth_field_t(
      configuration.strength_t, configuration.declination_rad, configuration.inclination_rad);
  return parameters;
}

void validate(const MagnetometerParameters& p) {
  fields::check(p);
  // What no file can change.
  const auto require = [](bool fine, const char* name, double found, const char* allowed) {
    if (!std::isfinite(found) || !fine) {
      std::ostringstream text;
      text.precision(9);
      text << "magnetometer: " << name << " is " << found << ", allowed is " << allowed;
      throw std::invalid_argument(text.str());
    }
  };
  constexpr double kStrongest_t = 1.0;
  require(p.earth_field_W_t.norm() < kStrongest_t, "earth_field_W_t", p.earth_field_W_t.norm(),
          "less than 1 T");
  require(true, "current_effect_tpa", p.current_effect_tpa.norm(), "finite");
  const double determinant = p.soft_iron.determinant();
  require(determinant > 0.0, "determinant of soft_iron", determinant, "greater than 0");
  const auto not_negative = [&](const char* name, double found) {
    require(found >= 0.0, name, found, "0 or more");
  };
  not_negative("bias_instability", p.random.bias_instability);
  not_negative("random_walk", p.random.random_walk);
  not_negative("range_t", p.range_t);
  not_negative("resolution_t", p.resolution_t);
  require(p.nominal_period_s > 0.0, "nominal_period_s", p.nominal_period_s, "greater than 0");
}

MagnetometerParameters mti30_magnetometer() {
  MagnetometerParameters p;
  p.random.noise_density = 20e-9;
  p.range_t = 8e-4;
  p.resolution_t = 25e-9;
  return p;
}

MagnetometerParameters mti300_magnetometer() {
  MagnetometerParameters p = mti30_magnetometer();
  p.random.noise_density = 50e-9 / std::sqrt(50.0);
  return p;
}

Magnetometer::Magnetometer(const MagnetometerParameters& parameters, std::uint64_t seed,
                           std::string_view name)
    : parameters_(checked(parameters)),
      random_(seed, std::string(name) + "/magnetometer"),
      bias_t_(parameters.turn_on_bias_t * gaussian3(random_)),
      errors_(parameters.random, random_) {}

MagnetometerSample Magnetometer::sample(SimTime time, const LinkMotion& mount, double current_a) {
  const double dt_s =
      previous_ && time > *previous_ ? to_seconds(time - *previous_) : parameters_.nominal_period_s;
  previous_ = time;
  const Eigen::Vector3d field_S = mount.X_WL.linear().transpose() * parameters_.earth_field_W_t;
  // y = soft_iron b + hard_iron + current_effect I + bias + noise, then quantised and clamped.
  Eigen::Vector3d value = parameters_.soft_iron * field_S + parameters_.hard_iron_t +
                          current_a * parameters_.current_effect_tpa + bias_t_ +
                          errors_.next(dt_s, random_);
  if (parameters_.resolution_t > 0.0) {
    value = (value / parameters_.resolution_t).array().round() * parameters_.resolution_t;
  }
  if (parameters_.range_t > 0.0) {
    value = value.cwiseMax(-parameters_.range_t).cwiseMin(parameters_.range_t);
  }
  return {time, {value.x(), value.y(), value.z()}};
}

}  // namespace rigwire::sim
