// What the elements of an inertial measurement unit feel: specific force and angular rate at the
// mount, with the errors of a MEMS sensor.
//
// Truth: f = R^T (a - g) and w in the sensor's frame S (x forward, y left, z up), a the solver's
// acceleration of the mount's origin (LinkMotion from at_mount(), lever-arm terms included), g =
// (0, 0, -gravity). With the Earth's rotation on, its rate is added to w; the Coriolis term in f
// (below 2e-3 m/s2 at 10 m/s) is not.
//
// Error model, per triad, at case temperature T:
//   y = clamp( quantise( (1 + scale(T)) misaligned (x + g_sensitivity f) + turn-on bias
//              + bias_temperature (T - 25) + flicker + random walk + white noise ) )
// Turn-on bias, scale and misalignment are drawn once per sensor from their standard deviations.
// Case temperature rises from ambient by self_heating_k with warm_up_s. The random parts are those
// of imu_noise.h and do not depend on the sample rate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string_view>

#include "sim/imu/imu_noise.h"
#include "sim/link_motion.h"
#include "sim/random.h"
#include "sim/samples/imu_sample.h"

namespace rigwire::sim {

/// One triad. Units: rad/s for the gyroscope, m/s2 for the accelerometer.
struct InertialTriadParameters {
  double range = 0.0;              ///< Clamped to +-range; 0 is unlimited.
  double resolution = 0.0;         ///< One count; 0 is continuous.
  RandomErrorParameters random;    ///< Noise density, bias instability, random walk.
  double turn_on_bias = 0.0;       ///< Standard deviation.
  double scale_error = 0.0;        ///< Standard deviation, 1.
  double misalignment_rad = 0.0;   ///< Standard deviation of each off-diagonal angle.
  double bias_temperature = 0.0;   ///< Unit per kelvin from 25 degC, every axis.
  double scale_temperature = 0.0;  ///< 1 per kelvin from 25 degC.
};

struct ImuParameters {
  InertialTriadParameters gyroscope;
  InertialTriadParameters accelerometer;
  double g_sensitivity_radps_per_mps2 = 0.0;  ///< Rate read per specific force, same axis.
  double ambient_temperature_c = 25.0;
  double self_heating_k = 0.0;
  double warm_up_s = 480.0;  ///< Time constant of the case.
  bool earth_rate = false;
  double latitude_rad = 0.0;        ///< For the Earth's rotation.
  double nominal_period_s = 0.005;  ///< Averaging time of the very first sample.
};

/// Throws std::invalid_argument with the name, the value found and what is allowed.
void validate(const ImuParameters& parameters);

/// No error at all.
[[nodiscard]] ImuParameters perfect_imu();
/// The class of the ACEINNA OpenIMU300/335. Values from the makers' data sheets as remembered and
/// not confirmed; they are of the right order for industrial MEMS.
[[nodiscard]] ImuParameters openimu300_class();

class ImuSensor {
 public:
  /// `name` seeds the sensor's own random streams ("<name>/gyroscope" ...).
  ImuSensor(const ImuParameters& parameters, std::uint64_t seed, std::string_view name);

  /// The sample at `time`, which averages the noise since the previous call; calls with increasing
  /// times. `mount` is the motion of the sensor's frame.
  [[nodiscard]] ImuSample sample(SimTime time, const LinkMotion& mount, double gravity_mps2);

 private:
  /// One triad with its drawn constants.
  class Triad {
   public:
    Triad(const InertialTriadParameters& parameters, std::uint64_t seed, std::string_view name);
    [[nodiscard]] Eigen::Vector3d measure(const Eigen::Vector3d& truth, double temperature_c,
                                          double dt_s);

   private:
    InertialTriadParameters parameters_;
    RandomStream random_;
    Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();
    Eigen::Matrix3d matrix_ = Eigen::Matrix3d::Identity();
    RandomErrors errors_;
  };

  ImuParameters parameters_;
  Triad gyroscope_;
  Triad accelerometer_;
  std::optional<SimTime> first_;
  SimTime previous_{};
};

}  // namespace rigwire::sim
