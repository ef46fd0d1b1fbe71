// `rigwire run` as a process, in real time, on private wires: what the real clients make of it, and
// what is left when things end badly. Clients are Debian's, unmodified, and required.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;
using Json = nlohmann::json;
using test::ChildProcess;
using test::eventually;
using testing::HasSubstr;

class RigProcess : public testing::Test {
 protected:
  [[nodiscard]] std::vector<std::string> command(const std::vector<std::string>& more = {}) const {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/rigwire", "run", "excavator_pit",
                                   "--status", "none"};
    for (const auto& set : wires_.sets()) {
      words.push_back("--set");
      words.push_back(set);
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return wires_.folder / name;
  }
  [[nodiscard]] bool wires_are_up() const { return wires_.are_up(); }
  /// Whether somebody listens on that port of loopback.
  [[nodiscard]] static bool listens(const std::string& port) {
    return test::port_answers(static_cast<std::uint16_t>(std::stoi(port)));
  }
  [[nodiscard]] static std::string text_of(const std::filesystem::path& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  test::PrivateWires wires_;
};

TEST_F(RigProcess, FirstInterruptEndsCleanlyWithAReport) {
  ChildProcess rig(command({"--report", file("report.json").string()}), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
  const Json report = Json::parse(text_of(file("report.json")));
  for (const char* key : {"seed", "config_hash", "clock", "sim_s", "wall_s", "cpu_s",
                          "realtime_factor", "peak_rss_mb", "stages", "devices"}) {
    EXPECT_TRUE(report.contains(key)) << key;
  }
  EXPECT_EQ(report["clock"], "real");
  EXPECT_EQ(report["devices"].size(), 9U);
  EXPECT_FALSE(std::filesystem::is_symlink(wires_.gnss()));
  EXPECT_FALSE(std::filesystem::is_symlink(wires_.can()));
}

TEST_F(RigProcess, AnInterruptDuringSetUpEndsCleanlyToo) {
  ChildProcess rig(command(), file("rig.log"));
  // The receiver's line is the first wire to be opened; the rest of the set-up still goes on.
  ASSERT_TRUE(eventually([&] { return std::filesystem::exists(wires_.can()); })) << rig.output();
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
  EXPECT_FALSE(std::filesystem::is_symlink(wires_.gnss()));
  EXPECT_FALSE(std::filesystem::is_symlink(wires_.can()));
}

TEST_F(RigProcess, AKilledRigLeavesNothingThatStopsTheNext) {
  {
    ChildProcess rig(command(), file("rig.log"));
    ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
    rig.signal(SIGKILL);
    EXPECT_EQ(rig.wait(), 128 + SIGKILL);
  }
  ChildProcess next(command({"--duration", "500ms"}), file("next.log"));
  EXPECT_EQ(next.wait(), 0) << next.output();
}

TEST_F(RigProcess, APathTakenByAFileIsAnEnvironmentErrorAndTheFileStays) {
  std::ofstream(wires_.gnss()) << "precious";
  ChildProcess rig(command({"--duration", "1s"}), file("rig.log"));
  EXPECT_EQ(rig.wait(), 3);
  EXPECT_THAT(rig.output(), HasSubstr(wires_.gnss()));
  EXPECT_EQ(text_of(wires_.gnss()), "precious");
  EXPECT_FALSE(std::filesystem::exists(wires_.can()));
}

TEST_F(RigProcess, ASecondRigOnTheSameWiresIsRefusedAndTheFirstGoesOn) {
  ChildProcess first(command(), file("first.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << first.output();
  ChildProcess second(command({"--duration", "1s"}), file("second.log"));
  EXPECT_EQ(second.wait(), 3) << second.output();
  EXPECT_TRUE(wires_are_up());
  first.signal(SIGTERM);
  EXPECT_EQ(first.wait(), 128 + SIGTERM);
}

TEST_F(RigProcess, ASecondRigInAnotherNetworkNamespaceIsRefusedToo) {
  ChildProcess first(command(), file("first.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << first.output();
  std::vector<std::string> words{"unshare", "--net"};
  if (::geteuid() != 0) {
    words.emplace_back("--map-root-user");
  }
  ChildProcess permitted({words[0], words[1], words.back(), "true"}, file("permitted.log"));
  if (permitted.wait() != 0) {
    GTEST_SKIP() << "this host permits no namespaces";
  }
  const auto rig = command({"--duration", "1s"});
  words.insert(words.end(), rig.begin(), rig.end());
  ChildProcess second(words, file("second.log"));
  EXPECT_EQ(second.wait(), 3) << second.output();
  EXPECT_THAT(second.output(), HasSubstr("another running rigwire publishes this path"));
}

TEST_F(RigProcess, LinksThatAreRemovedDuringARunAreToldAndPutBack) {
  ChildProcess rig(command(), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  std::filesystem::remove(wires_.gnss());
  std::filesystem::remove(wires_.can());
  std::ofstream(wires_.can()) << "precious";
  EXPECT_TRUE(eventually([&] { return std::filesystem::is_symlink(wires_.gnss()); }));
  EXPECT_TRUE(eventually([&] {
    const std::string said = rig.output();
    return said.find("pty " + wires_.gnss() + ": the link was removed; it is there again") !=
               std::string::npos &&
           said.find("a file is there; it stays") != std::string::npos;
  })) << rig.output();
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
  EXPECT_EQ(text_of(wires_.can()), "precious");
  EXPECT_FALSE(std::filesystem::is_symlink(wires_.gnss()));
}

TEST_F(RigProcess, TwoProgramsOnOneLineAreTold) {
  ChildProcess rig(command(), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  ChildProcess one({"cat", wires_.gnss()}, file("one.log"));
  ChildProcess other({"cat", wires_.gnss()}, file("other.log"));
  EXPECT_TRUE(eventually([&] {
    return rig.output().find("pty " + wires_.gnss() + ": 2 programs have it open: cat (") !=
           std::string::npos;
  })) << rig.output();
  rig.signal(SIGINT);
  EXPECT_EQ(rig.wait(), 130) << rig.output();
}

// What the README shows: gpsd for a map, on the port beside the one of the program that digs.
TEST_F(RigProcess, GpsdOnTheSecondPortAndTheFieldProgramOnTheFirstBothHearTheReceiver) {
  ChildProcess rig(command(), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  ChildProcess field({"cat", wires_.gnss()}, file("field.log"));
  const std::string port = std::to_string(test::free_port(SOCK_STREAM));
  ChildProcess gpsd({"gpsd", "-N", "-n", "-S", port, wires_.gnss() + ".1"}, file("gpsd.log"));
  ASSERT_TRUE(eventually([&] { return listens(port); })) << gpsd.output();
  ChildProcess pipe({"stdbuf", "-oL", "gpspipe", "-w", "localhost:" + port}, file("pipe.log"));
  EXPECT_TRUE(eventually([&] {
    const std::string told = pipe.output();
    return told.find("\"class\":\"TPV\"") != std::string::npos &&
           told.find("\"lat\"") != std::string::npos;
  })) << gpsd.output()
      << pipe.output();
  // The field program goes on hearing whole sentences beside it.
  EXPECT_TRUE(eventually([&] {
    const std::string heard = field.output();
    std::size_t sentences = 0;
    for (std::size_t at = heard.find("$GPGGA"); at != std::string::npos;
         at = heard.find("$GPGGA", at + 1)) {
      ++sentences;
    }
    return sentences >= 3;
  })) << field.output();
  EXPECT_THAT(rig.output(), testing::Not(HasSubstr("programs have it open")));
}

TEST_F(RigProcess, AMissingCanInterfaceIsAnEnvironmentErrorThatSaysTheMend) {
  auto words = command({"--set", "buses.can.wire=socketcan", "--set", "buses.can.interface=vcan77",
                        "--duration", "1s"});
  // SocketCAN has no path.
  const auto path = std::ranges::find_if(
      words, [](const std::string& word) { return word.starts_with("buses.can.path="); });
  ASSERT_NE(path, words.end());
  words.erase(path - 1, path + 1);
  ChildProcess rig(words, file("rig.log"));
  EXPECT_EQ(rig.wait(), 3) << rig.output();
  EXPECT_THAT(rig.output(), HasSubstr("CAN"));
  EXPECT_FALSE(wires_are_up());
}

TEST_F(RigProcess, GpsdFindsTheReceiverAndItsPosition) {
  ChildProcess rig(command(), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  const std::string port = std::to_string(test::free_port(SOCK_STREAM));
  // On a pseudo-terminal gpsd hunts for no speed: it takes the one that it is told, else 9600.
  ChildProcess gpsd({"gpsd", "-N", "-n", "-S", port, wires_.gnss()}, file("gpsd.log"));
  ASSERT_TRUE(eventually([&] { return listens(port); })) << gpsd.output();
  ChildProcess pipe({"stdbuf", "-oL", "gpspipe", "-w", "localhost:" + port}, file("pipe.json"));
  Json fix;
  const bool found = eventually([&] {
    std::istringstream lines(pipe.output());
    for (std::string line; std::getline(lines, line);) {
      const Json report = Json::parse(line, nullptr, false);
      if (!report.is_discarded() && report.value("class", "") == "TPV" &&
          report.value("mode", 0) == 3 && report.contains("lat")) {
        fix = report;
        return true;
      }
    }
    std::this_thread::sleep_for(100ms);
    return false;
  });
  ASSERT_TRUE(found) << gpsd.output() << pipe.output();
  // The rig's origin; the error model of the paper stays well within 50 m there.
  const double metres_per_deg = 111'200.0;
  EXPECT_NEAR(fix["lat"].get<double>(), 49.4247, 50.0 / metres_per_deg);
  EXPECT_NEAR(fix["lon"].get<double>(), 7.7517, 50.0 / metres_per_deg * 1.54);
  EXPECT_THAT(fix["time"].get<std::string>(), HasSubstr("2026-06-01T08:0"));
}

TEST_F(RigProcess, MbpollReadsTheValveDriver) {
  ChildProcess rig(command(), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  ChildProcess mbpoll({"mbpoll", "-0", "-t", "3", "-r", "30", "-c", "4", "-1", "-o", "10", "-p",
                       std::to_string(wires_.modbus_port), "127.0.0.1"},
                      file("mbpoll.log"));
  EXPECT_EQ(mbpoll.wait(), 0) << mbpoll.output();
  EXPECT_THAT(mbpoll.output(), HasSubstr("[30]:"));
}

TEST_F(RigProcess, PythonCanHearsAllFourImusOnTheBus) {
  ChildProcess rig(command(), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig.output();
  const std::string script =
      "import can, sys\n"
      "bus = can.Bus(interface='slcan', channel=sys.argv[1], bitrate=250000)\n"
      "heard = {}\n"
      "for _ in range(600):\n"
      "    frame = bus.recv(200)\n"
      "    assert frame is not None\n"
      "    if not frame.is_extended_id:\n"
      "        continue  # the swing encoder's\n"
      "    if frame.arbitration_id & 0xFF == 0:\n"
      "        continue  # the engine's\n"
      "    heard.setdefault(frame.arbitration_id & 0xFF, set()).add(\n"
      "        frame.arbitration_id >> 8 & 0xFFFF)\n"
      "bus.shutdown()\n"
      "print({hex(a): sorted(map(hex, p)) for a, p in sorted(heard.items())})\n"
      "assert sorted(heard) == [0x80, 0x81, 0x82, 0x83]\n"
      "assert all({0xF029, 0xF02A, 0xF02D} <= p for p in heard.values())\n";
  ChildProcess python({"/usr/bin/python3", "-c", script, wires_.can()}, file("python.log"));
  EXPECT_EQ(python.wait(), 0) << python.output();
}

/// Joint angles of the truth tap by hour clock, deg.
struct Truth {
  explicit Truth(const std::filesystem::path& path) {
    std::ifstream lines(path);
    for (std::string line; std::getline(lines, line);) {
      const Json record = Json::parse(line, nullptr, false);
      if (!record.is_discarded()) {
        times_us.push_back(record["time_of_hour_us"]);
        records.push_back(record);
      }
    }
  }
  [[nodiscard]] const Json& at(double time_us) const {
    const auto next = std::lower_bound(times_us.begin(), times_us.end(), time_us);
    const auto index = std::min<std::ptrdiff_t>(next - times_us.begin(),
                                                static_cast<std::ptrdiff_t>(records.size()) - 1);
    return records[static_cast<std::size_t>(index)];
  }
  /// How far a joint's angle is from all that it was in the second before, degrees.
  [[nodiscard]] double from_the_last_second(double time_us, std::size_t joint,
                                            double angle_deg) const {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    double least = at(time_us)["joint_rad"][joint].get<double>() * kDegrees;
    double most = least;
    const auto from = std::lower_bound(times_us.begin(), times_us.end(), time_us - 1e6);
    for (auto i = static_cast<std::size_t>(from - times_us.begin());
         i < records.size() && times_us[i] <= time_us; ++i) {
      const double angle = records[i]["joint_rad"][joint].get<double>() * kDegrees;
      least = std::min(least, angle);
      most = std::max(most, angle);
    }
    return std::max({0.0, least - angle_deg, angle_deg - most});
  }
  std::vector<double> times_us;
  std::vector<Json> records;
};

TEST_F(RigProcess, DigCycleKnowsFromTheWiresWhereTheMachineIs) {
  ChildProcess rig(command({"--truth", file("truth.jsonl").string()}), file("rig.log"));
  // It goes on where a busy host kept a sensor silent.
  ChildProcess field({RIGWIRE_BINARY_DIR "/dig_cycle", "--gnss", wires_.gnss(), "--can",
                      wires_.can(), "--lidar-port", std::to_string(wires_.lidar_port), "--modbus",
                      "127.0.0.1:" + std::to_string(wires_.modbus_port), "--wait", "--cycles", "1",
                      "--log", file("belief.jsonl").string()},
                     file("field.log"));
  ASSERT_EQ(field.wait(), 0) << field.output() << rig.output();
  rig.signal(SIGINT);
  ASSERT_EQ(rig.wait(), 130);

  const Truth truth(file("truth.jsonl"));
  ASSERT_FALSE(truth.records.empty());
  std::ifstream beliefs(file("belief.jsonl"));
  std::array<std::vector<double>, 4> errors_deg;
  double greatest_payload_kg = 0.0;
  double greatest_swing_deg = 0.0;
  std::size_t count = 0;
  for (std::string line; std::getline(beliefs, line);) {
    const Json belief = Json::parse(line);
    if (belief["state"] != "working") {
      continue;
    }
    const Json& record = truth.at(belief["time_of_hour_us"]);
    for (std::size_t joint = 0; joint < 4; ++joint) {
      errors_deg[joint].push_back(truth.from_the_last_second(
          belief["time_of_hour_us"], joint, belief["joints_deg"][joint].get<double>()));
    }
    greatest_payload_kg = std::max(greatest_payload_kg, record["payload_kg"].get<double>());
    greatest_swing_deg = std::max(greatest_swing_deg,
                                  record["joint_rad"][0].get<double>() * 180.0 / std::numbers::pi);
    const double metres_per_deg = 111'200.0;
    EXPECT_NEAR(belief["gnss"]["latitude_deg"].get<double>(),
                record["antenna"]["latitude_deg"].get<double>(), 50.0 / metres_per_deg);
    ++count;
  }
  ASSERT_GT(count, 200U);
  // Whether each sensor stands for its joint, with the right sign. How well they are known is
  // judged in simulated time (DigCycleBeliefs): a busy machine holds the program up, for a second
  // and more, and loses frames of the bus.
  for (std::size_t joint = 0; joint < 4; ++joint) {
    std::vector<double>& errors = errors_deg[joint];
    const auto most = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() * 9 / 10);
    std::ranges::nth_element(errors, most);
    EXPECT_LT(*most, 10.0) << "joint " << joint;
  }
  EXPECT_GT(greatest_payload_kg, 200.0) << "it never dug";
  EXPECT_GT(greatest_swing_deg, 80.0) << "it never swung to the truck";
}

TEST_F(RigProcess, DigCycleStopsWithTheSensorsNameWhenTheRigDies) {
  ChildProcess rig(command(), file("rig.log"));
  ChildProcess field({RIGWIRE_BINARY_DIR "/dig_cycle", "--gnss", wires_.gnss(), "--can",
                      wires_.can(), "--lidar-port", std::to_string(wires_.lidar_port), "--modbus",
                      "127.0.0.1:" + std::to_string(wires_.modbus_port)},
                     file("field.log"));
  ASSERT_TRUE(eventually([&] { return field.output().find("working") != std::string::npos; }))
      << field.output();
  rig.signal(SIGKILL);
  rig.wait();
  EXPECT_EQ(field.wait(), 4) << field.output();
  EXPECT_THAT(field.output(), HasSubstr("silent"));
}

}  // namespace
}  // namespace rigwire
