// What a magnetometer on a machine feels: the Earth's field, bent by the iron around it.
//
// Truth: b = R^T B, B the Earth's field in W (uniform over a scene). Read, per axis clamped and
// quantised:
//   y = soft_iron b + hard_iron + current_effect I + bias + noise
// soft_iron: iron that the field magnetises; hard_iron: magnets fixed to the machine;
// current_effect: the field of a motor's supply line per ampere of I. The matrix and both vectors
// are in the sensor's frame. Noise and bias are those of imu_noise.h: independent of the rate.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <numbers>
#include <optional>
#include <string_view>

#include "fields/rules.h"
#include "sim/imu/imu_noise.h"
#include "sim/link_motion.h"
#include "sim/random.h"
#include "sim/samples/magnetometer_sample.h"

namespace rigwire::sim {

/// East, north, up, tesla. Declination east positive, inclination downward positive.
[[nodiscard]] Eigen::Vector3d earth_field_t(double strength_t, double declination_rad,
                                            double inclination_rad);

struct MagnetometerParameters {
  /// Kaiserslautern in the 2020s: 48.7 uT, 3 degrees east, 65 degrees down; an estimate, good to
  /// about a degree.
  Eigen::Vector3d earth_field_W_t = earth_field_t(48.7e-6, 0.0524, 1.1345);
  Eigen::Matrix3d soft_iron = Eigen::Matrix3d::Identity();
  Eigen::Vector3d hard_iron_t = Eigen::Vector3d::Zero();
  Eigen::Vector3d current_effect_tpa = Eigen::Vector3d::Zero();  ///< T per A.
  RandomErrorParameters random;                                  ///< T/sqrt(Hz), T, T/sqrt(s).
  double turn_on_bias_t = 0.0;     ///< Standard deviation, drawn once.
  double range_t = 0.0;            ///< Clamped to +-range; 0 is unlimited.
  double resolution_t = 0.0;       ///< One count; 0 is continuous.
  double nominal_period_s = 0.01;  ///< Averaging time of the very first sample.
};
void visit(fields::Visitor& v, MagnetometerParameters& p);

/// Throws std::invalid_argument with the key or member, the value found and what is allowed.
void validate(const MagnetometerParameters& parameters);

/// Noise of the Xsens MTi-30's and MTi-300's magnetometers: 20 nT/sqrt(Hz) as remembered; 25 nT
/// counts as its data sheet states, noise of the MTi-300 from its 50 nT rms over an assumed 50 Hz.
[[nodiscard]] MagnetometerParameters mti30_magnetometer();
[[nodiscard]] MagnetometerParameters mti300_magnetometer();

/// A unit's magnetometer with the Earth's field as three numbers. Without one (`present` false) the
/// unit reports that the field is not available.
struct MagnetometerConfiguration {
  bool present = false;
  double strength_t = 48.7e-6;  ///< Strength of the Earth's field, the same in the whole scene.
  double declination_rad = 3.0 * std::numbers::pi / 180.0;
  double inclination_rad = 65.0 * std::numbers::pi / 180.0;
  MagnetometerParameters sensor;  ///< Parameters of the sensor, without the Earth's field.
};
void visit(fields::Visitor& v, MagnetometerConfiguration& p);

/// Returns the sensor's parameters with the field of `configuration`.
[[nodiscard]] MagnetometerParameters parameters_of(const MagnetometerConfiguration& configuration);

class Magnetometer {
 public:
  /// `name` seeds the sensor's own random stream ("<name>/magnetometer").
  Magnetometer(const MagnetometerParameters& parameters, std::uint64_t seed, std::string_view name);

  /// The sample at `time`; calls with increasing times. `mount` is the motion of the sensor's
  /// frame, `current_a` what flows through the line that current_effect is about.
  [[nodiscard]] MagnetometerSample sample(SimTime time, const LinkMotion& mount, double current_a);

 private:
  MagnetometerParameters parameters_;
  RandomStream random_;
  Eigen::Vector3d bias_t_;
  RandomErrors errors_;
  std::optional<SimTime> previous_;
};

}  // namespace rigwire::sim
