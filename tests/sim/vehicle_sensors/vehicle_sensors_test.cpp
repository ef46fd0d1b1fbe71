#include "sim/vehicle_sensors/vehicle_sensors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "allocation_counter.h"

namespace rigwire::sim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Only what a test sets is wrong.
VehicleSensorParameters faultless() {
  VehicleSensorParameters p;
  p.ticks_per_revolution = 0;
  p.dead_rate_radps = 0.0;
  p.radius_error = 0.0;
  p.steer_offset_rad = 0.0;
  p.steer_quantum_rad = 0.0;
  p.steer_play_rad = 0.0;
  p.pressure_offset_pa = 0.0;
  p.pressure_quantum_pa = 0.0;
  return p;
}

VehicleSensors sensors(const VehicleSensorParameters& p, std::uint64_t seed = 1,
                       std::string_view name = "vehicle") {
  return {p, OdometryParameters{}, seed, name};
}

VehicleSample at(double time_s, double rate_radps) {
  VehicleSample sample;
  sample.time = kStart + from_seconds(time_s);
  sample.wheel_rate_radps.fill(rate_radps);
  sample.wheel_radius_m.fill(0.5);
  sample.tyre_pressure_pa.fill(245e3);
  return sample;
}

TEST(WheelEncoder, CountsWholeTicksOverItsGate) {
  VehicleSensorParameters p = faultless();
  p.ticks_per_revolution = 100;
  p.gate_s = 0.1;
  VehicleSensors under_test = sensors(p);
  const double quantum = 2.0 * std::numbers::pi / 100.0 / 0.1;
  double angle_rad = 0.0;
  for (int i = 0; i <= 1000; ++i) {
    const double rate = 7.1;
    const double reading = under_test.measure(at(0.1 * i, rate)).wheel_rate_radps[2];
    EXPECT_NEAR(reading / quantum, std::round(reading / quantum), 1e-9);
    EXPECT_LT(std::abs(reading - rate), quantum);
    angle_rad += i > 0 ? 0.1 * reading : 0.0;
  }
  // No way is lost but the tick in hand.
  EXPECT_NEAR(angle_rad, 7.1 * 100.0, quantum * 0.1);
}

TEST(WheelEncoder, DoesNotDependOnHowOftenItIsAskedWithinTheGate) {
  VehicleSensorParameters p = faultless();
  p.ticks_per_revolution = 64;
  VehicleSensors often = sensors(p);
  VehicleSensors seldom = sensors(p);
  for (int i = 0; i < 5000; ++i) {
    const double time_s = 0.01 * i;
    const VehicleSample exact = at(time_s, -3.0 + 0.2 * time_s);
    const double reading = often.measure(exact).wheel_rate_radps[0];
    if (i % 10 == 0) {
      EXPECT_NEAR(seldom.measure(exact).wheel_rate_radps[0], reading, 1e-9) << i;
    }
  }
}

TEST(WheelEncoder, IsSilentBelowItsDeadRate) {
  VehicleSensorParameters p = faultless();
  p.ticks_per_revolution = 1000;
  p.dead_rate_radps = 0.5;
  VehicleSensors under_test = sensors(p);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(under_test.measure(at(0.1 * i, i % 2 == 0 ? 0.49 : -0.49)).wheel_rate_radps[0], 0.0);
  }
  p.ticks_per_revolution = 0;
  VehicleSensors continuous = sensors(p);
  EXPECT_EQ(continuous.measure(at(0.0, 0.49)).wheel_rate_radps[3], 0.0);
  EXPECT_EQ(continuous.measure(at(0.1, 0.51)).wheel_rate_radps[3], 0.51);
}

TEST(SteeringSensor, PlayIsHysteresisOfItsWidth) {
  VehicleSensorParameters p = faultless();
  p.steer_play_rad = 0.02;
  VehicleSensors under_test = sensors(p);
  const auto read = [&](double angle) {
    VehicleSample sample = at(0.0, 0.0);
    sample.front_steer_rad = angle;
    return under_test.measure(sample).front_steer_rad;
  };
  EXPECT_DOUBLE_EQ(read(0.0), 0.0);
  EXPECT_DOUBLE_EQ(read(0.01), 0.0);
  EXPECT_NEAR(read(0.30), 0.29, 1e-15);
  EXPECT_NEAR(read(0.285), 0.29, 1e-15);
  EXPECT_NEAR(read(0.20), 0.21, 1e-15);
}

TEST(SteeringSensor, OffsetAndQuantumBoundTheError) {
  VehicleSensorParameters p = faultless();
  p.steer_quantum_rad = 0.01;
  VehicleSensors under_test = sensors(p);
  for (int i = -50; i < 50; ++i) {
    VehicleSample sample = at(0.0, 0.0);
    sample.front_steer_rad = 0.0123 * i;
    sample.rear_steer_rad = -0.0077 * i;
    const VehicleSample reading = under_test.measure(sample);
    EXPECT_LE(std::abs(reading.front_steer_rad - sample.front_steer_rad), 0.005 + 1e-12);
    EXPECT_NEAR(reading.rear_steer_rad / 0.01, std::round(reading.rear_steer_rad / 0.01), 1e-9);
  }
}

TEST(PressureSensor, ReadsInItsStepsAndNeverBelowZero) {
  VehicleSensorParameters p = faultless();
  p.pressure_quantum_pa = 4e3;
  VehicleSensors under_test = sensors(p);
  EXPECT_DOUBLE_EQ(under_test.measure(at(0.0, 0.0)).tyre_pressure_pa[1], 244e3);
  p.pressure_offset_pa = 50e3;
  VehicleSensors shifted = sensors(p);
  VehicleSample empty = at(0.0, 0.0);
  empty.tyre_pressure_pa.fill(0.0);
  for (const double pressure_pa : shifted.measure(empty).tyre_pressure_pa) {
    EXPECT_GE(pressure_pa, 0.0);
  }
}

TEST(GroundRadar, HoldsZeroBelowItsLeastSpeedAndItsWayDoesNotCreep) {
  VehicleSensorParameters p;
  VehicleSensors under_test = sensors(p);
  double way_m = 0.0;
  for (int i = 0; i < 4400; ++i) {
    VehicleSample exact = at(0.01 * i, 0.0);
    exact.ground_speed_mps = (i % 2 == 0 ? 1.0 : -1.0) * 0.13;
    const double reading = under_test.measure(exact).ground_speed_mps;
    EXPECT_EQ(reading, 0.0);
    way_m += 0.01 * reading;
  }
  EXPECT_EQ(way_m, 0.0);
}

TEST(GroundRadar, CountsPulsesOverItsGateWithoutLosingWay) {
  VehicleSensorParameters p;
  p.ground_radar.scale_error = 0.0;
  VehicleSensors under_test = sensors(p);
  const double quantum_mps = 1.0 / (p.ground_radar.pulses_pm * p.ground_radar.gate_s);
  double way_m = 0.0;
  for (int i = 0; i <= 3000; ++i) {
    VehicleSample exact = at(0.01 * i, 0.0);
    exact.ground_speed_mps = -2.34;  // it knows no direction
    const double reading = under_test.measure(exact).ground_speed_mps;
    EXPECT_NEAR(reading, 2.34, quantum_mps);
    way_m += i > 0 ? 0.01 * reading : 0.0;
  }
  EXPECT_NEAR(way_m, 2.34 * 30.0, 2.0 * 2.34 * p.ground_radar.gate_s);
}

TEST(GroundRadar, WithoutOneNothingIsMeasured) {
  VehicleSensorParameters p;
  p.ground_radar.fitted = false;
  VehicleSensors under_test = sensors(p);
  VehicleSample exact = at(0.0, 1.0);
  exact.ground_speed_mps = 1.0;
  EXPECT_TRUE(std::isnan(under_test.measure(exact).ground_speed_mps));
}

TEST(VehicleSensorsTest, PerfectOnesChangeNothingButComputeOdometry) {
  VehicleSensorParameters p;
  p.perfect = true;
  VehicleSensors under_test = sensors(p);
  VehicleSample sample = at(1.0, 4.0);
  sample.front_steer_rad = 0.1234567;
  const VehicleSample reading = under_test.measure(sample);
  EXPECT_EQ(reading.wheel_rate_radps, sample.wheel_rate_radps);
  EXPECT_EQ(reading.wheel_radius_m, sample.wheel_radius_m);
  EXPECT_EQ(reading.tyre_pressure_pa, sample.tyre_pressure_pa);
  EXPECT_EQ(reading.front_steer_rad, sample.front_steer_rad);
  EXPECT_EQ(reading.odometry.speed_mps, odometry(OdometryParameters{}, sample).speed_mps);
  EXPECT_NEAR(reading.odometry.curvature_1pm, std::tan(0.1234567) / 3.85, 1e-15);
}

TEST(VehicleSensorsTest, OdometryComesFromTheReadingsNotFromTheTruth) {
  VehicleSensorParameters p = faultless();
  p.radius_error = 0.01;
  VehicleSensors under_test = sensors(p);
  const VehicleSample reading = under_test.measure(at(0.0, 10.0));
  double mean_radius = 0.0;
  for (const double radius : reading.wheel_radius_m) {
    EXPECT_NE(radius, 0.5);
    mean_radius += 0.25 * radius;
  }
  EXPECT_NEAR(reading.odometry.speed_mps, 10.0 * mean_radius, 1e-12);
}

TEST(VehicleSensorsTest, AFixedRadiusShowsWhatLoweredPressureDoes) {
  VehicleSensorParameters p = faultless();
  p.known_radius_m = 0.565;
  VehicleSensors under_test = sensors(p);
  VehicleSample soft = at(0.0, 10.0);
  soft.wheel_radius_m.fill(0.54);
  const VehicleSample reading = under_test.measure(soft);
  EXPECT_NEAR(reading.odometry.speed_mps / (10.0 * 0.54), 0.565 / 0.54, 1e-12);
}

TEST(VehicleSensorsTest, SameSeedAndNameGiveTheSameErrorsOthersDoNot) {
  const VehicleSensorParameters p;
  VehicleSensors one = sensors(p, 7, "truck");
  VehicleSensors same = sensors(p, 7, "truck");
  VehicleSensors other_name = sensors(p, 7, "trailer");
  VehicleSensors other_seed = sensors(p, 8, "truck");
  for (int i = 0; i < 50; ++i) {
    const VehicleSample exact = at(0.02 * i, 0.3 * i);
    const VehicleSample reading = one.measure(exact);
    const VehicleSample twin = same.measure(exact);
    EXPECT_EQ(reading.wheel_rate_radps, twin.wheel_rate_radps);
    EXPECT_EQ(reading.wheel_radius_m, twin.wheel_radius_m);
    EXPECT_EQ(reading.front_steer_rad, twin.front_steer_rad);
    EXPECT_NE(reading.wheel_radius_m, other_name.measure(exact).wheel_radius_m);
    EXPECT_NE(reading.wheel_radius_m, other_seed.measure(exact).wheel_radius_m);
  }
}

TEST(VehicleSensorsTest, RadiusErrorHasItsDeviation) {
  VehicleSensorParameters p = faultless();
  p.radius_error = 0.02;
  double squares = 0.0;
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    VehicleSensors under_test = sensors(p, seed);
    for (const double radius : under_test.measure(at(0.0, 1.0)).wheel_radius_m) {
      squares += (radius / 0.5 - 1.0) * (radius / 0.5 - 1.0);
    }
  }
  // 8000 draws: 3 % are four standard deviations of the estimate.
  EXPECT_NEAR(std::sqrt(squares / 8000.0), 0.02, 0.03 * 0.02);
}

TEST(VehicleSensorsTest, ReadingsThatAreNoNumbersDoNotPoisonLaterOnes) {
  VehicleSensors under_test = sensors(VehicleSensorParameters{});
  (void)under_test.measure(at(0.0, 5.0));
  VehicleSample bad = at(0.1, kNan);
  bad.front_steer_rad = kNan;
  bad.tyre_pressure_pa.fill(kNan);
  EXPECT_TRUE(std::isfinite(under_test.measure(bad).odometry.speed_mps));
  VehicleSample back = at(0.0, 5.0);  // and time runs backwards
  (void)under_test.measure(back);
  for (int i = 2; i < 10; ++i) {
    const VehicleSample reading = under_test.measure(at(0.1 * i, 5.0));
    EXPECT_TRUE(std::isfinite(reading.wheel_rate_radps[0]));
    EXPECT_TRUE(std::isfinite(reading.front_steer_rad));
    EXPECT_TRUE(std::isfinite(reading.tyre_pressure_pa[0]));
  }
  EXPECT_NEAR(under_test.measure(at(1.0, 5.0)).wheel_rate_radps[0], 5.0, 0.13);
}

TEST(VehicleSensorsTest, WrongParametersAreRefused) {
  VehicleSensorParameters p;
  p.gate_s = 0.0;
  EXPECT_THROW(validate(p), std::invalid_argument);
  p = {};
  p.radius_error = 0.5;
  EXPECT_THROW(sensors(p), std::invalid_argument);
  p = {};
  p.ticks_per_revolution = -1;
  EXPECT_THROW(validate(p), std::invalid_argument);
  EXPECT_THROW(VehicleSensors(VehicleSensorParameters{}, OdometryParameters{0.0, 0.0}, 1, "x"),
               std::invalid_argument);
}

TEST(VehicleSensorsTest, AReadingDoesNotAllocate) {
  VehicleSensors under_test = sensors(VehicleSensorParameters{});
  const auto before = rigwire::test::allocations();
  double sum = 0.0;
  for (int i = 0; i < 1000; ++i) {
    sum += under_test.measure(at(0.01 * i, 5.0)).odometry.speed_mps;
  }
  EXPECT_EQ(rigwire::test::allocations(), before);
  EXPECT_GT(sum, 0.0);
}

}  // namespace
}  // namespace rigwire::sim
