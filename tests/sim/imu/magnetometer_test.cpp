#include "sim/imu/magnetometer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;
using Vector = Eigen::Vector3d;

LinkMotion heading(double yaw_rad) {
  LinkMotion motion;
  motion.X_WL.linear() = Eigen::AngleAxisd(yaw_rad, Vector::UnitZ()).toRotationMatrix();
  return motion;
}

Vector read(Magnetometer& sensor, SimTime time, const LinkMotion& motion, double current_a = 0.0) {
  const Vector3 field = sensor.sample(time, motion, current_a).field_t;
  return {field.x, field.y, field.z};
}

TEST(EarthField, DeclinationIsEastAndInclinationDown) {
  const Vector field = earth_field_t(50e-6, 0.1, 1.1);
  EXPECT_NEAR(field.norm(), 50e-6, 1e-18);
  EXPECT_NEAR(std::atan2(field.x(), field.y()), 0.1, 1e-14);
  EXPECT_NEAR(std::atan2(-field.z(), std::hypot(field.x(), field.y())), 1.1, 1e-14);
}

TEST(Magnetometer, ReadsTheHeadingWithoutErrors) {
  const MagnetometerParameters parameters;
  Magnetometer sensor(parameters, 1, "mag");
  for (int i = 0; i < 12; ++i) {
    const double yaw = 0.5 * i;
    const Vector field = read(sensor, kStart + i * 10ms, heading(yaw));
    // Angle of magnetic north from the sensor's x, left positive.
    const double north = std::atan2(field.y(), field.x());
    const double declination =
        std::atan2(parameters.earth_field_W_t.x(), parameters.earth_field_W_t.y());
    const double expected = std::numbers::pi / 2.0 - declination - yaw;
    EXPECT_NEAR(std::remainder(north - expected, 2.0 * std::numbers::pi), 0.0, 1e-12);
    EXPECT_NEAR(field.norm(), 48.7e-6, 1e-15);
  }
}

TEST(Magnetometer, HardIronMovesTheCircleSoftIronBendsIt) {
  MagnetometerParameters parameters;
  parameters.hard_iron_t = Vector(5e-6, -3e-6, 1e-6);
  parameters.soft_iron = Vector(1.2, 0.9, 1.0).asDiagonal();
  Magnetometer sensor(parameters, 1, "mag");
  const double level = parameters.earth_field_W_t.head<2>().norm();
  double most_x = -1.0;
  double least_x = 1.0;
  double most_y = -1.0;
  double least_y = 1.0;
  for (int i = 0; i < 3600; ++i) {
    const Vector field = read(sensor, kStart + i * 10ms, heading(i * std::numbers::pi / 1800.0));
    most_x = std::max(most_x, field.x());
    least_x = std::min(least_x, field.x());
    most_y = std::max(most_y, field.y());
    least_y = std::min(least_y, field.y());
  }
  EXPECT_NEAR(0.5 * (most_x + least_x), 5e-6, 1e-10);
  EXPECT_NEAR(0.5 * (most_y + least_y), -3e-6, 1e-10);
  EXPECT_NEAR(0.5 * (most_x - least_x), 1.2 * level, 1e-10);
  EXPECT_NEAR(0.5 * (most_y - least_y), 0.9 * level, 1e-10);
}

TEST(Magnetometer, TheMotorsCurrentAdds) {
  MagnetometerParameters parameters;
  parameters.current_effect_tpa = Vector(0.02e-6, 0.0, -0.01e-6);
  Magnetometer sensor(parameters, 1, "mag");
  const Vector off = read(sensor, kStart, heading(0.3));
  const Vector on = read(sensor, kStart + 10ms, heading(0.3), 200.0);
  EXPECT_LT((on - off - Vector(4e-6, 0.0, -2e-6)).norm(), 1e-18);
}

TEST(Magnetometer, NoiseDoesNotDependOnTheRate) {
  // White noise of density N averaged over one second deviates by N.
  for (const int rate_hz : {20, 100}) {
    MagnetometerParameters parameters;
    parameters.random.noise_density = 20e-9;
    Magnetometer sensor(parameters, 3, "mag");
    const Vector truth = parameters.earth_field_W_t;
    double square = 0.0;
    const int seconds = 1000;
    for (int s = 0; s < seconds; ++s) {
      Vector mean = Vector::Zero();
      for (int i = 0; i < rate_hz; ++i) {
        const auto time = kStart + (s * rate_hz + i) * (1000ms / rate_hz);
        mean += (read(sensor, time, heading(0.0)) - truth) / rate_hz;
      }
      square += mean.squaredNorm() / (3.0 * seconds);
    }
    EXPECT_NEAR(std::sqrt(square), 20e-9, 0.05 * 20e-9) << rate_hz;
  }
}

TEST(Magnetometer, ClampsAndCounts) {
  MagnetometerParameters parameters;
  parameters.hard_iron_t = Vector(1e-3, -1e-3, 0.0);
  parameters.range_t = 8e-4;
  parameters.resolution_t = 25e-9;
  Magnetometer sensor(parameters, 1, "mag");
  const Vector field = read(sensor, kStart, heading(0.0));
  EXPECT_EQ(field.x(), 8e-4);
  EXPECT_EQ(field.y(), -8e-4);
  EXPECT_NEAR(std::remainder(field.z(), 25e-9), 0.0, 1e-18);
}

TEST(Magnetometer, SameSeedSameSamplesOtherNameOthers) {
  MagnetometerParameters parameters = mti30_magnetometer();
  parameters.resolution_t = 0.0;
  Magnetometer a(parameters, 7, "mag");
  Magnetometer b(parameters, 7, "mag");
  Magnetometer other(parameters, 7, "mag2");
  EXPECT_EQ(read(a, kStart, heading(0.0)), read(b, kStart, heading(0.0)));
  EXPECT_NE(read(a, kStart + 10ms, heading(0.0)), read(other, kStart + 10ms, heading(0.0)));
}

TEST(Magnetometer, RefusesSenselessParameters) {
  EXPECT_NO_THROW(validate(mti30_magnetometer()));
  EXPECT_NO_THROW(validate(mti300_magnetometer()));
  MagnetometerParameters parameters;
  parameters.soft_iron.setZero();
  EXPECT_THROW(validate(parameters), std::invalid_argument);
  parameters = {};
  parameters.range_t = -1.0;
  EXPECT_THROW(Magnetometer(parameters, 1, "mag"), std::invalid_argument);
}

}  // namespace
}  // namespace rigwire::sim
