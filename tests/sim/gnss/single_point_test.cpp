// The proof of ranges, clocks and broadcast sets: an independent client (RTKLIB's rnx2rtkp)
// computes its own position and velocity from them, which must be the truth. The program is a
// required dependency: without it these tests fail.
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "rinex_text.h"
#include "sim/gnss/observations.h"
#include "sim/local_frame.h"

namespace rigwire::sim {
namespace {

using namespace std::chrono_literals;

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr std::array kGps{GnssSystem::gps};

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

/// What was true at an epoch, earth-fixed, and what the receiver's clock showed.
struct Truth {
  std::int64_t label_ns = 0;
  Eigen::Vector3d position_E_m;
  Eigen::Vector3d velocity_E_mps;
};

class SinglePointTest : public testing::TestWithParam<SinglePointCase> {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::temp_directory_path() /
              ("rigwire-single-point-" + std::to_string(::getpid()) + "-" + GetParam().name);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
};

std::shared_ptr<const Constellation> constellation_of(const SinglePointCase& c) {
  const auto nominal = make_nominal_constellation(kGps);
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
  const auto constellation = constellation_of(c);
  const Calendar calendar(c.start);
  const LocalFrame frame({c.latitude_deg, c.longitude_deg, c.height_m, 0.0});
  ReceiverClock clock({.drift = -3e-6}, 1, "clock");  // a reset every six minutes
  Observations observations(constellation->satellites().size(), 1, "ambiguity");

  std::ofstream observation_file(folder_ / "rover.obs");
  observation_file << test::rinex_observation_header();
  std::shared_ptr<const GpsNavigation> broadcast;
  std::string navigation_text;
  std::vector<Truth> truth;
  std::vector<TrackedSignal> signals;
  std::vector<GnssMeasurement> measurements;
  for (SimTime t = kStart; t < kStart + 600s; t += 1s) {
    const ClockEpoch epoch = clock.measure(t);
    const double angle = c.speed_mps / 100.0 * (to_seconds(t) + epoch.measured_after_s);
    const Eigen::Vector3d p_W(100.0 * std::cos(angle), 100.0 * std::sin(angle), 2.0);
    const Eigen::Vector3d v_W =
        c.speed_mps * Eigen::Vector3d(-std::sin(angle), std::cos(angle), 0.0);
    const GpsTime wanted = calendar.gps(t);
    const ReceptionPoint antenna = reception_point(wanted, epoch, frame.to_ecef(p_W),
                                                   frame.world_from_ecef().transpose() * v_W);

    const GeodeticPoint point = frame.to_geodetic(p_W);
    const Eigen::Matrix3d ned_from_ecef = frame.ned_from_world(p_W) * frame.world_from_ecef();
    signals.clear();
    for (std::size_t i = 0; i < constellation->satellites().size(); ++i) {
      const Eigen::Vector3d ned =
          ned_from_ecef * signal_path(*constellation, i, antenna).direction_E;
      const double elevation_rad = std::asin(-ned.z());
      if (elevation_rad < 5.0 * kDegree) {
        continue;
      }
      TrackedSignal signal;
      signal.satellite = i;
      if (c.atmosphere) {
        signal.ionosphere_m = klobuchar_delay_m(
            constellation->navigation(wanted)->ionosphere, point.latitude_deg * kDegree,
            point.longitude_deg * kDegree, std::atan2(ned.y(), ned.x()), elevation_rad,
            static_cast<double>(wanted.time_of_week_ns) * 1e-9);
        signal.troposphere_m = saastamoinen_delay_m(point.latitude_deg * kDegree,
                                                    point.ellipsoid_height_m, elevation_rad);
      }
      signals.push_back(signal);
    }
    observations.measure(*constellation, t, epoch, antenna, signals, measurements);

    const std::int64_t label_ns = std::int64_t{wanted.week} * 604'800'000'000'000 +
                                  wanted.time_of_week_ns + epoch.label_offset.count();
    observation_file << test::rinex_epoch(label_ns, measurements);
    truth.push_back({label_ns, antenna.position_E_m, antenna.velocity_E_mps});
    if (const auto now = constellation->navigation(wanted); now != broadcast) {
      broadcast = now;
      for (const auto& set : broadcast->ephemerides) {
        navigation_text += set ? test::rinex_ephemeris(*set) : "";
      }
    }
  }
  observation_file.close();
  std::ofstream(folder_ / "rover.nav")
      << test::rinex_navigation_header(broadcast->ionosphere) << navigation_text;
  std::ofstream(folder_ / "options.conf")
      << "pos1-posmode=single\npos1-elmask=4\npos1-sateph=brdc\npos1-navsys=1\npos1-ionoopt="
      << (c.atmosphere ? "brdc" : "off") << "\npos1-tropopt=" << (c.atmosphere ? "saas" : "off")
      << "\nout-solformat=xyz\nout-outvel=on\nout-timesys=gpst\nout-timeform=tow\n"
         "out-timendec=6\nout-outhead=off\n";

  test::ChildProcess client({"rnx2rtkp", "-p", "0", "-k", folder_ / "options.conf", "-o",
                             folder_ / "fix.pos", folder_ / "rover.obs", folder_ / "rover.nav"},
                            folder_ / "log");
  ASSERT_EQ(client.wait(), 0) << client.output();

  std::ifstream fixes(folder_ / "fix.pos");
  std::size_t count = 0;
  double worst_m = 0.0;
  double worst_mps = 0.0;
  for (std::string line; std::getline(fixes, line);) {
    if (line.empty() || line.front() == '%') {
      continue;
    }
    std::istringstream words(line);
    std::int64_t week = 0;
    double tow_s = 0.0;
    Eigen::Vector3d p;
    Eigen::Vector3d v;
    double skipped = 0.0;
    words >> week >> tow_s >> p.x() >> p.y() >> p.z();
    for (int i = 0; i < 10; ++i) {
      words >> skipped;  // quality, satellites, six deviations, age, ratio
    }
    words >> v.x() >> v.y() >> v.z();
    ASSERT_TRUE(words) << line;
    const std::int64_t fix_ns = week * 604'800'000'000'000 + std::llround(tow_s * 1e9);
    const auto& nearest = *std::ranges::min_element(
        truth, {}, [&](const Truth& one) { return std::abs(one.label_ns - fix_ns); });
    ASSERT_LT(std::abs(nearest.label_ns - fix_ns), 2'000'000) << line;
    worst_m = std::max(worst_m, (p - nearest.position_E_m).norm());
    worst_mps = std::max(worst_mps, (v - nearest.velocity_E_mps).norm());
    ++count;
  }
  EXPECT_EQ(count, truth.size());
  // The file's pseudoranges are rounded to a millimetre. For the velocity the client leaves out
  // what is of second order in v / c, 2 mm/s a satellite, and that cycles are counted by a clock
  // that drifts, 2 mm/s here.
  EXPECT_LT(worst_m, 0.005);
  EXPECT_LT(worst_mps, 0.015);
  RecordProperty("worst_mm", std::to_string(1e3 * worst_m));
  RecordProperty("worst_mmps", std::to_string(1e3 * worst_mps));
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
