#include "sim/gnss/ephemeris.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>

namespace rigwire::sim {
namespace {

constexpr double kPi = std::numbers::pi;

/// A set with every field in use, of the size that satellites broadcast.
GpsEphemeris busy_set() {
  GpsEphemeris e;
  e.prn = 17;
  e.week = 2316;
  e.ephemeris_time_s = 223'200.0;
  e.clock_time_s = 223'200.0;
  e.clock_bias_s = -3.21e-4;
  e.clock_drift = 4.5e-12;
  e.clock_drift_rate = 2.8e-17;
  e.group_delay_s = -1.1e-8;
  e.sqrt_semi_major_axis = 5153.7123;
  e.eccentricity = 0.0187;
  e.mean_anomaly_rad = 2.9;
  e.mean_motion_difference = 4.4e-9;
  e.ascending_node_rad = -1.7;
  e.inclination_rad = 0.97;
  e.argument_of_perigee_rad = 0.8;
  e.ascending_node_rate = -8.1e-9;
  e.inclination_rate = -2.3e-10;
  e.latitude_cosine_rad = 1.2e-6;
  e.latitude_sine_rad = 7.1e-6;
  e.radius_cosine_m = 240.0;
  e.radius_sine_m = 22.5;
  e.inclination_cosine_rad = -1.3e-7;
  e.inclination_sine_rad = 8.4e-8;
  e.issue_of_ephemeris = 77;
  e.issue_of_clock = 77;
  return e;
}

GpsTime at(std::int32_t week, double seconds) {
  const auto ns = static_cast<std::int64_t>(std::llround(seconds * 1e9));
  const std::int64_t weeks = ns >= 0 ? ns / kWeek_ns : -((kWeek_ns - 1 - ns) / kWeek_ns);
  return {week + static_cast<std::int32_t>(weeks), ns - weeks * kWeek_ns};
}

/// Position on the orbit by rotation matrices and bisection instead of closed products and Newton.
Eigen::Vector3d position_by_rotations(const GpsEphemeris& e, double since_toe_s) {
  const double a = std::pow(e.sqrt_semi_major_axis, 2.0);
  const double mean =
      e.mean_anomaly_rad +
      (std::sqrt(kEarthGravity_m3ps2 / std::pow(a, 3.0)) + e.mean_motion_difference) * since_toe_s;
  double low = mean - 0.2;
  double high = mean + 0.2;
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (middle - e.eccentricity * std::sin(middle) < mean ? low : high) = middle;
  }
  const double half =
      std::tan(low / 2.0) * std::sqrt((1.0 + e.eccentricity) / (1.0 - e.eccentricity));
  const double phi = 2.0 * std::atan(half) + e.argument_of_perigee_rad;
  const Eigen::Vector2d wave(std::sin(2.0 * phi), std::cos(2.0 * phi));
  const double u = phi + wave.dot(Eigen::Vector2d(e.latitude_sine_rad, e.latitude_cosine_rad));
  const double r = a * (1.0 - e.eccentricity * std::cos(low)) +
                   wave.dot(Eigen::Vector2d(e.radius_sine_m, e.radius_cosine_m));
  const double i = e.inclination_rad + e.inclination_rate * since_toe_s +
                   wave.dot(Eigen::Vector2d(e.inclination_sine_rad, e.inclination_cosine_rad));
  const double node = e.ascending_node_rad + e.ascending_node_rate * since_toe_s -
                      kEarthRate_radps * (e.ephemeris_time_s + since_toe_s);
  return Eigen::AngleAxisd(node, Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(i, Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(u, Eigen::Vector3d::UnitZ()) * Eigen::Vector3d(r, 0.0, 0.0);
}

TEST(GpsEphemerisTest, KeplersEquationHoldsToRounding) {
  for (const double e : {0.0, 1e-9, 0.005, 0.03, 0.0999}) {
    for (double mean = -2.0 * kPi; mean < 2.0 * kPi; mean += 0.0137) {
      const double anomaly = eccentric_anomaly(mean, e);
      EXPECT_NEAR(anomaly - e * std::sin(anomaly), mean, 2e-15) << e;
    }
  }
}

TEST(GpsEphemerisTest, PositionAgreesWithRotationMatrices) {
  const GpsEphemeris e = busy_set();
  for (double t = -7'200.0; t <= 7'200.0; t += 311.0) {
    const SatelliteState state = satellite_state(e, at(e.week, e.ephemeris_time_s + t));
    EXPECT_LT((state.position_E_m - position_by_rotations(e, t)).norm(), 1e-6) << t;
  }
}

TEST(GpsEphemerisTest, VelocityAndClockDriftAreTheDerivatives) {
  const GpsEphemeris e = busy_set();
  for (double t = -7'200.0; t <= 7'200.0; t += 977.0) {
    const auto state = [&](double offset_s) {
      return satellite_state(e, at(e.week, e.ephemeris_time_s + t), offset_s);
    };
    // Differences over one and two seconds, combined to the fourth order.
    const Eigen::Vector3d difference = (8.0 * (state(1.0).position_E_m - state(-1.0).position_E_m) -
                                        (state(2.0).position_E_m - state(-2.0).position_E_m)) /
                                       12.0;
    EXPECT_LT((state(0.0).velocity_E_mps - difference).norm(), 1e-7) << t;
    EXPECT_NEAR(state(0.0).clock_drift, (state(1.0).clock_s - state(-1.0).clock_s) / 2.0, 1e-18);
  }
}

TEST(GpsEphemerisTest, RelativityIsThatOfTheEccentricOrbit) {
  // F e sqrt(A) sin E = -2 r v / c2 on a pure Kepler orbit (IS-GPS-200 20.3.3.3.3.1).
  GpsEphemeris e;
  e.week = 2000;
  e.sqrt_semi_major_axis = 5153.7;
  e.eccentricity = 0.02;
  e.inclination_rad = 0.96;
  for (double t = -7'000.0; t < 7'000.0; t += 500.0) {
    const SatelliteState s = satellite_state(e, at(e.week, t));
    EXPECT_NEAR(s.clock_s,
                -2.0 * s.position_E_m.dot(s.velocity_E_mps) / std::pow(kLightSpeed_mps, 2.0),
                1e-16);
  }
}

TEST(GpsEphemerisTest, AWeeksTurnIsNoStep) {
  GpsEphemeris e = busy_set();
  for (const double toe : {0.0, 3'600.0, 601'200.0}) {
    e.ephemeris_time_s = e.clock_time_s = toe;
    for (double t = -7'200.0; t <= 7'200.0; t += 450.0) {
      const SatelliteState state = satellite_state(e, at(e.week, toe + t));
      EXPECT_LT((state.position_E_m - position_by_rotations(e, t)).norm(), 1e-6);
      EXPECT_LT(std::abs(state.clock_s - e.clock_bias_s), 1e-7);
    }
  }
  // A set says its week only modulo 1024 and the user takes the nearest.
  e.ephemeris_time_s = e.clock_time_s = 604'784.0;
  GpsEphemeris other_week = e;
  ++other_week.week;
  const GpsTime early{e.week + 1, 100LL * 1'000'000'000};
  EXPECT_LT(
      (satellite_state(e, early).position_E_m - satellite_state(other_week, early).position_E_m)
          .norm(),
      1e-5);
}

TEST(GpsEphemerisTest, TimesAreSubtractedAsIntegers) {
  const GpsTime time{2421, 604'799'999'999'999};
  EXPECT_DOUBLE_EQ(seconds_between(2422, 0.0, time), -1e-9);
  EXPECT_DOUBLE_EQ(seconds_between(2421, 604'784.0, time, 0.25), 16.25 - 1e-9);
}

TEST(GpsEphemerisTest, QuantisingTakesTheNearestStep) {
  const GpsEphemeris e = busy_set();
  const GpsEphemeris q = quantised(e);
  EXPECT_EQ(quantised(q), q);
  const auto expect_step = [](double raw, double rounded, double step) {
    EXPECT_LE(std::abs(raw - rounded), 0.5 * step * (1.0 + 1e-9));
    const double steps = rounded / step;
    EXPECT_NEAR(steps, std::nearbyint(steps), 1e-5);
  };
  const double half_turns = kSemicircle_rad;
  expect_step(e.clock_bias_s, q.clock_bias_s, std::ldexp(1.0, -31));
  expect_step(e.clock_drift, q.clock_drift, std::ldexp(1.0, -43));
  expect_step(e.clock_drift_rate, q.clock_drift_rate, std::ldexp(1.0, -55));
  expect_step(e.group_delay_s, q.group_delay_s, std::ldexp(1.0, -31));
  expect_step(e.sqrt_semi_major_axis, q.sqrt_semi_major_axis, std::ldexp(1.0, -19));
  expect_step(e.eccentricity, q.eccentricity, std::ldexp(1.0, -33));
  expect_step(e.mean_anomaly_rad, q.mean_anomaly_rad, std::ldexp(half_turns, -31));
  expect_step(e.ascending_node_rad, q.ascending_node_rad, std::ldexp(half_turns, -31));
  expect_step(e.inclination_rad, q.inclination_rad, std::ldexp(half_turns, -31));
  expect_step(e.argument_of_perigee_rad, q.argument_of_perigee_rad, std::ldexp(half_turns, -31));
  expect_step(e.mean_motion_difference, q.mean_motion_difference, std::ldexp(half_turns, -43));
  expect_step(e.ascending_node_rate, q.ascending_node_rate, std::ldexp(half_turns, -43));
  expect_step(e.inclination_rate, q.inclination_rate, std::ldexp(half_turns, -43));
  expect_step(e.latitude_cosine_rad, q.latitude_cosine_rad, std::ldexp(1.0, -29));
  expect_step(e.latitude_sine_rad, q.latitude_sine_rad, std::ldexp(1.0, -29));
  expect_step(e.radius_cosine_m, q.radius_cosine_m, std::ldexp(1.0, -5));
  expect_step(e.radius_sine_m, q.radius_sine_m, std::ldexp(1.0, -5));
  expect_step(e.inclination_cosine_rad, q.inclination_cosine_rad, std::ldexp(1.0, -29));
  expect_step(e.inclination_sine_rad, q.inclination_sine_rad, std::ldexp(1.0, -29));
}

TEST(GpsEphemerisTest, AnglesWrapToTheFieldsRange) {
  GpsEphemeris e = busy_set();
  e.mean_anomaly_rad = 7.0 * kPi + 0.5;
  EXPECT_NEAR(quantised(e).mean_anomaly_rad, 0.5 - kPi, 1e-8);
  e.mean_anomaly_rad = kSemicircle_rad;  // the field ends a step below
  EXPECT_DOUBLE_EQ(quantised(e).mean_anomaly_rad, -kSemicircle_rad);
}

TEST(GpsEphemerisTest, RefusesWhatTheMessageCannotHold) {
  GpsEphemeris e = busy_set();
  e.clock_bias_s = 1.1e-3;
  EXPECT_THROW(static_cast<void>(quantised(e)), std::invalid_argument);
  e = busy_set();
  e.ephemeris_time_s = -16.0;
  EXPECT_THROW(static_cast<void>(quantised(e)), std::invalid_argument);
  e = busy_set();
  e.eccentricity = std::nan("");
  EXPECT_THROW(static_cast<void>(quantised(e)), std::invalid_argument);
}

TEST(GpsEphemerisTest, ReissuingContinuesTheOrbitAndTheClock) {
  const GpsEphemeris e = quantised(busy_set());
  for (const std::int64_t hours : {-170, -62, -2, 2, 4, 48, 96, 168}) {
    const GpsEphemeris r = reissued(e, hours * 3'600, hours / 2);
    EXPECT_GE(r.ephemeris_time_s, 0.0);
    EXPECT_LT(r.ephemeris_time_s, kWeek_s);
    EXPECT_NE(r.issue_of_ephemeris, e.issue_of_ephemeris);
    EXPECT_NE(r.issue_of_ephemeris, 0);
    EXPECT_EQ(r.issue_of_clock & 0xFF, r.issue_of_ephemeris);
    if (std::abs(hours) < 84) {  // a user reads the old set within half a week only
      const GpsTime time = at(r.week, r.ephemeris_time_s);
      const SatelliteState old_state = satellite_state(e, time);
      const SatelliteState new_state = satellite_state(r, time);
      EXPECT_LT((old_state.position_E_m - new_state.position_E_m).norm(), 0.04) << hours;
      EXPECT_NEAR(old_state.clock_s, new_state.clock_s, 0.6 * std::ldexp(1.0, -31)) << hours;
    }
  }
}

}  // namespace
}  // namespace rigwire::sim
