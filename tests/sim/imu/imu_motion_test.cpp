// What an inertial unit reads on things that move: vibration on a lever arm, contact at rest, and
// the paper's way of differencing velocities beside the solver's acceleration.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "../tyre/quarter_vehicle.h"
#include "fields/constants.h"
#include "sim/imu/imu_sensor.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;
using Vector = Eigen::Vector3d;
constexpr double kStandardGravity = 9.80665;

/// Amplitude of the component at `frequency_hz` in a record of whole periods.
double amplitude(const std::vector<double>& record, double frequency_hz, double rate_hz) {
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    sum += record[i] * std::polar(1.0, -kTurn * frequency_hz * static_cast<double>(i) / rate_hz);
  }
  return 2.0 * std::abs(sum) / static_cast<double>(record.size());
}

/// A link that rocks about its own y axis so that a mount 1 m ahead moves by 0.5 mm at 50 Hz.
LinkMotion rocking(double t) {
  const double w = kTurn * 50.0;
  const double angle = 0.5e-3 * std::sin(w * t);
  LinkMotion link;
  link.X_WL.linear() = Eigen::AngleAxisd(angle, Vector::UnitY()).toRotationMatrix();
  link.w_WL_W = Vector(0.0, 0.5e-3 * w * std::cos(w * t), 0.0);
  link.alpha_WL_W = Vector(0.0, -0.5e-3 * w * w * std::sin(w * t), 0.0);
  return link;
}

TEST(ImuVibration, OnALeverArmIsOneLineOfTheRightHeight) {
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  mount.translation().x() = 1.0;
  ImuSensor imu(perfect_imu(), 1, "imu");
  std::vector<double> record;
  for (int i = 0; i < 1000; ++i) {
    const LinkMotion motion = at_mount(rocking(1e-3 * i), mount);
    record.push_back(imu.sample(kStart + i * 1ms, motion, kStandardGravity).specific_force_mps2.z -
                     kStandardGravity);
  }
  const double expected = 0.5e-3 * std::pow(kTurn * 50.0, 2);
  EXPECT_NEAR(expected, 49.3, 0.1);
  EXPECT_NEAR(amplitude(record, 50.0, 1000.0), expected, 1e-4 * expected);
  double others = 0.0;
  for (int f = 1; f < 500; ++f) {
    others = f == 50 ? others : std::max(others, amplitude(record, f, 1000.0));
  }
  EXPECT_LT(others, 0.02);  // half an angle squared: the arm's own turning at 100 Hz
}

TEST(ImuVibration, SlowSamplingFoldsTheLineToWhereItBelongs) {
  // 50 Hz read 80 times a second stands at 30 Hz, as high as it is.
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  mount.translation().x() = 1.0;
  ImuSensor imu(perfect_imu(), 1, "imu");
  std::vector<double> record;
  for (int i = 0; i < 80; ++i) {
    const LinkMotion motion = at_mount(rocking(0.0125 * i), mount);
    record.push_back(
        imu.sample(kStart + i * 12'500us, motion, kStandardGravity).specific_force_mps2.z);
  }
  EXPECT_NEAR(amplitude(record, 30.0, 80.0), 49.35, 0.05);
}

TEST(ImuAtRest, OnAWheelThatStandsOnASlopeReadsGravityOnly) {
  const double angle = 0.3;
  const Ground ground = Ground::plane(Vector(-std::sin(angle), 0.0, std::cos(angle)), {});
  QuarterVehicle vehicle(ground, {}, 2200.0);
  vehicle.locked = true;
  vehicle.place(0.0, 0.0, 2200.0 * kStandardGravity * std::cos(angle));
  vehicle.run(60.0, 1e-3);
  ImuSensor imu(perfect_imu(), 1, "imu");
  double square = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const Vector before = vehicle.v_W;
    vehicle.step(1e-3);
    LinkMotion motion;
    motion.X_WL.linear() = Eigen::AngleAxisd(-angle, Vector::UnitY()).toRotationMatrix();
    motion.a_WL_W = (vehicle.v_W - before) / 1e-3;
    const ImuSample sample = imu.sample(kStart + i * 1ms, motion, kStandardGravity);
    const Vector error(sample.specific_force_mps2.x - kStandardGravity * std::sin(angle),
                       sample.specific_force_mps2.y,
                       sample.specific_force_mps2.z - kStandardGravity * std::cos(angle));
    square += error.squaredNorm() / 1000.0;
    EXPECT_EQ(sample.angular_rate_radps, (Vector3{0.0, 0.0, 0.0}));
  }
  EXPECT_LT(std::sqrt(square), 1e-6);
}

ImuParameters differencing() {
  ImuParameters parameters = perfect_imu();
  parameters.acceleration = ImuAcceleration::velocity_difference;
  return parameters;
}

/// 2 m ahead of an axis that turns at `rate`.
LinkMotion turning_about_z(double rate, double t) {
  LinkMotion link;
  link.X_WL.linear() = Eigen::AngleAxisd(rate * t, Vector::UnitZ()).toRotationMatrix();
  link.w_WL_W = Vector(0.0, 0.0, rate);
  Eigen::Isometry3d mount = Eigen::Isometry3d::Identity();
  mount.translation().x() = 2.0;
  return at_mount(link, mount);
}

TEST(VelocityDifference, OnALeverArmIsTheChordOfTheArc) {
  // The difference over T is the mean acceleration: w^2 r sinc(w T / 2), turned back by w T / 2.
  const double rate = 1.5;
  for (const int milliseconds : {1, 10, 100}) {
    const double T = 1e-3 * milliseconds;
    ImuSensor paper(differencing(), 1, "imu");
    ImuSensor solver(perfect_imu(), 1, "imu");
    (void)paper.sample(kStart, turning_about_z(rate, 0.0), kStandardGravity);
    const auto time = kStart + milliseconds * 1ms;
    const auto f =
        paper.sample(time, turning_about_z(rate, T), kStandardGravity).specific_force_mps2;
    const auto exact =
        solver.sample(time, turning_about_z(rate, T), kStandardGravity).specific_force_mps2;
    const double mean = rate * rate * 2.0 * std::sin(0.5 * rate * T) / (0.5 * rate * T);
    EXPECT_NEAR(f.x, -mean * std::cos(0.5 * rate * T), 1e-10);
    EXPECT_NEAR(f.y, mean * std::sin(0.5 * rate * T), 1e-10);
    EXPECT_NEAR(exact.x, -rate * rate * 2.0, 1e-12);
    EXPECT_NEAR(exact.y, 0.0, 1e-12);
  }
}

TEST(VelocityDifference, KeepsItsLastValueWithoutTimeBetweenSamples) {
  ImuSensor imu(differencing(), 1, "imu");
  LinkMotion motion;
  EXPECT_EQ(imu.sample(kStart, motion, 9.81).specific_force_mps2,
            (Vector3{0.0, 0.0, kStandardGravity}));  // the first: no difference yet
  motion.v_WL_W = Vector(0.1, 0.0, 0.0);
  const auto moved = imu.sample(kStart + 10ms, motion, 9.81).specific_force_mps2;
  EXPECT_NEAR(moved.x, 10.0, 1e-12);
  const auto again = imu.sample(kStart + 10ms, motion, 9.81).specific_force_mps2;
  EXPECT_EQ(again, moved);
}

TEST(ImuParts, EveryPartIsValidAndKnowsItself) {
  for (const ImuPart part : {ImuPart::perfect, ImuPart::openimu300, ImuPart::adis16470,
                             ImuPart::mti300, ImuPart::mti30}) {
    const ImuParameters parameters = parameters_of(part);
    EXPECT_EQ(parameters.part, part);
    EXPECT_NO_THROW(validate(parameters));
  }
  EXPECT_NEAR(adis16470().gyroscope.range, 2000.0 * std::numbers::pi / 180.0, 1e-12);
  EXPECT_NEAR(mti300().gyroscope.random.bias_instability, 10.0 * std::numbers::pi / 648000.0,
              1e-18);
  EXPECT_NEAR(mti30().accelerometer.random.noise_density, 80e-6 * kStandardGravity, 1e-15);
}

}  // namespace
}  // namespace rigwire::sim
