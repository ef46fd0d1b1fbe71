#include "sim/gnss/signal_path.h"
#include "fields/constants.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>

#include "sim/local_frame.h"

namespace rigwire::sim {
namespace {

constexpr std::array kSignalPathGps{GnssSystem::gps};
constexpr std::int64_t kSignalPathSecond_ns = 1'000'000'000;

Eigen::Vector3d ecef(double latitude_deg, double longitude_deg, double height_m) {
  return LocalFrame({latitude_deg, longitude_deg, height_m, 0.0}).to_ecef(Eigen::Vector3d::Zero());
}

class SignalPathTest : public testing::Test {
 protected:
  std::shared_ptr<const Constellation> constellation_ = make_nominal_constellation(kSignalPathGps);
};

TEST_F(SignalPathTest, RangeIsTheFlightOfLightInAnInertialFrame) {
  // The inertial frame that is the earth's at reception. Bisection for the time of flight.
  for (const double latitude_deg : {-89.0, 0.0, 49.4, 70.0}) {
    ReceptionPoint antenna;
    antenna.time = {
        2421, 7'200 * kSignalPathSecond_ns + 20'000'000};  // signals left before the sets changed
    antenna.offset_s = 3.2e-4;
    antenna.position_E_m = ecef(latitude_deg, 179.9, 300.0);
    for (std::size_t i = 0; i < constellation_->satellites().size(); ++i) {
      double low_s = 0.0;
      double high_s = 0.2;
      double distance_m = 0.0;
      for (int round = 0; round < 70; ++round) {
        const double flight_s = 0.5 * (low_s + high_s);
        const Eigen::Vector3d inertial =
            Eigen::AngleAxisd(-kEarthRate_radps * flight_s, Eigen::Vector3d::UnitZ()) *
            constellation_->state(i, antenna.time, antenna.offset_s - flight_s).position_E_m;
        distance_m = (inertial - antenna.position_E_m).norm();
        (kLightSpeed_mps * flight_s < distance_m ? low_s : high_s) = flight_s;
      }
      const SignalPath path = signal_path(*constellation_, i, antenna);
      EXPECT_NEAR(path.range_m, distance_m, 1e-6);
      EXPECT_NEAR(path.flight_s, distance_m / kLightSpeed_mps, 1e-14);
      EXPECT_NEAR(path.direction_E.norm(), 1.0, 1e-15);
    }
  }
}

TEST_F(SignalPathTest, WhoForgetsTheEarthsRotationIsTwentyMetresTooFarEast) {
  // Sagnac: omega (x_s y_r - y_s x_r) / c on each range; left out, a fix turns with the earth
  // during the flight, 465 m/s cos(latitude) times 70 ms.
  const LocalFrame frame({49.4, 7.75, 280.0, 0.0});
  ReceptionPoint antenna;
  antenna.time = {2316, 300'000 * kSignalPathSecond_ns};
  antenna.position_E_m = frame.to_ecef(Eigen::Vector3d::Zero());
  const Eigen::Vector3d& r = antenna.position_E_m;
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (std::size_t i = 0; i < constellation_->satellites().size(); ++i) {
    const SignalPath path = signal_path(*constellation_, i, antenna);
    const Eigen::Vector3d s =
        constellation_->state(i, antenna.time, antenna.offset_s - path.flight_s).position_E_m;
    const double unturned_m = (s - r).norm();
    EXPECT_NEAR(path.range_m - unturned_m,
                kEarthRate_radps * (s.x() * r.y() - s.y() * r.x()) / kLightSpeed_mps, 1e-3);
    const Eigen::Vector3d e_W = frame.world_from_ecef() * (s - r) / unturned_m;
    if (e_W.z() > 0.1) {
      const Eigen::Vector4d row(-e_W.x(), -e_W.y(), -e_W.z(), 1.0);
      normal += row * row.transpose();
      right += row * (path.range_m - unturned_m);
    }
  }
  const Eigen::Vector4d shift = normal.ldlt().solve(right);
  EXPECT_NEAR(shift.x(), 465.1 * std::cos(49.4 * kDegree) * 0.073, 3.0);
  EXPECT_LT(std::abs(shift.y()), 5.0);
}

TEST_F(SignalPathTest, RangeRateIsTheDerivativeOfRange) {
  const LocalFrame frame({49.4, 7.75, 280.0, 0.0});
  const Eigen::Vector3d v_E =
      frame.world_from_ecef().transpose() * Eigen::Vector3d(200.0, -150.0, 30.0);
  const auto path_at = [&](std::size_t i, double t) {
    ReceptionPoint antenna;
    antenna.time = {2421, 100'000 * kSignalPathSecond_ns + std::llround(t * 1e9)};
    antenna.position_E_m = frame.to_ecef({0.0, 0.0, 0.0}) + v_E * t;
    antenna.velocity_E_mps = v_E;
    return signal_path(*constellation_, i, antenna);
  };
  for (std::size_t i = 0; i < constellation_->satellites().size(); ++i) {
    const double difference = (8.0 * (path_at(i, 1.0).range_m - path_at(i, -1.0).range_m) -
                               (path_at(i, 2.0).range_m - path_at(i, -2.0).range_m)) /
                              12.0;
    EXPECT_NEAR(path_at(i, 0.0).range_rate_mps, difference, 1e-6);
  }
}

TEST_F(SignalPathTest, CarriesTheSatellitesClock) {
  ReceptionPoint antenna;
  antenna.time = {2421, 500'000 * kSignalPathSecond_ns};
  antenna.position_E_m = ecef(49.4, 7.75, 280.0);
  for (std::size_t i = 0; i < constellation_->satellites().size(); ++i) {
    const SignalPath path = signal_path(*constellation_, i, antenna);
    const SatelliteState state = constellation_->state(i, antenna.time, -path.flight_s);
    EXPECT_EQ(path.satellite_clock_s, state.clock_s);
    EXPECT_EQ(path.group_delay_s, state.group_delay_s);
    EXPECT_TRUE(path.healthy);
  }
}

TEST_F(SignalPathTest, AReceptionOffsetIsALaterTime) {
  ReceptionPoint early;
  early.time = {2421, 500'000 * kSignalPathSecond_ns};
  early.offset_s = 4e-4;
  early.position_E_m = ecef(49.4, 7.75, 280.0);
  ReceptionPoint late = early;
  late.time.time_of_week_ns += 400'000;
  late.offset_s = 0.0;
  for (std::size_t i = 0; i < constellation_->satellites().size(); ++i) {
    EXPECT_NEAR(signal_path(*constellation_, i, early).range_m,
                signal_path(*constellation_, i, late).range_m, 1e-6);
  }
}

}  // namespace
}  // namespace rigwire::sim
