// gpsd 3.22 and its clients on a receiver that lives on a pseudo-terminal in real time: line by
// line what the daemon says of the bytes, and how it gets over ends and beginnings.
//
// The programs are required dependencies: without them these tests fail. Every wait is bounded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "child_process.h"
#include "live_receiver.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::ChildProcess;
using test::eventually;
using test::LiveReceiver;

class GpsdClients : public testing::Test {
 protected:
  // The daemon does not hunt for the speed of a pseudo-terminal: it listens at what the terminal is
  // set to when it opens it, which is 38400.
  GpsdClients() { settings_.baud = 38'400; }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return wires_.folder / name;
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> daemon(const std::string& log,
                                                     const std::vector<std::string>& more = {}) {
    port_ = std::to_string(test::free_port(SOCK_STREAM));
    std::vector<std::string> words{"gpsd", "-N", "-n", "-D", "5", "-S", port_};
    words.insert(words.end(), more.begin(), more.end());
    words.push_back(wires_.gnss());
    auto started = std::make_unique<ChildProcess>(words, file(log));
    // It listens before it looks at the device.
    EXPECT_TRUE(eventually([&] { return listens(); })) << started->output();
    return started;
  }
  [[nodiscard]] std::unique_ptr<ChildProcess> client(const std::string& name) {
    return std::make_unique<ChildProcess>(
        std::vector<std::string>{"stdbuf", "-oL", "gpspipe", "-w", "localhost:" + port_},
        file(name));
  }

  /// Everything that clients are told of the device, and whether it is the truth.
  struct Summary {
    std::string driver;
    std::string version;
    int fixes = 0;  ///< With position, each compared with the truth.
    bool leap_seconds = false;
    int greatest_sky = 0;
    int greatest_used = 0;
  };
  [[nodiscard]] static Summary summary(const std::string& output) {
    Summary all;
    std::istringstream lines(output);
    for (std::string line; std::getline(lines, line);) {
      const Json report = Json::parse(line, nullptr, false);
      if (!report.is_object()) {
        continue;
      }
      const std::string kind = report.value("class", "");
      if (kind == "DEVICE" || kind == "DEVICES") {
        const Json& device = kind == "DEVICE"               ? report
                             : report.at("devices").empty() ? report
                                                            : report.at("devices")[0];
        all.driver = device.value("driver", all.driver);
        all.version = device.value("subtype1", all.version);
      } else if (kind == "SKY" && report.contains("satellites")) {
        all.greatest_sky =
            std::max(all.greatest_sky, static_cast<int>(report.at("satellites").size()));
        all.greatest_used = std::max(all.greatest_used, report.value("uSat", 0));
      } else if (kind == "TPV" && report.value("mode", 0) == 3 && report.contains("lat") &&
                 report.contains("time") &&
                 (report.contains("ecefx") || report.contains("altMSL"))) {
        ++all.fixes;
        all.leap_seconds |= report.value("leapseconds", 0) == 18;
        expect_truth(report);
      }
    }
    return all;
  }
  /// What the client is told until it is enough.
  using Enough = std::function<bool(const Summary&)>;
  [[nodiscard]] static Summary heard(const ChildProcess& client, const Enough& enough,
                                     std::chrono::seconds patience = test::kPatience) {
    Summary all;
    (void)eventually(
        [&] {
          std::this_thread::sleep_for(100ms);
          all = summary(client.output());
          return enough(all);
        },
        patience);
    return all;
  }
  static void expect_truth(const Json& report) {
    const UtcTime utc = parse_utc(report.at("time").get<std::string>());
    const Calendar calendar = LiveReceiver::calendar();
    SimTime epoch = kStart;
    while (calendar.utc(epoch) != utc && epoch < kStart + 120s) {
      epoch += 100ms;
    }
    const GnssSample truth = test::driving_machine(epoch);
    // gpsd 3.22 turns NAV-SOL's coordinates into latitude and longitude only while it has none:
    // from then on those of a u-blox 7 stand still, and what it read in SOL is what counts.
    const std::array<double, 3> ecef_m = earth_centred(truth);
    if (report.contains("ecefx") &&
        std::abs(report.at("ecefx").get<double>() - ecef_m[0]) < 0.006 &&
        std::abs(report.at("ecefy").get<double>() - ecef_m[1]) < 0.006 &&
        std::abs(report.at("ecefz").get<double>() - ecef_m[2]) < 0.006) {
      return;
    }
    constexpr double kStep_deg = 1e-5 / 60.0;
    EXPECT_NEAR(report.at("lat").get<double>(), truth.latitude_deg, 0.51 * kStep_deg) << report;
    EXPECT_NEAR(report.at("lon").get<double>(), truth.longitude_deg, 0.51 * kStep_deg) << report;
    EXPECT_NEAR(report.at("altMSL").get<double>(),
                truth.ellipsoid_height_m - truth.geoid_separation_m, 0.051)
        << report;
  }
  [[nodiscard]] static std::array<double, 3> earth_centred(const GnssSample& at) {
    constexpr double kSemiMajor_m = 6'378'137.0;
    constexpr double kFlattening = 1.0 / 298.257223563;
    constexpr double kEccentricity2 = kFlattening * (2.0 - kFlattening);
    const double latitude = at.latitude_deg * M_PI / 180.0;
    const double longitude = at.longitude_deg * M_PI / 180.0;
    const double normal_m =
        kSemiMajor_m / std::sqrt(1.0 - kEccentricity2 * std::pow(std::sin(latitude), 2));
    const double axis_m = (normal_m + at.ellipsoid_height_m) * std::cos(latitude);
    return {axis_m * std::cos(longitude), axis_m * std::sin(longitude),
            (normal_m * (1.0 - kEccentricity2) + at.ellipsoid_height_m) * std::sin(latitude)};
  }

  /// Lines in which the daemon complains of what it heard.
  [[nodiscard]] static std::string complaints(const std::string& log) {
    // Its own probes of other makers' receivers are answered as by the real device; it looks for a
    // bus of the desktop; it wants four packets a second; a client of its own may hang up unread.
    static const std::regex harmless(
        "NMEA unknown msg|DBUS|cycle-start detector|detaching|CLIENT:");
    static const std::regex complaint(
        "not understood|unknown|bad |checksum|runt|invalid|WARN|ERROR|garbage|Bad Length",
        std::regex::icase);
    // Its own commands are shown with their checksums; answers to messages of later protocols, and
    // a first sentence that came before a date did, belong to every real u-blox 7.
    static const std::regex expected(
        "Writing command|UBX-ACK-NAK, class: 06, id: 01|until after ZDA or RMC");
    std::istringstream lines(log);
    std::string found;
    for (std::string line; std::getline(lines, line);) {
      if (std::regex_search(line, complaint) && !std::regex_search(line, harmless) &&
          !std::regex_search(line, expected)) {
        found += line + "\n";
      }
    }
    return found;
  }

  emulators::UbloxSettings settings_;
  test::PrivateWires wires_;

 protected:
  [[nodiscard]] bool listens() const {
    return test::port_answers(static_cast<std::uint16_t>(std::stoi(port_)));
  }
  std::string port_;
};

TEST_F(GpsdClients, TwoOfThemHearTheTruthInUbxAndTheDaemonUnderstandsEveryLine) {
  LiveReceiver receiver(settings_, wires_.gnss());
  auto gpsd = daemon("gpsd.log");
  auto first = client("first.json");
  auto second = client("second.json");
  for (const ChildProcess* listener : {first.get(), second.get()}) {
    const Summary told = heard(*listener, [](const Summary& so_far) {
      return so_far.fixes >= 4 && so_far.leap_seconds && so_far.greatest_sky >= 11 &&
             so_far.greatest_used >= 11 && so_far.version.find("PROTVER") != std::string::npos;
    });
    EXPECT_EQ(told.driver, "u-blox");
    EXPECT_THAT(told.version, testing::HasSubstr("PROTVER 14.00"));
    EXPECT_GE(told.fixes, 4);
    EXPECT_TRUE(told.leap_seconds);
    EXPECT_EQ(told.greatest_sky, 11);
    EXPECT_EQ(told.greatest_used, 11);
  }
  EXPECT_EQ(complaints(gpsd->output()), "");
  EXPECT_EQ(receiver.state().counters.messages_lost, 0U);
  EXPECT_EQ(receiver.state().bytes_refused, 0U);
}

TEST_F(GpsdClients, ADaemonThatMustNotWriteReadsTheSentences) {
  LiveReceiver receiver(settings_, wires_.gnss());
  auto gpsd = daemon("gpsd.log", {"-b"});
  auto listener = client("client.json");
  const Summary told = heard(*listener, [](const Summary& so_far) {
    return so_far.fixes >= 3 && so_far.greatest_sky >= 11 && so_far.greatest_used >= 11;
  });
  EXPECT_EQ(told.driver, "NMEA0183");
  EXPECT_GE(told.fixes, 3);
  EXPECT_EQ(told.greatest_sky, 11);
  EXPECT_EQ(told.greatest_used, 11);
  EXPECT_EQ(complaints(gpsd->output()), "");
  EXPECT_EQ(receiver.state().received.bytes, 0U);
}

TEST_F(GpsdClients, ASecondDaemonFindsTheReceiverAsTheFirstLeftIt) {
  const auto is_ublox = [](const Summary& so_far) { return so_far.driver == "u-blox"; };
  LiveReceiver receiver(settings_, wires_.gnss());
  {
    auto gpsd = daemon("first.log");
    auto listener = client("first.json");
    EXPECT_EQ(heard(*listener, is_ublox).driver, "u-blox");
    gpsd->signal(SIGTERM);
    ASSERT_TRUE(gpsd->wait().has_value());
  }
  ASSERT_TRUE(eventually([&] { return !receiver.state().client_present; }));
  auto gpsd = daemon("second.log");
  auto listener = client("second.json");
  const Summary told = heard(
      *listener, [&](const Summary& so_far) { return is_ublox(so_far) && so_far.fixes >= 1; });
  EXPECT_EQ(told.driver, "u-blox");
  EXPECT_GE(told.fixes, 1);
  EXPECT_EQ(complaints(gpsd->output()), "");
}

TEST_F(GpsdClients, TheDaemonGetsOverARestartOfTheRig) {
  auto receiver = std::make_unique<LiveReceiver>(settings_, wires_.gnss());
  auto gpsd = daemon("gpsd.log");
  const auto has_fix = [](const Summary& so_far) { return so_far.fixes >= 1; };
  EXPECT_GE(heard(*client("before.json"), has_fix).fixes, 1);
  receiver.reset();
  receiver = std::make_unique<LiveReceiver>(settings_, wires_.gnss());
  // gpsd 3.22 opens a device that went away when the next client asks, unless its first read after
  // the hang-up gave nothing: then it leaves the dead descriptor out of its select() for good,
  // until it is told to start anew.
  EXPECT_TRUE(eventually([&] {
    if (heard(*client("after.json"), has_fix, 6s).fixes >= 1) {
      return true;
    }
    gpsd->signal(SIGHUP);
    EXPECT_TRUE(eventually([&] { return listens(); }));
    return false;
  })) << gpsd->output();
}

}  // namespace
}  // namespace rigwire
