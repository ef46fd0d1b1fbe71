#include "sim/imu/imu_sensor.h"

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace rigwire::sim {
namespace {

constexpr double kEarthRate_radps = 7.292115e-5;  // WGS-84
constexpr double kReferenceTemperature_c = 25.0;
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
