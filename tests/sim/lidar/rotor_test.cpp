#include "sim/lidar/rotor.h"

#include <gtest/gtest.h>

#include <chrono>
#include <numbers>

namespace rigwire::sim {
namespace {

using std::chrono::milliseconds;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kRate = 10.0 * kTurn;

LidarCommand turning(double rate_radps) {
  LidarCommand command;
  command.rotor_rate_radps = rate_radps;
  return command;
}

TEST(Rotor, TurnsOnThroughAChangeOfRate) {
  Rotor rotor(turning(kRate));
  EXPECT_EQ(rotor.at(kStart).azimuth_rad, 0.0);
  EXPECT_NEAR(rotor.at(kStart + milliseconds{25}).azimuth_rad, 0.25 * kTurn, 1e-12);
  rotor.command(kStart + milliseconds{50}, turning(2.0 * kRate));
  EXPECT_NEAR(rotor.at(kStart + milliseconds{60}).azimuth_rad, 0.7 * kTurn, 1e-12);
  const double after_a_day = rotor.at(kStart + std::chrono::hours{24}).azimuth_rad;
  EXPECT_GE(after_a_day, 0.0);
  EXPECT_LT(after_a_day, kTurn);
}

}  // namespace
}  // namespace rigwire::sim
