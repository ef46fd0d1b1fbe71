// A part of an inertial unit is chosen by name; single keys beside it count more.
#include <gtest/gtest.h>

#include <string>

#include "findings_of.h"
#include "hil/configuration/outline.h"
#include "sim/imu/imu_sensor.h"

namespace rigwire::hil {
namespace {

sim::ImuParameters read_imu(const std::string& yaml, std::string& findings) {
  sim::ImuParameters imu;
  findings = findings_of(yaml, imu);
  return imu;
}

TEST(ImuKeys, APartSetsAllThatNoKeyBesideItSets) {
  std::string findings;
  const sim::ImuParameters imu =
      read_imu("gyroscope: {noise_density: 0.02}\npart: adis16470\n", findings);
  EXPECT_EQ(findings, "");
  const sim::ImuParameters part = sim::adis16470();
  EXPECT_EQ(imu.gyroscope.range, part.gyroscope.range);
  EXPECT_EQ(imu.accelerometer.random.bias_instability, part.accelerometer.random.bias_instability);
  EXPECT_NEAR(imu.gyroscope.random.noise_density, 2.5 * part.gyroscope.random.noise_density, 1e-15);
}

TEST(ImuKeys, WithoutAPartTheUnitIsPerfect) {
  std::string findings;
  const sim::ImuParameters imu = read_imu("acceleration: velocity_difference\n", findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(imu.gyroscope.random.noise_density, 0.0);
  EXPECT_EQ(imu.acceleration, sim::ImuAcceleration::velocity_difference);
}

TEST(ImuKeys, AnUnknownPartIsRefusedWithTheNamesThereAre) {
  std::string findings;
  (void)read_imu("part: mti3000\n", findings);
  EXPECT_NE(findings.find("part"), std::string::npos);
  EXPECT_NE(findings.find("mti300"), std::string::npos) << findings;
}

TEST(ImuKeys, PrintedBackKeepsWhatWasChanged) {
  std::string findings;
  const sim::ImuParameters imu =
      read_imu("part: mti30\naccelerometer: {turn_on_bias: 7 mg}\n", findings);
  ASSERT_EQ(findings, "");
  const sim::ImuParameters again = read_imu(print_yaml(outline(imu), Origins()), findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(again.part, sim::ImuPart::mti30);
  EXPECT_EQ(again.accelerometer.turn_on_bias, imu.accelerometer.turn_on_bias);
  EXPECT_EQ(again.gyroscope.random.noise_density, imu.gyroscope.random.noise_density);
}

}  // namespace
}  // namespace rigwire::hil
