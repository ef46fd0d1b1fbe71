// Satellite receivers of a running rig: their lines, their antennas, their faults.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

#include "drivers/serial_port.h"
#include "hil/files/geoid_file.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::Not;

/// A machine on level ground with receivers, free-running.
class GnssRig : public ::testing::Test {
 protected:
  void build(const std::string& devices, const std::string& origin = "{}",
             const std::string& start = "2026-06-01T08:00:00Z") {
    const auto file = wires.folder / "rig.yaml";
    std::ofstream(file) << "machine: {include: " RIGWIRE_SOURCE_DIR
                           "/configs/machines/gator_855d.yaml}\n"
                           "scene: {terrain: {type: level, size: 60 m, cell: 1 m}}\n"
                           "step: 2 ms\nslice: 20 ms\nlead: 20 ms\n"
                        << "start: " << start << "\norigin: " << origin << "\ndevices:\n"
                        << devices;
    rig = std::make_unique<Rig>(load_rig(file.string(), {}).configuration, io,
                                TruthFiles{wires.folder / "truth.jsonl", {}});
  }
  std::string receiver(const std::string& name, const std::string& more = "") {
    return "  " + name + ":\n    type: ublox-neo-7p\n    path: " + path(name) +
           "\n    baud: 57600\n    rate: 5 Hz\n    nmea_sentences: [RMC, GGA]\n" + more;
  }
  [[nodiscard]] std::string path(const std::string& name) const {
    return (wires.folder / name).string();
  }
  std::unique_ptr<drivers::SerialPort> open(const std::string& name, std::uint32_t baud) {
    auto port = std::make_unique<drivers::SerialPort>(
        io, drivers::SerialPortSettings{.path = path(name), .baud = baud});
    port->start([this](std::span<const std::uint8_t> bytes) {
      heard.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    });
    return port;
  }
  /// Looks at the lines as often as the system needs to report who is there, then runs.
  void run(Duration duration) {
    io.restart();
    io.run_for(50ms);
    const RunOutcome outcome = rig->executive().run_free(kStart + duration);
    EXPECT_FALSE(outcome.fault.has_value());
    io.restart();
    io.run_for(50ms);
  }
  [[nodiscard]] std::vector<std::string> sentences(const std::string& type) const {
    std::vector<std::string> found;
    std::istringstream lines(heard);
    for (std::string line; std::getline(lines, line);) {
      if (line.starts_with("$GP" + type)) {
        found.push_back(line);
      }
    }
    return found;
  }

  rigwire::test::PrivateWires wires;
  boost::asio::io_context io;
  std::unique_ptr<Rig> rig;
  std::string heard;
};

TEST_F(GnssRig, ClientAtTheReceiversSpeedReadsIt) {
  build(receiver("gnss", "    mount: {link: body}\n"));
  const auto client = open("gnss", 57600);
  run(3s);
  EXPECT_GE(sentences("RMC").size(), 13U);
}

TEST_F(GnssRig, ClientThatSetsNoSpeedReadsItToo) {
  build(receiver("gnss", "    mount: {link: body}\n"));
  const int plain = ::open(path("gnss").c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK);
  ASSERT_GE(plain, 0);
  run(3s);
  char bytes[16384];
  const ssize_t count = ::read(plain, bytes, sizeof(bytes));
  ::close(plain);
  ASSERT_GT(count, 0);
  heard.assign(bytes, static_cast<std::size_t>(count));
  EXPECT_GE(sentences("RMC").size(), 13U);
}

TEST_F(GnssRig, ClientAtAnotherSpeedReadsGarbage) {
  build(receiver("gnss", "    mount: {link: body}\n"));
  const auto client = open("gnss", 115200);
  run(3s);
  EXPECT_FALSE(heard.empty());
  EXPECT_THAT(heard, Not(HasSubstr("$GP")));
}

TEST_F(GnssRig, ClientAtTheSpeedOfThoseWhoDoNotChooseIsUnderstood) {
  build(receiver("gnss", "    mount: {link: body}\n"));
  const auto client = open("gnss", 9600);
  run(3s);
  EXPECT_GE(sentences("RMC").size(), 13U);
}

TEST_F(GnssRig, ClientAtThatSpeedReadsGarbageOnAStrictLine) {
  build(receiver("gnss", "    mount: {link: body}\n    check_baud: strict\n"));
  const auto client = open("gnss", 9600);
  run(3s);
  EXPECT_FALSE(heard.empty());
  EXPECT_THAT(heard, Not(HasSubstr("$GP")));
}

TEST_F(GnssRig, ClientAtAnotherSpeedReadsItWhenSpeedsAreNotChecked) {
  build(receiver("gnss", "    mount: {link: body}\n    check_baud: none\n"));
  const auto client = open("gnss", 115200);
  run(3s);
  EXPECT_GE(sentences("RMC").size(), 13U);
}

TEST_F(GnssRig, TruthNamesEveryAntenna) {
  build(receiver("left", "    mount: {link: body, position: [0.8 m, 0.5 m, 1.95 m]}\n") +
        receiver("right", "    mount: {link: body, position: [0.8 m, -0.5 m, 1.95 m]}\n"));
  run(200ms);
  rig.reset();  // closes the file
  std::ifstream file(wires.folder / "truth.jsonl");
  std::string line;
  ASSERT_TRUE(std::getline(file, line));
  const auto record = nlohmann::json::parse(line);
  const auto& left = record["antennas"]["left"];
  const auto& right = record["antennas"]["right"];
  EXPECT_EQ(record["antenna"], left);
  const double metres_per_deg = 6378137.0 * std::numbers::pi / 180.0;
  const double north_m =
      (left["latitude_deg"].get<double>() - right["latitude_deg"].get<double>()) * metres_per_deg;
  EXPECT_NEAR(north_m, 1.0, 0.01);  // the machine looks east
  EXPECT_NEAR(left["longitude_deg"].get<double>(), right["longitude_deg"].get<double>(), 1e-7);
}

TEST_F(GnssRig, OutageTakesTheFixAndGivesItBack) {
  build(receiver("gnss",
                 "    mount: {link: body, position: [0 m, 0 m, 2.5 m]}\n"
                 "    faults: [{type: outage, at: 3 s, for: 2 s}]\n"));
  const auto client = open("gnss", 57600);
  run(15s);
  std::string states;
  for (const std::string& line : sentences("RMC")) {
    const char state = line.at(line.find(',', 7) + 1);
    if (states.empty() || states.back() != state) {
      states += state;
    }
  }
  EXPECT_EQ(states, "AVA");
}

TEST_F(GnssRig, HeightsCountFromTheGeoidThatTheRigChose) {
  ASSERT_TRUE(std::filesystem::exists(kEgm96File)) << "package proj-data is not installed";
  build(receiver("gnss", "    mount: {link: body}\n"),
        "{latitude: -0.466744 deg, longitude: 0.0023 deg, geoid: egm96}");
  const auto client = open("gnss", 57600);
  run(2s);
  const auto lines = sentences("GGA");
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(lines.back(), HasSubstr(",17.3,M,"));
}

/// A NEO-7P resolves the ten-bit week to the 1024 weeks after its firmware (June 2012): dates
/// before and after are off by 7168 days, as the real one prints them.
struct Start {
  const char* utc;
  const char* date;
};
void PrintTo(const Start& start, std::ostream* out) {
  *out << start.utc;
}
class GnssRigStart : public GnssRig, public ::testing::WithParamInterface<Start> {};

TEST_P(GnssRigStart, IsTheDateWithinTheReceiversWeeks) {
  build(receiver("gnss", "    mount: {link: body, position: [0 m, 0 m, 3 m]}\n"), "{}",
        GetParam().utc);
  const auto client = open("gnss", 57600);
  run(2s);
  const auto lines = sentences("RMC");
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(lines.back(), HasSubstr(",A,"));
  EXPECT_THAT(lines.back(), HasSubstr("," + std::string(GetParam().date) + ","));
}

INSTANTIATE_TEST_SUITE_P(From1999To2035, GnssRigStart,
                         ::testing::Values(Start{"1999-01-01T12:00:00Z", "170818"},
                                           Start{"1999-08-21T23:59:49Z", "060419"},
                                           Start{"2012-06-30T12:00:00Z", "300612"},
                                           Start{"2019-04-06T23:59:45Z", "060419"},
                                           Start{"2035-12-31T12:00:00Z", "160516"}),
                         [](const auto& test) {
                           std::string day(test.param.utc, 10);
                           std::ranges::replace(day, '-', '_');
                           return "on_" + day;
                         });

TEST_F(GnssRig, LeapSecondIsPrinted) {
  build(receiver("gnss", "    mount: {link: body}\n"), "{}", "2016-12-31T23:59:58Z");
  const auto client = open("gnss", 57600);
  run(5s);
  EXPECT_THAT(heard, HasSubstr("$GPRMC,235959"));
  EXPECT_THAT(heard, HasSubstr("$GPRMC,235960"));
  EXPECT_THAT(heard, HasSubstr("$GPRMC,000000"));
}

}  // namespace
}  // namespace rigwire::hil
