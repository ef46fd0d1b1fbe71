#include "sim/replay/motion_track.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

/// A body that goes round, rises and falls, and turns about a tilted axis at an uneven rate.
LinkMotion path(SimTime time) {
  constexpr double kRound_radps = 2.0 * std::numbers::pi * 0.5;
  constexpr double kRise_radps = 2.0 * std::numbers::pi * 1.5;
  constexpr double kTurn_rad = 0.6;
  const double t = to_seconds(time);
  LinkMotion motion;
  const double c = std::cos(kRound_radps * t);
  const double s = std::sin(kRound_radps * t);
  const double rise = std::sin(kRise_radps * t);
  motion.X_WL.translation() << 300.0 + 4.0 * c, -80.0 + 4.0 * s, 0.05 * rise;
  motion.v_WL_W << -4.0 * kRound_radps * s, 4.0 * kRound_radps * c,
      0.05 * kRise_radps * std::cos(kRise_radps * t);
  motion.a_WL_W << -4.0 * kRound_radps * kRound_radps * c, -4.0 * kRound_radps * kRound_radps * s,
      -0.05 * kRise_radps * kRise_radps * rise;
  // Angle a(t) about an axis that stands: rate a', acceleration a''.
  const Eigen::Vector3d axis = Eigen::Vector3d(0.2, -0.5, 1.0).normalized();
  const double angle = 1.5 * t + kTurn_rad * rise;
  motion.X_WL.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  motion.w_WL_W = axis * (1.5 + kTurn_rad * kRise_radps * std::cos(kRise_radps * t));
  motion.alpha_WL_W = axis * (-kTurn_rad * kRise_radps * kRise_radps * rise);
  return motion;
}

struct Errors {
  double place_m = 0.0;
  double turn_rad = 0.0;
  double speed_mps = 0.0;
  double rate_radps = 0.0;
  double acceleration_mps2 = 0.0;
  double angular_radps2 = 0.0;
};

/// The greatest of 2 s, half a second from the ends.
Errors errors(const MotionTrack& track) {
  Errors greatest;
  const auto raise = [](double& value, double found) { value = std::max(value, found); };
  for (SimTime t = kStart + 500ms; t <= kStart + 1500ms; t += 1ms) {
    const LinkMotion found = track.at(t);
    const LinkMotion truth = path(t);
    raise(greatest.place_m, (found.X_WL.translation() - truth.X_WL.translation()).norm());
    raise(greatest.turn_rad,
          Eigen::AngleAxisd(found.X_WL.linear().transpose() * truth.X_WL.linear()).angle());
    raise(greatest.speed_mps, (found.v_WL_W - truth.v_WL_W).norm());
    raise(greatest.rate_radps, (found.w_WL_W - truth.w_WL_W).norm());
    raise(greatest.acceleration_mps2, (found.a_WL_W - truth.a_WL_W).norm());
    raise(greatest.angular_radps2, (found.alpha_WL_W - truth.alpha_WL_W).norm());
  }
  return greatest;
}

std::vector<SimTime> instants(Duration period) {
  std::vector<SimTime> times;
  for (SimTime t = kStart; t <= kStart + 2s; t += period) {
    times.push_back(t);
  }
  return times;
}

MotionTrack of_poses(Duration period) {
  std::vector<Eigen::Isometry3d> poses;
  for (const SimTime t : instants(period)) {
    poses.push_back(path(t).X_WL);
  }
  return {instants(period), poses};
}

MotionTrack of_motions(Duration period) {
  std::vector<LinkMotion> motions;
  for (const SimTime t : instants(period)) {
    motions.push_back(path(t));
  }
  return {instants(period), motions};
}

TEST(MotionTrack, OfPosesHasTheAccelerationsOfThePathWithinTheSplinesBound) {
  const Errors e = errors(of_poses(10ms));
  // w h = 0.094 of the fast part, a third of that of the slow one: of 4.4 and 53, of 40 m/s2.
  constexpr double kBound = 0.0942 * 0.0942 / 12.0;
  EXPECT_LT(e.acceleration_mps2, 4.5 * kBound + 40.0 * kBound / 9.0);
  EXPECT_LT(e.angular_radps2, 54.0 * kBound * 1.3);  // the four numbers have overtones
  EXPECT_LT(e.place_m, 1e-6);
  EXPECT_LT(e.turn_rad, 5e-6);
  EXPECT_LT(e.speed_mps, 2e-4);
  EXPECT_LT(e.rate_radps, 2e-3);
}

TEST(MotionTrack, OfPosesGetsBetterWithTheSquareOfTheirRate) {
  const Errors coarse = errors(of_poses(20ms));
  const Errors fine = errors(of_poses(10ms));
  EXPECT_NEAR(coarse.acceleration_mps2 / fine.acceleration_mps2, 4.0, 0.4);
  EXPECT_NEAR(coarse.angular_radps2 / fine.angular_radps2, 4.0, 0.4);
}

TEST(MotionTrack, OfMotionsIsExactAtItsInstantsAndBetweenThemAsAStraightLineIs) {
  const MotionTrack track = of_motions(10ms);
  const LinkMotion truth = path(kStart + 730ms);
  const LinkMotion found = track.at(kStart + 730ms);
  EXPECT_TRUE(found.X_WL.isApprox(truth.X_WL, 1e-14));
  EXPECT_EQ(found.a_WL_W, truth.a_WL_W);
  EXPECT_EQ(found.alpha_WL_W, truth.alpha_WL_W);
  const Errors given = errors(track);
  constexpr double kBound = 0.0942 * 0.0942 / 8.0;
  EXPECT_LT(given.acceleration_mps2, 4.5 * kBound + 40.0 * kBound / 9.0);
  EXPECT_LT(given.angular_radps2, 54.0 * kBound * 1.05);
  EXPECT_LT(given.turn_rad, 5e-6);
}

TEST(MotionTrack, ItsSpeedsAreTheDerivativesOfItsPlaces) {
  const MotionTrack track = of_poses(10ms);
  constexpr Duration kSmall = 100us;
  for (SimTime t = kStart + 503ms; t < kStart + 700ms; t += 7ms) {
    const LinkMotion before = track.at(t - kSmall);
    const LinkMotion after = track.at(t + kSmall);
    const double span_s = to_seconds(2 * kSmall);
    const Eigen::Vector3d v = (after.X_WL.translation() - before.X_WL.translation()) / span_s;
    EXPECT_LT((v - track.at(t).v_WL_W).norm(), 1e-4);
    const Eigen::AngleAxisd turned(after.X_WL.linear() * before.X_WL.linear().transpose());
    EXPECT_LT((turned.axis() * turned.angle() / span_s - track.at(t).w_WL_W).norm(), 2e-3);
    EXPECT_LT(((after.v_WL_W - before.v_WL_W) / span_s - track.at(t).a_WL_W).norm(), 0.02);
  }
}

TEST(MotionTrack, BeforeAndAfterTheLinkStands) {
  const MotionTrack track = of_poses(10ms);
  for (const SimTime t : {kStart - 1ms, kStart + 2001ms}) {
    EXPECT_EQ(track.at(t).v_WL_W, Eigen::Vector3d::Zero());
    EXPECT_EQ(track.at(t).a_WL_W, Eigen::Vector3d::Zero());
  }
  EXPECT_TRUE(track.at(kStart + 1h).X_WL.isApprox(path(kStart + 2s).X_WL, 1e-12));
}

TEST(MotionTrack, AttitudesOfEitherSignAreOnePath) {
  // Through half a turn, where a rotation's quaternion changes its sign.
  std::vector<Eigen::Isometry3d> poses;
  const std::vector<SimTime> times = instants(50ms);
  for (const SimTime t : times) {
    poses.emplace_back(Eigen::AngleAxisd(4.0 * to_seconds(t), Eigen::Vector3d::UnitZ()));
  }
  const MotionTrack track(times, poses);
  for (SimTime t = kStart + 500ms; t < kStart + 1500ms; t += 3ms) {
    EXPECT_NEAR(track.at(t).w_WL_W.z(), 4.0, 1e-3);
  }
}

}  // namespace
}  // namespace rigwire::sim
