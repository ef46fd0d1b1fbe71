// What the elements of an inertial measurement unit feel: specific force and angular rate at the
// mount, with the errors of a MEMS sensor.
//
// Truth: f = R^T (a - g) and w in the sensor's frame S (x forward, y left, z up), a the
// acceleration of the mount's origin with its lever-arm terms (ImuAcceleration says from where), g
// = (0, 0, -gravity). With the Earth's rotation on, its rate is added to w; the Coriolis term in f
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

#include "fields/rules.h"
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

/// Where the acceleration comes from.
enum class ImuAcceleration : std::uint8_t {
  /// The solver's own, at the sample's instant (LinkMotion from at_mount()).
  solver,
  /// Wolf et al. 2020, section 4: the change of the mount's velocity since the previous sample over
  /// the time between, plus standard gravity, 9.80665 m/s2. For comparison: it is the mean over the
  /// interval, so late by half of it and low-passed, and every kink of the velocity shows. 0 at the
  /// first sample; without time between two samples the last value stays.
  velocity_difference,
};

/// Sets of parameters of real parts.
enum class ImuPart : std::uint8_t { perfect, openimu300, adis16470, mti300, mti30 };

struct ImuParameters {
  ImuPart part = ImuPart::perfect;  ///< The set that the rest began as; not used any more then.
  ImuAcceleration acceleration = ImuAcceleration::solver;
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
void visit(fields::Visitor& v, ImuParameters& p);

/// Throws std::invalid_argument with the key or member, the value found and what is allowed.
void validate(const ImuParameters& parameters);

/// No error at all.
[[nodiscard]] ImuParameters perfect_imu();
/// The class of the ACEINNA OpenIMU300/335. Values from the makers' data sheets as remembered and
/// not confirmed; they are of the right order for industrial MEMS.
[[nodiscard]] ImuParameters openimu300_class();
/// Analog Devices ADIS16470, Xsens MTi-300 and MTi-30. Range, noise density, in-run bias and the
/// g-sensitivity of the MTi-300 as data sheets state them; the other g-sensitivities, the MTi-30,
/// scale, misalignment and turn-on bias as remembered, estimates. The MTi-30's noise and bias agree
/// with what others measured on its family.
[[nodiscard]] ImuParameters adis16470();
[[nodiscard]] ImuParameters mti300();
[[nodiscard]] ImuParameters mti30();
[[nodiscard]] ImuParameters parameters_of(ImuPart part);

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
  [[nodiscard]] Eigen::Vector3d acceleration_W(SimTime time, const LinkMotion& mount);

  std::optional<SimTime> first_;
  Eigen::Vector3d previous_v_W_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d difference_W_ = Eigen::Vector3d::Zero();
  SimTime previous_{};
};

}  // namespace rigwire::sim
