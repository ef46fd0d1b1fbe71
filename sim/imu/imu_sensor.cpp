#include "sim/imu/imu_sensor.h"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include "fields/check.h"
#include "fields/visitor.h"

namespace rigwire::sim {

using fields::in;

namespace {

constexpr double kEarthRate_radps = 7.292115e-5;  // WGS-84
constexpr double kReferenceTemperature_c = 25.0;
constexpr double kStandardGravity_mps2 = 9.80665;

constexpr std::array<fields::Choice<ImuPart>, 5> kImuParts{
    {{ImuPart::perfect, "perfect", "No error at all."},
     {ImuPart::openimu300, "openimu300", "Class of the ACEINNA OpenIMU300."},
     {ImuPart::adis16470, "adis16470", "Analog Devices ADIS16470."},
     {ImuPart::mti300, "mti300", "Xsens MTi-300."},
     {ImuPart::mti30, "mti30", "Xsens MTi-30."}}};
constexpr std::array<fields::Choice<ImuAcceleration>, 2> kImuAccelerations{
    {{ImuAcceleration::solver, "solver", "Acceleration by the machine's equations."},
     {ImuAcceleration::velocity_difference, "velocity_difference",
      "The paper's: change of velocity between two samples."}}};

/// Keys of both triads; the matrix of scale and misalignment is one of small angles.
void visit_axes(fields::Visitor& v, InertialTriadParameters& p) {
  v.number("scale_error", p.scale_error, in("%").between(0, 50),
           "Standard deviation of each axis' scale.");
  v.number("misalignment", p.misalignment_rad, in("deg").between(0, 30),
           "Standard deviation of the angles by which axes are askew.");
  v.number("scale_temperature", p.scale_temperature, in("1/K").between(-0.01, 0.01),
           "Change of the scale with the case's temperature, from 25 degC.");
}

void visit_gyroscope(fields::Visitor& v, InertialTriadParameters& p) {
  v.number("range", p.range, in("deg/s").at_least(0),
           "Rates beyond it are clamped; 0 = unlimited.");
  v.number("resolution", p.resolution, in("deg/s").at_least(0),
           "One count of the rates; 0 = continuous.");
  v.number("noise_density", p.random.noise_density, in("deg/s/sqrt(Hz)").at_least(0),
           "White noise of the rates.");
  v.number("bias_instability", p.random.bias_instability, in("deg/h").at_least(0),
           "Floor of the rates' Allan deviation.");
  v.number("random_walk", p.random.random_walk, in("rad/s/sqrt(s)").at_least(0),
           "Random walk of the rates' bias.");
  v.number("turn_on_bias", p.turn_on_bias, in("deg/s").at_least(0),
           "Standard deviation of the rates' bias, drawn at each start.");
  v.number("bias_temperature", p.bias_temperature, in("deg/s"),
           "Change of the rates' bias per kelvin of the case, from 25 degC.");
  visit_axes(v, p);
}

void visit_accelerometer(fields::Visitor& v, InertialTriadParameters& p) {
  v.number("range", p.range, in("m/s2").at_least(0),
           "Forces beyond it are clamped; 0 = unlimited.");
  v.number("resolution", p.resolution, in("m/s2").at_least(0),
           "One count of the forces; 0 = continuous.");
  v.number("noise_density", p.random.noise_density, in("ug/sqrt(Hz)").at_least(0),
           "White noise of the forces.");
  v.number("bias_instability", p.random.bias_instability, in("ug").at_least(0),
           "Floor of the forces' Allan deviation.");
  v.number("random_walk", p.random.random_walk, in("m/s2/sqrt(s)").at_least(0),
           "Random walk of the forces' bias.");
  v.number("turn_on_bias", p.turn_on_bias, in("mg").at_least(0),
           "Standard deviation of the forces' bias, drawn at each start.");
  v.number("bias_temperature", p.bias_temperature, in("mg"),
           "Change of the forces' bias per kelvin of the case, from 25 degC.");
  visit_axes(v, p);
}

const ImuParameters& checked(const ImuParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

void visit(fields::Visitor& v, ImuParameters& p) {
  // A part sets all the others; keys beside it are read after it and count more. Printing visits
  // with the part already chosen and changes nothing.
  const ImuPart before = p.part;
  v.choice("part", p.part, kImuParts, "Set of parameters that the other keys change.");
  if (p.part != before) {
    p = parameters_of(p.part);
  }
  v.choice("acceleration", p.acceleration, kImuAccelerations, "Where accelerations come from.");
  v.group(
      "gyroscope", [&p](fields::Visitor& keys) { visit_gyroscope(keys, p.gyroscope); },
      "Errors of the angular rates.");
  v.group(
      "accelerometer", [&p](fields::Visitor& keys) { visit_accelerometer(keys, p.accelerometer); },
      "Errors of the specific forces.");
  v.number("g_sensitivity", p.g_sensitivity_radps_per_mps2, in("rad/s/(m/s2)"),
           "Angular rate that is read per specific force along the same axis.");
  v.number("ambient_temperature", p.ambient_temperature_c, in("degC").between(-60, 150),
           "Temperature around the device.");
  v.number("self_heating", p.self_heating_k, in("K").at_least(0),
           "How much warmer than its surroundings the warm device is.");
  v.number("warm_up", p.warm_up_s, in("s").above(0), "Time constant of the case's warming.");
  v.boolean("earth_rate", p.earth_rate, "Whether it feels the Earth turn.");
}

void validate(const ImuParameters& p) {
  fields::check(p);
  // These two no file can change.
  const auto require = [](bool holds, const char* name, double found, const char* allowed) {
    if (!std::isfinite(found) || !holds) {
      throw std::invalid_argument("IMU: " + std::string(name) + " is " + std::to_string(found) +
                                  ", allowed is " + allowed);
    }
  };
  require(std::abs(p.latitude_rad) <= std::numbers::pi / 2.0, "latitude_rad", p.latitude_rad,
          "-pi/2 .. pi/2");
  require(p.nominal_period_s > 0.0, "nominal_period_s", p.nominal_period_s, "greater than 0");
}

ImuSensor::Triad::Triad(const InertialTriadParameters& parameters, std::uint64_t seed,
                        std::string_view name)
    : parameters_(parameters), random_(seed, name), errors_(parameters.random, random_) {
  for (Eigen::Index row = 0; row < 3; ++row) {
    bias_(row) = parameters.turn_on_bias * random_.gaussian();
    for (Eigen::Index column = 0; column < 3; ++column) {
      const double deviation = row == column ? parameters.scale_error : parameters.misalignment_rad;
      matrix_(row, column) += deviation * random_.gaussian();
    }
  }
}

Eigen::Vector3d ImuSensor::Triad::measure(const Eigen::Vector3d& truth, double temperature_c,
                                          double dt_s) {
  // (1 + scale(T)) misaligned x + bias(T) + random errors, then quantised and clamped.
  const double warmer = temperature_c - kReferenceTemperature_c;
  Eigen::Vector3d value = matrix_ * truth + parameters_.scale_temperature * warmer * truth + bias_;
  value.array() += parameters_.bias_temperature * warmer;
  value += errors_.next(dt_s, random_);
  if (parameters_.resolution > 0.0) {
    value = (value / parameters_.resolution).array().round() * parameters_.resolution;
  }
  if (parameters_.range > 0.0) {
    value = value.cwiseMax(-parameters_.range).cwiseMin(parameters_.range);
  }
  return value;
}

ImuSensor::ImuSensor(const ImuParameters& parameters, std::uint64_t seed, std::string_view name)
    : parameters_(checked(parameters)),
      gyroscope_(parameters.gyroscope, seed, std::string(name) + "/gyroscope"),
      accelerometer_(parameters.accelerometer, seed, std::string(name) + "/accelerometer") {}

Eigen::Vector3d ImuSensor::acceleration_W(SimTime time, const LinkMotion& mount) {
  if (parameters_.acceleration == ImuAcceleration::solver) {
    return mount.a_WL_W;
  }
  if (time > previous_) {
    // Wolf et al. 2020, section 4: difference of velocities over the time between.
    difference_W_ = (mount.v_WL_W - previous_v_W_) / to_seconds(time - previous_);
  }
  previous_v_W_ = mount.v_WL_W;
  return difference_W_;
}

ImuSample ImuSensor::sample(SimTime time, const LinkMotion& mount, double gravity_mps2) {
  if (!first_) {
    first_ = time;
    previous_ = time;
  }
  const Eigen::Vector3d a_W = acceleration_W(time, mount);
  const double dt_s =
      time > previous_ ? to_seconds(time - previous_) : parameters_.nominal_period_s;
  previous_ = time;
  // Self-heating: ambient + dT (1 - exp(-t / tau)).
  const double temperature_c =
      parameters_.ambient_temperature_c -
      parameters_.self_heating_k * std::expm1(-to_seconds(time - *first_) / parameters_.warm_up_s);

  const Eigen::Matrix3d R_SW = mount.X_WL.linear().transpose();
  const double gravity = parameters_.acceleration == ImuAcceleration::velocity_difference
                             ? kStandardGravity_mps2
                             : gravity_mps2;
  // Specific force f = R^T (a - g).
  const Eigen::Vector3d force_S = R_SW * (a_W + Eigen::Vector3d(0.0, 0.0, gravity));
  Eigen::Vector3d rate_W = mount.w_WL_W;
  if (parameters_.earth_rate) {
    // Earth's rate in east, north, up: W (0, cos latitude, sin latitude).
    rate_W += kEarthRate_radps * Eigen::Vector3d(0.0, std::cos(parameters_.latitude_rad),
                                                 std::sin(parameters_.latitude_rad));
  }
  const Eigen::Vector3d rate_S = R_SW * rate_W + parameters_.g_sensitivity_radps_per_mps2 * force_S;

  const Eigen::Vector3d rate = gyroscope_.measure(rate_S, temperature_c, dt_s);
  const Eigen::Vector3d force = accelerometer_.measure(force_S, temperature_c, dt_s);
  return {time, {force.x(), force.y(), force.z()}, {rate.x(), rate.y(), rate.z()}, temperature_c};
}

}  // namespace rigwire::sim
