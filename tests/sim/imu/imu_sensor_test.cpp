#include "sim/imu/imu_sensor.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;
constexpr double kGravity = 9.8094;

LinkMotion tilted(double nose_up_rad, double right_down_rad) {
  LinkMotion motion;
  motion.X_WL.linear() = (Eigen::AngleAxisd(-nose_up_rad, Eigen::Vector3d::UnitY()) *
                          Eigen::AngleAxisd(right_down_rad, Eigen::Vector3d::UnitX()))
                             .toRotationMatrix();
  return motion;
}

TEST(ImuSensor, RestAndLevelReadsGravityUpwards) {
  ImuSensor imu(perfect_imu(), 1, "imu");
  const ImuSample sample = imu.sample(kStart, LinkMotion{}, kGravity);
  EXPECT_EQ(sample.specific_force_mps2, (Vector3{0.0, 0.0, kGravity}));
  EXPECT_EQ(sample.angular_rate_radps, (Vector3{0.0, 0.0, 0.0}));
}

TEST(ImuSensor, TiltIsExactWithErrorsOff) {
  ImuSensor imu(perfect_imu(), 1, "imu");
  const double pitch = 0.3;
  const double roll = -0.7;
  const auto f = imu.sample(kStart, tilted(pitch, roll), kGravity).specific_force_mps2;
  EXPECT_NEAR(f.x, kGravity * std::sin(pitch), 1e-12);
  EXPECT_NEAR(f.y, kGravity * std::cos(pitch) * std::sin(roll), 1e-12);
  EXPECT_NEAR(f.z, kGravity * std::cos(pitch) * std::cos(roll), 1e-12);
}

TEST(ImuSensor, FreeFallFeelsNothing) {
  LinkMotion falling = tilted(0.4, 0.2);
  falling.a_WL_W = {0.0, 0.0, -kGravity};
  ImuSensor imu(perfect_imu(), 1, "imu");
  const auto f = imu.sample(kStart, falling, kGravity).specific_force_mps2;
  EXPECT_NEAR(std::hypot(f.x, f.y, f.z), 0.0, 1e-12);
}

TEST(ImuSensor, LeverArmAddsOmegaSquaredRadius) {
  LinkMotion turning;
  turning.w_WL_W = {0.0, 0.0, 1.5};
  turning.alpha_WL_W = {0.0, 0.0, 0.4};
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  mount.translation() = Eigen::Vector3d(2.0, 0.0, 0.5);
  ImuSensor imu(perfect_imu(), 1, "imu");
  const auto sample = imu.sample(kStart, at_mount(turning, mount), kGravity);
  EXPECT_NEAR(sample.specific_force_mps2.x, -1.5 * 1.5 * 2.0, 1e-12);
  EXPECT_NEAR(sample.specific_force_mps2.y, 0.4 * 2.0, 1e-12);
  EXPECT_NEAR(sample.angular_rate_radps.z, 1.5, 1e-15);
}

TEST(ImuSensor, EarthRateOnRequest) {
  ImuParameters parameters = perfect_imu();
  parameters.earth_rate = true;
  parameters.latitude_rad = 0.8625;
  ImuSensor imu(parameters, 1, "imu");
  const auto w = imu.sample(kStart, LinkMotion{}, kGravity).angular_rate_radps;
  EXPECT_NEAR(std::hypot(w.x, w.y, w.z), 7.292115e-5, 1e-18);
  EXPECT_NEAR(w.z, 7.292115e-5 * std::sin(0.8625), 1e-18);
}

TEST(ImuSensor, SameSeedSameSamplesOtherNameOthers) {
  ImuSensor a(openimu300_class(), 7, "imu_boom");
  ImuSensor b(openimu300_class(), 7, "imu_boom");
  ImuSensor other(openimu300_class(), 7, "imu_stick");
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const SimTime time = kStart + i * 5ms;
    const auto first = a.sample(time, LinkMotion{}, kGravity);
    const auto second = b.sample(time, LinkMotion{}, kGravity);
    EXPECT_EQ(first.specific_force_mps2, second.specific_force_mps2);
    EXPECT_EQ(first.angular_rate_radps, second.angular_rate_radps);
    differs = differs || !(first.angular_rate_radps ==
                           other.sample(time, LinkMotion{}, kGravity).angular_rate_radps);
  }
  EXPECT_TRUE(differs);
}

TEST(ImuSensor, ClampsAtTheRangeAndQuantises) {
  ImuParameters parameters = perfect_imu();
  parameters.gyroscope.range = 2.0;
  parameters.accelerometer.resolution = 0.25;
  LinkMotion fast;
  fast.w_WL_W = {5.0, -5.0, 1.0};
  ImuSensor imu(parameters, 1, "imu");
  const auto sample = imu.sample(kStart, fast, 9.81);
  EXPECT_EQ(sample.angular_rate_radps, (Vector3{2.0, -2.0, 1.0}));
  EXPECT_EQ(sample.specific_force_mps2.z, 9.75);
}

TEST(ImuSensor, WarmsUpFromAmbient) {
  ImuParameters parameters = perfect_imu();
  parameters.ambient_temperature_c = 20.0;
  parameters.self_heating_k = 10.0;
  parameters.warm_up_s = 100.0;
  parameters.gyroscope.bias_temperature = 1e-3;
  ImuSensor imu(parameters, 1, "imu");
  EXPECT_DOUBLE_EQ(imu.sample(kStart, LinkMotion{}, kGravity).temperature_c, 20.0);
  const auto later = imu.sample(kStart + 100s, LinkMotion{}, kGravity);
  EXPECT_NEAR(later.temperature_c, 30.0 - 10.0 / std::numbers::e, 1e-9);
  EXPECT_NEAR(later.angular_rate_radps.x, 1e-3 * (later.temperature_c - 25.0), 1e-15);
}

TEST(ImuSensor, RefusesSenselessParameters) {
  ImuParameters parameters = openimu300_class();
  EXPECT_NO_THROW(validate(parameters));
  parameters.gyroscope.random.noise_density = -1.0;
  EXPECT_THROW(ImuSensor(parameters, 1, "imu"), std::invalid_argument);
  parameters = openimu300_class();
  parameters.warm_up_s = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(validate(parameters), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
