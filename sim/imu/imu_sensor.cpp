#include "sim/imu/imu_sensor.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kEarthRate_radps = 7.292115e-5;  // WGS-84
constexpr double kReferenceTemperature_c = 25.0;
constexpr double kRadians = std::numbers::pi / 180.0;
constexpr double kStandardGravity_mps2 = 9.80665;

void check(const std::string& name, double value, bool allowed, const std::string& what) {
  if (!std::isfinite(value) || !allowed) {
    throw std::invalid_argument("IMU: " + name + " is " + std::to_string(value) + ", allowed is " +
                                what);
  }
}

void check_triad(const std::string& prefix, const InertialTriadParameters& triad) {
  const auto not_negative = [&prefix](const char* name, double value) {
    check(prefix + "." + name, value, value >= 0.0, "0 or more");
  };
  not_negative("range", triad.range);
  not_negative("resolution", triad.resolution);
  not_negative("noise_density", triad.random.noise_density);
  not_negative("bias_instability", triad.random.bias_instability);
  not_negative("random_walk", triad.random.random_walk);
  not_negative("turn_on_bias", triad.turn_on_bias);
  check(prefix + ".scale_error", triad.scale_error,
        triad.scale_error >= 0.0 && triad.scale_error < 0.5, "0 .. 0.5");
  check(prefix + ".misalignment_rad", triad.misalignment_rad,
        triad.misalignment_rad >= 0.0 && triad.misalignment_rad < 0.5, "0 .. 0.5");
  check(prefix + ".bias_temperature", triad.bias_temperature, true, "a number");
  check(prefix + ".scale_temperature", triad.scale_temperature,
        std::abs(triad.scale_temperature) < 1e-2, "-0.01 .. 0.01");
}

const ImuParameters& checked(const ImuParameters& parameters) {
  validate(parameters);
  return parameters;
}

}  // namespace

void validate(const ImuParameters& parameters) {
  check_triad("gyroscope", parameters.gyroscope);
  check_triad("accelerometer", parameters.accelerometer);
  check("g_sensitivity_radps_per_mps2", parameters.g_sensitivity_radps_per_mps2, true, "a number");
  check("ambient_temperature_c", parameters.ambient_temperature_c,
        parameters.ambient_temperature_c >= -60.0 && parameters.ambient_temperature_c <= 125.0,
        "-60 .. 125");
  check("self_heating_k", parameters.self_heating_k, parameters.self_heating_k >= 0.0, "0 or more");
  check("warm_up_s", parameters.warm_up_s, parameters.warm_up_s > 0.0, "greater than 0");
  check("latitude_rad", parameters.latitude_rad,
        std::abs(parameters.latitude_rad) <= std::numbers::pi / 2.0, "-pi/2 .. pi/2");
  check("nominal_period_s", parameters.nominal_period_s, parameters.nominal_period_s > 0.0,
        "greater than 0");
}

ImuParameters perfect_imu() {
  return {};
}

ImuParameters openimu300_class() {
  ImuParameters imu;
  imu.gyroscope.range = 400.0 * kRadians;
  imu.gyroscope.random.noise_density = 0.005 * kRadians;            // 0.3 deg/sqrt(h)
  imu.gyroscope.random.bias_instability = 6.0 * kRadians / 3600.0;  // 6 deg/h
  imu.gyroscope.turn_on_bias = 0.05 * kRadians;                     // judgement
  imu.gyroscope.scale_error = 1e-3;
  imu.gyroscope.misalignment_rad = 0.05 * kRadians;
  imu.g_sensitivity_radps_per_mps2 = 0.01 * kRadians / kStandardGravity_mps2;
  imu.accelerometer.range = 8.0 * kStandardGravity_mps2;
  imu.accelerometer.random.noise_density = 70e-6 * kStandardGravity_mps2;
  imu.accelerometer.random.bias_instability = 10e-6 * kStandardGravity_mps2;
  imu.accelerometer.turn_on_bias = 2e-3 * kStandardGravity_mps2;  // judgement
  imu.accelerometer.scale_error = 1e-3;
  imu.accelerometer.misalignment_rad = 0.05 * kRadians;
  imu.self_heating_k = 10.0;  // judgement
  return imu;
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

ImuSample ImuSensor::sample(SimTime time, const LinkMotion& mount, double gravity_mps2) {
  if (!first_) {
    first_ = time;
    previous_ = time;
  }
  const double dt_s =
      time > previous_ ? to_seconds(time - previous_) : parameters_.nominal_period_s;
  previous_ = time;
  const double temperature_c =
      parameters_.ambient_temperature_c -
      parameters_.self_heating_k * std::expm1(-to_seconds(time - *first_) / parameters_.warm_up_s);

  const Eigen::Matrix3d R_SW = mount.X_WL.linear().transpose();
  const Eigen::Vector3d up_force_W(0.0, 0.0, gravity_mps2);
  const Eigen::Vector3d force_S = R_SW * (mount.a_WL_W + up_force_W);
  Eigen::Vector3d rate_W = mount.w_WL_W;
  if (parameters_.earth_rate) {
    rate_W += kEarthRate_radps * Eigen::Vector3d(0.0, std::cos(parameters_.latitude_rad),
                                                 std::sin(parameters_.latitude_rad));
  }
  const Eigen::Vector3d rate_S = R_SW * rate_W + parameters_.g_sensitivity_radps_per_mps2 * force_S;

  const Eigen::Vector3d rate = gyroscope_.measure(rate_S, temperature_c, dt_s);
  const Eigen::Vector3d force = accelerometer_.measure(force_S, temperature_c, dt_s);
  return {time, {force.x(), force.y(), force.z()}, {rate.x(), rate.y(), rate.z()}, temperature_c};
}

}  // namespace rigwire::sim
