#include "emulators/velodyne/inertial_words.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace rigwire::emulators {
namespace {

namespace velodyne = protocols::velodyne;

constexpr double kStandardGravity_mps2 = 9.80665;
constexpr double kGyroSpan_degps = 200.0;
constexpr double kAccelerationSpan_g = 2.5;

double along(const Vector3& axis, const Vector3& v) {
  return axis.x * v.x + axis.y * v.y + axis.z * v.z;
}

std::int16_t counts(double value, double span, double unit) {
  if (!std::isfinite(value)) {
    return 0;
  }
  const long rounded = std::lround(std::clamp(value, -span, span) / unit);
  return static_cast<std::int16_t>(std::clamp(rounded, -2048L, 2047L));
}

}  // namespace

InertialWords inertial_words(
    const ImuSample& sample,
    const std::array<VelodyneInertialAxes, velodyne::kInertialGroups>& axes) {
  constexpr double kDegrees = 180.0 / std::numbers::pi;
  const auto acceleration = [&](const Vector3& axis) {
    return counts(along(axis, sample.specific_force_mps2) / kStandardGravity_mps2,
                  kAccelerationSpan_g, velodyne::kAccelerationUnit_g);
  };
  InertialWords words;
  for (std::size_t g = 0; g < words.size(); ++g) {
    words[g].gyro = counts(along(axes[g].gyro, sample.angular_rate_radps) * kDegrees,
                           kGyroSpan_degps, velodyne::kGyroUnit_degps);
    words[g].temperature = counts(sample.temperature_c - velodyne::kTemperatureOrigin_c, 1000.0,
                                  velodyne::kTemperatureUnit_c);
    words[g].acceleration_x = acceleration(axes[g].acceleration_x);
    words[g].acceleration_y = acceleration(axes[g].acceleration_y);
  }
  return words;
}

}  // namespace rigwire::emulators
