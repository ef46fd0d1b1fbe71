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
#include <iterator>
#include <ostream>
#include <span>
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
    settings.transmit_buffer_bytes = 16'384;
    settings.nmea_sentences.clear();
    settings.ubx_messages = of.messages;
    const bool as_base = of.messages.front().starts_with("RTCM");
    if (as_base) {
      const Eigen::Vector3d place_E_m = frame_.to_ecef(p_W);
      settings.place_E_m = {place_E_m.x(), place_E_m.y(), place_E_m.z()};
    }
    sim::GnssSensor sensor(parameters, calendar_, frame_, 1, name);
    const OpenSky sky;
    sim::LinkMotion at_rest;
    at_rest.X_WL.translation() = p_W;
    const test::Recording recording = test::run_receiver(
        settings, calendar_, [&](SimTime time) { return sensor.sample(time, at_rest, sky); }, span);
    EXPECT_EQ(recording.counters.messages_lost, 0U);
    const std::string raw = file(name + (as_base ? ".rtcm3" : ".ubx"));
    std::ofstream(raw, std::ios::binary) << recording.bytes;
    const auto out = [&](const char* ending) { return file(name + ending); };
    const std::vector<std::string> command{"convbin",    "-r",         as_base ? "rtcm3" : "ubx",
                                           "-tr",        "2026/06/01", "08:00:00",
                                           "-v",         "3.04",       "-od",
                                           "-os",        "-oi",        "-ot",
                                           "-ol",        "-o",         out(".obs"),
                                           "-n",         out(".nav"),  "-g",
                                           out(".gnav"), "-l",         out(".lnav"),
                                           "-b",         out(".cnav"), raw};
    ChildProcess convbin(command, file("convbin.log"));
    EXPECT_EQ(convbin.wait(), 0) << convbin.output();
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
    for (const char* of_system : {".gnav", ".lnav", ".cnav"}) {
      if (std::filesystem::exists(file(receivers.front() + of_system))) {
        command.push_back(file(receivers.front() + of_system));
      }
    }
    ChildProcess solver(command, file("rnx2rtkp.log"));
    EXPECT_EQ(solver.wait(), 0) << solver.output();
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

// Raw measurements and orbits of GPS alone left RTKLIB nothing to do with the other systems. Each
// alone, and all at once: RTKLIB decodes their messages and finds the receiver.
TEST_F(RtklibRun, EverySystemAloneAndAllTogetherLeadToTheTruth) {
  const Case f9p{"ZEDF9P", &emulators::ublox_zed_f9p(), {"RXM-RAWX", "RXM-SFRBX"}};
  sim::GnssParameters parameters;
  parameters.errors = false;
  parameters.raw_measurements = true;
  parameters.second_signals = true;
  parameters.ionosphere = false;
  parameters.troposphere = false;
  parameters.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
  parameters.sky.maximum_channels = 60;
  record(f9p, "all", parameters, 300s);
  // The run begins with a half hour of UTC: for 30 s GLONASS satellites go over to their new
  // orbits.
  constexpr std::size_t kSetsChange = 31;
  for (const int systems : {1 /*GPS*/, 4 /*GLONASS*/, 8 /*Galileo*/, 32 /*BeiDou*/, 45}) {
    const auto points =
        solve(kNoAtmosphere + ("pos1-navsys=" + std::to_string(systems) + "\n"), {"all"});
    ASSERT_GE(points.size(), 200U) << systems;
    double greatest_m = 0.0;
    for (const Point& point : std::span(points).subspan(kSetsChange)) {
      greatest_m = std::max(greatest_m, point.error_W.norm());
    }
    EXPECT_LT(greatest_m, 0.01) << systems;
    RecordProperty("greatest_error_mm_" + std::to_string(systems),
                   std::to_string(greatest_m * 1e3));
    EXPECT_GE(points.back().satellites, systems == 45 ? 20 : 5) << systems;
  }
  // The second carriers, too: without ionosphere the combination that is free of it is as good but
  // for the RINEX file's millimetres, which it multiplies.
  const auto points = solve(
      "pos1-posmode=single\npos1-frequency=l1+l2\npos1-ionoopt=dual-freq\npos1-tropopt=off\n"
      "pos1-navsys=45\n",
      {"all"});
  ASSERT_GE(points.size(), 200U);
  for (const Point& point : std::span(points).subspan(kSetsChange)) {
    EXPECT_LT(point.error_W.norm(), 0.03);
  }
}

// Two receivers four metres apart, each epoch solved by RTKLIB as of a rover in motion.
class RtklibBaseline : public RtklibRun {
 protected:
  struct Outcome {
    std::size_t first = 0;  ///< Epoch of the first fix; 0: none.
    double fixed = 0.0;     ///< Share of fixes among the epochs from the first fix on.
    double greatest_m = 0.0;
  };
  [[nodiscard]] Outcome run(const Case& of, const Case& base, const sim::GnssParameters& parameters,
                            Duration span, const std::string& options) {
    const Eigen::Vector3d baseline_W(4.0, 0.0, 0.0);
    record(of, "rover", parameters, span, baseline_W);
    record(base, "base", parameters, span);
    const Eigen::Vector3d base_E = frame_.to_ecef(Eigen::Vector3d::Zero());
    std::ostringstream conf;
    conf.precision(4);
    conf << std::fixed
         << "pos1-posmode=kinematic\npos1-elmask=15\npos1-ionoopt=brdc\npos1-tropopt=saas\n"
            "pos2-armode=continuous\npos2-gloarmode=on\nant2-postype=xyz\nant2-pos1="
         << base_E.x() << "\nant2-pos2=" << base_E.y() << "\nant2-pos3=" << base_E.z() << "\n"
         << options;
    const auto points = solve(conf.str(), {"rover", "base"});
    Outcome outcome;
    std::size_t fixed = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].quality != 1) {
        continue;
      }
      outcome.first = outcome.first == 0 ? i + 1 : outcome.first;
      ++fixed;
      outcome.greatest_m =
          std::max(outcome.greatest_m, std::abs(points[i].error_W.norm() - baseline_W.norm()));
    }
    if (fixed > 0) {
      outcome.fixed =
          static_cast<double>(fixed) / static_cast<double>(points.size() - outcome.first + 1);
    }
    RecordProperty("first_fix_epoch", std::to_string(outcome.first));
    RecordProperty("fixed_after", std::to_string(outcome.fixed));
    RecordProperty("greatest_error_mm", std::to_string(outcome.greatest_m * 1e3));
    return outcome;
  }
};

// The receivers are set as delivered: GPS and GLONASS on one carrier. With GPS alone, six
// satellites above 15 degrees, RTKLIB stayed float or fixed wrong.
TEST_F(RtklibBaseline, TwoReceiversOfOneCarrierFixWithinMinutes) {
  const Case m8t{"NEOM8T", &emulators::ublox_neo_m8t(), {"RXM-RAWX", "RXM-SFRBX"}};
  sim::GnssParameters parameters;
  parameters.raw_measurements = true;
  parameters.systems = {.gps = true, .glonass = true};
  parameters.sky.maximum_channels = 72;
  const Outcome outcome = run(m8t, m8t, parameters, 900s, "pos1-frequency=l1\npos1-navsys=5\n");
  ASSERT_GT(outcome.first, 0U);
  EXPECT_LT(outcome.first, 300U);
  EXPECT_GT(outcome.fixed, 0.8);
  EXPECT_LT(outcome.greatest_m, 0.02);
}

// A ZED-F9P with a base of its kind needs 68 s with RTKLIB on a drive, less at rest.
TEST_F(RtklibBaseline, TwoReceiversOfTwoCarriersFixInSeconds) {
  const Case f9p{"ZEDF9P", &emulators::ublox_zed_f9p(), {"RXM-RAWX", "RXM-SFRBX"}};
  sim::GnssParameters parameters;
  parameters.raw_measurements = true;
  parameters.second_signals = true;
  parameters.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
  parameters.sky.maximum_channels = 60;
  const Outcome outcome = run(f9p, f9p, parameters, 300s, "pos1-frequency=l1+l2\npos1-navsys=45\n");
  ASSERT_GT(outcome.first, 0U);
  EXPECT_LT(outcome.first, 60U);
  EXPECT_GT(outcome.fixed, 0.9);
  EXPECT_LT(outcome.greatest_m, 0.02);
}

// Messages were of GPS L1 alone. What a base sends of all signals serves RTKLIB as its raw
// measurements do.
TEST_F(RtklibBaseline, ABaseThatSendsAllSignalsIsAsGood) {
  const Case rover{"ZEDF9P", &emulators::ublox_zed_f9p(), {"RXM-RAWX", "RXM-SFRBX"}};
  const Case base{"ZEDF9P",
                  &emulators::ublox_zed_f9p(),
                  {"RTCM-1005", "RTCM-1077", "RTCM-1087", "RTCM-1097", "RTCM-1127", "RTCM-1230"}};
  sim::GnssParameters parameters;
  parameters.raw_measurements = true;
  parameters.second_signals = true;
  parameters.systems = {.gps = true, .glonass = true, .galileo = true, .beidou = true};
  parameters.sky.maximum_channels = 60;
  const Outcome outcome =
      run(rover, base, parameters, 300s, "pos1-frequency=l1+l2\npos1-navsys=45\n");
  ASSERT_GT(outcome.first, 0U);
  EXPECT_LT(outcome.first, 60U);
  EXPECT_GT(outcome.fixed, 0.9);
  EXPECT_LT(outcome.greatest_m, 0.02);
  std::ifstream observations(file("base.obs"));
  const std::string text{std::istreambuf_iterator<char>(observations), {}};
  for (const char* types : {"G    8 C1C L1C D1C S1C C2L L2L D2L S2L", "R    8 C1C L1C D1C S1C C2C",
                            "E    8 C1C L1C D1C S1C C7Q", "C    8 C2I L2I D2I S2I C7I"}) {
    EXPECT_NE(text.find(types), std::string::npos) << types;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Receivers, Rtklib,
    testing::Values(Case{"NEO7P", &emulators::ublox_neo_7p(), {"RXM-RAW", "RXM-SFRB"}},
                    Case{"NEOM8T", &emulators::ublox_neo_m8t(), {"RXM-RAWX", "RXM-SFRBX"}},
                    Case{"ZEDF9P", &emulators::ublox_zed_f9p(), {"RXM-RAWX", "RXM-SFRBX"}}),
    [](const testing::TestParamInfo<Case>& at) { return at.param.name; });

}  // namespace
}  // namespace rigwire
