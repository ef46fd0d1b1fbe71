// The proof of ranges, clocks and broadcast sets: an independent client (RTKLIB's rnx2rtkp)
// computes its own position and velocity from them, which must be the truth. The program is a
// required dependency: without it these tests fail.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "recorded_receiver.h"

namespace rigwire::sim {
namespace {

constexpr std::array kSinglePointGps{GnssSystem::gps};

struct SinglePointCase {
  const char* name;
  UtcTime start;
  double latitude_deg;
  double longitude_deg;
  double height_m;
  bool atmosphere;
  double speed_mps;        ///< On a circle of 100 m; 0 = at rest.
  bool from_file = false;  ///< Sets a week old, issued anew.
};

std::ostream& operator<<(std::ostream& out, const SinglePointCase& c) {
  return out << c.name;
}

class SinglePointTest : public testing::TestWithParam<SinglePointCase> {};

std::shared_ptr<const Constellation> constellation_of(const SinglePointCase& c) {
  const auto nominal = make_nominal_constellation(kSinglePointGps);
  if (!c.from_file) {
    return nominal;
  }
  GpsTime week_ago = Calendar(c.start).gps(kStart);
  week_ago.week -= 1;
  const auto navigation = nominal->navigation(week_ago);
  std::vector<GpsEphemeris> sets;
  for (const auto& set : navigation->ephemerides) {
    if (set) {
      sets.push_back(*set);
      sets.back().inclination_rate = 1.2e-10;
    }
  }
  return make_gps_constellation(sets, navigation->ionosphere, navigation->utc);
}

TEST_P(SinglePointTest, OwnFixOfAClientIsTheTruth) {
  const SinglePointCase& c = GetParam();
  const auto circle = [&](double t) {
    const double angle = c.speed_mps / 100.0 * t;
    return AntennaMotion{{100.0 * std::cos(angle), 100.0 * std::sin(angle), 2.0},
                         c.speed_mps * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0)};
  };
  // A drift that resets the clock every six minutes.
  const Recording recording =
      record(*constellation_of(c), Calendar(c.start),
             LocalFrame({c.latitude_deg, c.longitude_deg, c.height_m, 0.0}),
             ReceiverClock({.drift = -3e-6}, 1, "clock"), 600, c.atmosphere, circle);
  RtklibRun rtklib(c.name);
  rtklib.file("rover.obs", recording.observations);
  rtklib.file("rover.nav", recording.navigation);
  const auto fixes =
      rtklib.solve(c.atmosphere ? "pos1-posmode=single\npos1-ionoopt=brdc\npos1-tropopt=saas\n"
                                : "pos1-posmode=single\npos1-ionoopt=off\npos1-tropopt=off\n");
  ASSERT_TRUE(fixes);
  EXPECT_EQ(fixes->size(), recording.truth.size());
  for (const ClientFix& fix : *fixes) {
    const RecordedTruth* truth = truth_of(recording, fix);
    ASSERT_NE(truth, nullptr) << fix.time_ns;
    // The file's pseudoranges are rounded to a millimetre. For the velocity the client leaves out
    // what is of second order in v / c, 2 mm/s a satellite, and that cycles are counted by a clock
    // that drifts, 2 mm/s here.
    EXPECT_LT((fix.position_E_m - truth->position_E_m).norm(), 0.005);
    EXPECT_LT((fix.velocity_E_mps - truth->velocity_E_mps).norm(), 0.015);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Everywhere, SinglePointTest,
    testing::Values(
        SinglePointCase{"AtRest2024", {2024, 6, 1, 8, 0, 0, 0}, 49.42, 7.75, 280.0, false, 0.0},
        SinglePointCase{"Moving2010", {2010, 3, 17, 11, 55, 0, 0}, 0.0, 180.0, 5.0, false, 20.0},
        SinglePointCase{
            "WeekTurns", {2024, 6, 1, 23, 55, 0, 0}, 70.0, -179.999, 1'200.0, false, 15.0},
        SinglePointCase{
            "TenBitWeekTurns", {1999, 8, 21, 23, 55, 0, 0}, -35.0, 140.0, 50.0, false, 0.0},
        SinglePointCase{"NearThePole", {2026, 1, 5, 3, 0, 0, 0}, -89.0, 33.0, 2'800.0, false, 10.0},
        SinglePointCase{
            "AtmosphereByDay", {2024, 6, 1, 12, 0, 0, 0}, 49.42, 7.75, 280.0, true, 20.0},
        SinglePointCase{
            "AtmosphereAtTheEquator", {2010, 3, 17, 14, 0, 0, 0}, 0.0, -0.001, -50.0, true, 0.0},
        SinglePointCase{
            "AtmosphereNearThePole", {2035, 12, 30, 23, 0, 0, 0}, -89.0, 180.0, 2'800.0, true, 5.0},
        SinglePointCase{
            "OldSetsIssuedAnew", {2024, 6, 1, 9, 55, 0, 0}, 49.42, 7.75, 280.0, true, 20.0, true}),
    [](const testing::TestParamInfo<SinglePointCase>& tested) {
      return std::string(tested.param.name);
    });

}  // namespace
}  // namespace rigwire::sim
