// How well a lidar measures is chosen by keys of its sensor section.
#include <gtest/gtest.h>

#include <string>

#include "findings_of.h"
#include "hil/configuration/outline.h"
#include "hil/world/lidar.h"

namespace rigwire::hil {
namespace {

sim::SpinningLidarParameters read_sensor(const std::string& yaml, std::string& findings) {
  sim::SpinningLidarParameters sensor;
  findings = findings_of(yaml, sensor);
  return sensor;
}

constexpr const char* kWholeModel = R"(
sub_rays: 19
range_noise: signal
range_sigma: 5 mm
range_resolution: 8 cm
laser_bias_sigma: 12 mm
reference_range: 80 m
air_reference_range: 60 m
air_minimum_range: 2 m
echo_separation: 1.5 m
compensates_incidence: true
drop_rate: 2 %
drop_limit: 20 %
drop_at_zero: 40 %
blooming_share: 0.1 %
blooming_angle: 8 mrad
)";

TEST(LidarSensorKeys, EveryPartOfTheModelHasItsKey) {
  std::string findings;
  const sim::SpinningLidarParameters sensor = read_sensor(kWholeModel, findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(sensor.sub_rays, 19);
  EXPECT_EQ(sensor.range_noise, sim::RangeNoise::signal);
  EXPECT_DOUBLE_EQ(sensor.range_sigma_m, 0.005);
  EXPECT_DOUBLE_EQ(sensor.range_resolution_m, 0.08);
  EXPECT_DOUBLE_EQ(sensor.laser_bias_sigma_m, 0.012);
  EXPECT_DOUBLE_EQ(sensor.reference_range_m, 80.0);
  EXPECT_DOUBLE_EQ(sensor.air_reference_range_m, 60.0);
  EXPECT_DOUBLE_EQ(sensor.air_minimum_range_m, 2.0);
  EXPECT_DOUBLE_EQ(sensor.echo_separation_m, 1.5);
  EXPECT_TRUE(sensor.compensates_incidence);
  EXPECT_DOUBLE_EQ(sensor.drop_rate, 0.02);
  EXPECT_DOUBLE_EQ(sensor.drop_limit, 0.2);
  EXPECT_DOUBLE_EQ(sensor.drop_at_zero, 0.4);
  EXPECT_DOUBLE_EQ(sensor.blooming_share, 0.001);
  EXPECT_DOUBLE_EQ(sensor.blooming_angle_rad, 0.008);
}

TEST(LidarSensorKeys, WithoutKeysABeamIsOneRayWithConstantNoise) {
  std::string findings;
  const sim::SpinningLidarParameters sensor = read_sensor("{}\n", findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(sensor.sub_rays, 0) << "one, but where echoes are told apart";
  EXPECT_EQ(sensor.range_noise, sim::RangeNoise::constant);
  EXPECT_EQ(sensor.drop_rate, 0.0);
  EXPECT_EQ(sensor.laser_bias_sigma_m, 0.0);
  EXPECT_EQ(sensor.blooming_share, 0.0);
}

TEST(LidarSensorKeys, NoiseOfReflectivityAndOfFaintEchoesIsReadInItsUnits) {
  std::string findings;
  const sim::SpinningLidarParameters sensor = read_sensor(
      "range_noise: jitter\nnoise_onset: 4\nreflectivity_sigma: 3 %\n"
      "laser_reflectivity_sigma: 12 %\nair_focus_range: 6 m\n",
      findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(sensor.range_noise, sim::RangeNoise::jitter);
  EXPECT_DOUBLE_EQ(sensor.noise_onset, 4.0);
  EXPECT_DOUBLE_EQ(sensor.reflectivity_sigma, 0.03);
  EXPECT_DOUBLE_EQ(sensor.laser_reflectivity_sigma, 0.12);
  EXPECT_DOUBLE_EQ(sensor.air_focus_range_m, 6.0);
  (void)read_sensor("range_noise: constant\nnoise_onset: 4\n", findings);
  EXPECT_NE(findings.find("noise_onset"), std::string::npos) << "it would have no effect";
}

TEST(LidarSensorKeys, WhatTheModelDoesNotKnowIsRefusedWithWhatItKnows) {
  std::string findings;
  (void)read_sensor("sub_rays: 7\n", findings);
  EXPECT_NE(findings.find("1, 5, 19 or 1000"), std::string::npos) << findings;
  (void)read_sensor("range_noise: gaussian\n", findings);
  EXPECT_NE(findings.find("constant"), std::string::npos) << findings;
  EXPECT_NE(findings.find("signal"), std::string::npos) << findings;
  (void)read_sensor("drop_rate: 120 %\n", findings);
  EXPECT_NE(findings.find("drop_rate"), std::string::npos) << findings;
  (void)read_sensor("subrays: 5\n", findings);
  EXPECT_NE(findings.find("sub_rays"), std::string::npos) << findings;
}

TEST(LidarSensorKeys, PrintedBackKeepsWhatWasChosen) {
  std::string findings;
  const sim::SpinningLidarParameters sensor = read_sensor(kWholeModel, findings);
  const sim::SpinningLidarParameters again =
      read_sensor(print_yaml(outline(sensor), Origins()), findings);
  EXPECT_EQ(findings, "");
  EXPECT_EQ(again.sub_rays, sensor.sub_rays);
  EXPECT_EQ(again.range_noise, sensor.range_noise);
  EXPECT_DOUBLE_EQ(again.blooming_angle_rad, sensor.blooming_angle_rad);
}

}  // namespace
}  // namespace rigwire::hil
