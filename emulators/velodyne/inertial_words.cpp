#include "emulators/velodyne/inertial_words.h"

#include <cstddef>

namespace rigwire::emulators {
namespace {

double along(const Vector3& axis, const Vector3& v) {
  return axis.x * v.x + axis.y * v.y + axis.z * v.z;
}

}  // namespace

InertialWords inertial_words(
    const ImuSample& sample,
    const std::array<VelodyneInertialAxes, protocols::velodyne::kInertialGroups>& axes) {
  InertialWords words;
  for (std::size_t g = 0; g < words.size(); ++g) {
    words[g] = protocols::velodyne::to_counts(
        {.rate_radps = along(axes[g].gyro, sample.angular_rate_radps),
         .temperature_c = sample.temperature_c,
         .acceleration_x_mps2 = along(axes[g].acceleration_x, sample.specific_force_mps2),
         .acceleration_y_mps2 = along(axes[g].acceleration_y, sample.specific_force_mps2)});
  }
  return words;
}

}  // namespace rigwire::emulators
