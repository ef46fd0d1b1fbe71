// RTKLIB's own position from the raw measurements and the navigation messages that the receiver put
// out: satellites, signals, receiver clock, messages and bytes are all ours, the fix is not.
//
// convbin and rnx2rtkp are required dependencies: without them these tests fail.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "child_process.h"
#include "emulators/ublox/profile.h"
#include "private_wires.h"
#include "sim/gnss/gnss_sensor.h"
#include "sim/local_frame.h"
#include "simulated_receiver.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using test::ChildProcess;

class OpenSky final : public sim::Visibility {
 public:
  [[nodiscard]] bool blocked(const Eigen::Vector3d&, const Eigen::Vector3d&,
                             double) const override {
    return false;
  }
};

struct Case {
  std::string name;
  const emulators::UbloxProfile* profile;
  std::vector<std::string> messages;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << c.name;
}

class RtklibRun : public testing::Test {
 protected:
  /// A receiver of that name, so long at rest under an open sky, as `name`.ubx.
  void record(const Case& of, const std::string& name, const sim::GnssParameters& parameters,
              Duration span, const Eigen::Vector3d& p_W = Eigen::Vector3d::Zero()) {
    emulators::UbloxSettings settings;
    settings.profile = of.profile;
    settings.baud = 115'200;
    settings.nmea_sentences.clear();
    settings.ubx_messages = of.messages;
    sim::GnssSensor sensor(parameters, calendar_, frame_, 1, name);
    const OpenSky sky;
    sim::LinkMotion at_rest;
    at_rest.X_WL.translation() = p_W;
    const test::Recording recording = test::run_receiver(
        settings, calendar_, [&](SimTime time) { return sensor.sample(time, at_rest, sky); }, span);
    EXPECT_EQ(recording.counters.messages_lost, 0U);
    std::ofstream(file(name + ".ubx"), std::ios::binary) << recording.bytes;
    ChildProcess convbin({"convbin", "-r", "ubx", "-v", "3.04", "-oi", "-ot", "-ol", "-o",
                          file(name + ".obs"), "-n", file(name + ".nav"), file(name + ".ubx")},
                         file("convbin.log"));
    EXPECT_EQ(convbin.wait(30s), 0) << convbin.output();
  }

  struct Point {
    Eigen::Vector3d error_W = Eigen::Vector3d::Zero();  ///< East, north, up.
    int satellites = 0;
    int quality = 0;  ///< 1 fixed, 2 float, 5 single.
  };
  /// RTKLIB's positions, one an epoch, of these files of observations.
  [[nodiscard]] std::vector<Point> solve(const std::string& options,
                                         const std::vector<std::string>& receivers) {
    std::ofstream(file("options.conf")) << "pos1-elmask=5\n"
                                           "out-solformat=xyz\n"
                                           "out-outhead=off\n" +
                                               options;
    std::vector<std::string> command{"rnx2rtkp", "-k", file("options.conf"), "-o", file("raw.pos")};
    for (const std::string& receiver : receivers) {
      command.push_back(file(receiver + ".obs"));
    }
    command.push_back(file(receivers.front() + ".nav"));
    ChildProcess solver(command, file("rnx2rtkp.log"));
    EXPECT_EQ(solver.wait(60s), 0) << solver.output();
    const Eigen::Vector3d truth_E = frame_.to_ecef(Eigen::Vector3d::Zero());
    const Eigen::Vector3d east_E = frame_.to_ecef(Eigen::Vector3d::UnitX()) - truth_E;
    const Eigen::Vector3d north_E = frame_.to_ecef(Eigen::Vector3d::UnitY()) - truth_E;
    const Eigen::Vector3d up_E = frame_.to_ecef(Eigen::Vector3d::UnitZ()) - truth_E;
    std::vector<Point> points;
    std::ifstream lines(file("raw.pos"));
    for (std::string line; std::getline(lines, line);) {
      if (line.empty() || line[0] == '%') {
        continue;
      }
      std::istringstream fields(line);
      std::string date;
      std::string clock;
      Eigen::Vector3d position_E;
      Point point;
      fields >> date >> clock >> position_E.x() >> position_E.y() >> position_E.z() >>
          point.quality >> point.satellites;
      EXPECT_TRUE(fields) << line;
      const Eigen::Vector3d error_E = position_E - truth_E;
      point.error_W = {error_E.dot(east_E), error_E.dot(north_E), error_E.dot(up_E)};
      points.push_back(point);
    }
    return points;
  }
  [[nodiscard]] std::string file(const std::string& name) const {
    return (wires_.folder / name).string();
  }

  /// The coefficients of the ionosphere come in subframe 4, page 18, once in twelve and a half
  /// minutes; convbin then applies them to the whole file.
  static constexpr auto kWithPage18 = 800s;
  static constexpr const char* kNoAtmosphere =
      "pos1-posmode=single\npos1-ionoopt=off\npos1-tropopt=off\n";
  static constexpr const char* kBroadcastModels =
      "pos1-posmode=single\npos1-ionoopt=brdc\npos1-tropopt=saas\n";

  // A date before the host's: RTKLIB resolves the ten bits of the week by the host's clock.
  Calendar calendar_{UtcTime{2026, 6, 1, 8, 0, 0, 0}};
  sim::LocalFrame frame_{{49.4240, 7.7510, 280.0, 48.0}};
  test::PrivateWires wires_;
};

class Rtklib : public RtklibRun, public testing::WithParamInterface<Case> {
 protected:
  void record(const sim::GnssParameters& parameters, Duration span) {
    RtklibRun::record(GetParam(), "raw", parameters, span);
  }
  [[nodiscard]] std::vector<Point> solve(const std::string& options) {
    return RtklibRun::solve(options, {"raw"});
  }
};

TEST_P(Rtklib, WithoutErrorsItsFixIsTheTruthToACentimetre) {
  sim::GnssParameters parameters;
  parameters.errors = false;
  parameters.raw_measurements = true;
  parameters.ionosphere = false;
  parameters.troposphere = false;
  record(parameters, 600s);
  const auto points = solve(kNoAtmosphere);
  // The first thirty seconds bring the ephemerides, six seconds a subframe.
  ASSERT_GE(points.size(), 500U);
  double greatest_m = 0.0;
  for (const auto& point : points) {
    greatest_m = std::max(greatest_m, point.error_W.norm());
    EXPECT_GE(point.satellites, 4);
  }
  EXPECT_LT(greatest_m, 0.01);
  RecordProperty("greatest_error_mm", std::to_string(greatest_m * 1e3));
}

TEST_P(Rtklib, TheAtmosphereThatIsBroadcastIsTakenOutAgain) {
  sim::GnssParameters parameters;
  parameters.errors = false;
  parameters.raw_measurements = true;
  record(parameters, kWithPage18);
  const auto points = solve(kBroadcastModels);
  ASSERT_GE(points.size(), 400U);
  double greatest_m = 0.0;
  for (const auto& point : points) {
    greatest_m = std::max(greatest_m, point.error_W.norm());
  }
  EXPECT_LT(greatest_m, 0.1);
  RecordProperty("greatest_error_mm", std::to_string(greatest_m * 1e3));
}

TEST_P(Rtklib, WithErrorsItsFixStaysWithinTheBudget) {
  sim::GnssParameters parameters;
  parameters.raw_measurements = true;
  record(parameters, kWithPage18);
  const auto points = solve(kBroadcastModels);
  ASSERT_GE(points.size(), 400U);
  double square_m2 = 0.0;
  for (const auto& point : points) {
    square_m2 += point.error_W.squaredNorm();
    EXPECT_LT(point.error_W.norm(), 30.0);
  }
  const double rms_m = std::sqrt(square_m2 / static_cast<double>(points.size()));
  EXPECT_GT(rms_m, 0.2) << "the errors are missing";
  EXPECT_LT(rms_m, 8.0);
  RecordProperty("rms_m", std::to_string(rms_m));
}

// Errors of satellites and air that were each receiver's own left RTKLIB float after 15 minutes, at
// a baseline of 17.8 m. Its own options: ratio 3, single frequency.
TEST_F(RtklibRun, BetweenTwoReceiversTheErrorsOfSatellitesAndAirCancel) {
  const Case m8t{"NEOM8T", &emulators::ublox_neo_m8t(), {"RXM-RAWX", "RXM-SFRBX"}};
  sim::GnssParameters parameters;
  parameters.raw_measurements = true;
  const Eigen::Vector3d baseline_W(4.0, 0.0, 0.0);
  record(m8t, "rover", parameters, 900s, baseline_W);
  record(m8t, "base", parameters, 900s);
  const Eigen::Vector3d base_E = frame_.to_ecef(Eigen::Vector3d::Zero());
  std::ostringstream options;
  options.precision(4);
  options << std::fixed
          << "pos1-posmode=kinematic\npos1-frequency=l1\npos1-navsys=1\npos1-ionoopt=brdc\n"
             "pos1-tropopt=saas\npos2-armode=continuous\nant2-postype=xyz\nant2-pos1="
          << base_E.x() << "\nant2-pos2=" << base_E.y() << "\nant2-pos3=" << base_E.z() << "\n";
  const auto points = solve(options.str(), {"rover", "base"});
  ASSERT_GE(points.size(), 700U);
  // Ambiguities stay floating on one frequency; without shared errors it is 18 m after the same
  // time.
  EXPECT_LT((points.back().error_W - baseline_W).norm(), 1.0);
}

INSTANTIATE_TEST_SUITE_P(
    Receivers, Rtklib,
    testing::Values(Case{"NEO7P", &emulators::ublox_neo_7p(), {"RXM-RAW", "RXM-SFRB"}},
                    Case{"NEOM8T", &emulators::ublox_neo_m8t(), {"RXM-RAWX", "RXM-SFRBX"}},
                    Case{"ZEDF9P", &emulators::ublox_zed_f9p(), {"RXM-RAWX", "RXM-SFRBX"}}),
    [](const testing::TestParamInfo<Case>& at) { return at.param.name; });

}  // namespace
}  // namespace rigwire
