// path_follow and roll_lane as processes, against a rig on real wires: they drive, and they stop
// safely.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "child_process.h"
#include "vehicle_rig.h"

namespace rigwire::field {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using testing::HasSubstr;

class DriveProgramProcess : public testing::Test {
 protected:
  explicit DriveProgramProcess(VehicleRig::Kind kind = VehicleRig::Kind::truck)
      : directory(fs::temp_directory_path() / ("rigwire-drive-" + std::to_string(::getpid()))),
        rig(directory, kind) {}
  ~DriveProgramProcess() override {
    if (child > 0) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
    }
    std::error_code ignored;
    fs::remove_all(directory, ignored);
  }

  /// A path of some 25 m with a bend to the left, from where the vehicle stands.
  std::string path() const {
    const std::string file = (directory / "path.csv").string();
    std::ofstream stream(file);
    stream.precision(12);
    for (int i = 0; i <= 50; ++i) {
      const double x = 0.5 * i;
      const LatLon place = rig.plane().to_geodetic({x, 0.008 * x * x});
      stream << place.latitude_deg << ',' << place.longitude_deg << '\n';
    }
    return file;
  }
  /// The factor for tests in which a device falls silent.
  static constexpr const char* kSoonSilent = "2";
  /// `silence`: of the silence that it allows; a busy machine may hold the rig up.
  void start(const std::string& program, std::vector<std::string> extra,
             const std::string& silence = "60") {
    std::vector<std::string> arguments{std::string(RIGWIRE_BINARY_DIR) + "/" + program, "--silence",
                                       silence};
    for (const auto& list : {rig.arguments(), extra}) {
      arguments.insert(arguments.end(), list.begin(), list.end());
    }
    std::vector<char*> pointers;
    for (std::string& argument : arguments) {
      pointers.push_back(argument.data());
    }
    pointers.push_back(nullptr);
    const std::string messages_path = (directory / "messages").string();
    child = ::fork();
    if (child == 0) {
      const int file = ::open(messages_path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
      ::dup2(file, STDERR_FILENO);
      ::execv(pointers[0], pointers.data());
      ::_exit(127);
    }
  }
  bool until(const std::function<bool()>& done, std::chrono::milliseconds limit = test::kPatience) {
    const auto deadline = std::chrono::steady_clock::now() + limit;
    while (!done()) {
      if (std::chrono::steady_clock::now() > deadline) {
        return false;
      }
      rig.poll();
    }
    return true;
  }
  /// The exit status; -1 when it does not end in time.
  int end(std::chrono::milliseconds limit = test::kPatience) {
    int status = 0;
    if (!until([&] { return ::waitpid(child, &status, WNOHANG) == child; }, limit)) {
      return -1;
    }
    child = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }
  std::string messages() const {
    std::ifstream file(directory / "messages");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
  }

  fs::path directory;
  VehicleRig rig;
  pid_t child = -1;
};

TEST_F(DriveProgramProcess, FollowsAPathBelievesTheTruthAndParks) {
  const std::string log = (directory / "driven.jsonl").string();
  start("path_follow", {"--path", path(), "--gnss-sigma", "0.1", "--log", log});
  double worst_m = 0.0;
  ASSERT_TRUE(until([&] {
    const double x = rig.plant.position.east_m;
    worst_m = std::max(worst_m, std::abs(rig.plant.position.north_m - 0.008 * x * x));
    return x > 22.0;
  })) << messages();
  EXPECT_EQ(end(), 0) << messages();
  EXPECT_LT(worst_m, 0.5);
  EXPECT_THAT(messages(), HasSubstr("done"));
  EXPECT_TRUE(until([&] { return rig.parked(); }));
  EXPECT_FALSE(rig.gateway().control().stopping()) << "ended properly, not by silence";
  std::ifstream lines(log);
  std::string line;
  nlohmann::json last;
  while (std::getline(lines, line)) {
    last = nlohmann::json::parse(line);
  }
  EXPECT_EQ(last["state"], "stopping");
  EXPECT_NEAR(last["east_m"].get<double>(), rig.plant.position.east_m, 0.3);
  EXPECT_NEAR(last["heading_deg"].get<double>(), rig.plant.heading_rad / kDegree, 3.0);
}

TEST_F(DriveProgramProcess, ATrunkInTheWayEndsInAStopBeforeItThatSaysWhy) {
  rig.trunk = VehicleRig::Trunk{{18.0, 0.008 * 18.0 * 18.0 + 0.4}};
  auto arguments = rig.lidar_arguments();
  arguments.insert(arguments.end(), {"--path", path(), "--gnss-sigma", "0.1"});
  start("path_follow", arguments);
  EXPECT_EQ(end(), 1) << messages();
  EXPECT_THAT(messages(), HasSubstr("there is an obstacle in the way"));
  EXPECT_THAT(messages(), HasSubstr("left of the line"));
  EXPECT_THAT(messages(), HasSubstr("stopped before it"));
  EXPECT_TRUE(until([&] { return rig.parked(); }));
  // The front is 4.8 m ahead of the rear axle.
  const double gap_m = rig.trunk->place.east_m - 0.2 - rig.plant.position.east_m - 4.8;
  EXPECT_GT(gap_m, 0.8);
  EXPECT_LT(gap_m, 3.5);
}

TEST_F(DriveProgramProcess, ATrunkBesideTheWayDoesNotStopIt) {
  rig.trunk = VehicleRig::Trunk{{18.0, 0.008 * 18.0 * 18.0 + 2.6}};
  auto arguments = rig.lidar_arguments();
  arguments.insert(arguments.end(), {"--path", path(), "--gnss-sigma", "0.1"});
  start("path_follow", arguments);
  EXPECT_EQ(end(), 0) << messages();
  EXPECT_GT(rig.plant.position.east_m, 22.0);
}

TEST_F(DriveProgramProcess, DoesNotBeginOnPositionsOfALesserKindThanItNeeds) {
  start("path_follow", {"--path", path(), "--gnss-fix", "differential"});
  ASSERT_TRUE(until([&] { return messages().find("it is autonomous") != std::string::npos; }))
      << messages();
  EXPECT_THAT(messages(), HasSubstr("waiting for a position, at least differential"));
  EXPECT_FALSE(rig.moving());
  rig.differential = true;
  EXPECT_TRUE(until([&] { return rig.moving(); })) << messages();
}

TEST_F(DriveProgramProcess, ALidarThatFallsSilentStopsIt) {
  auto arguments = rig.lidar_arguments();
  arguments.insert(arguments.end(), {"--path", path(), "--speed", "1"});
  start("path_follow", arguments, kSoonSilent);
  ASSERT_TRUE(until([&] { return rig.moving(); })) << messages();
  rig.mute.lidar = true;
  EXPECT_EQ(end(), 4) << messages();
  EXPECT_THAT(messages(), HasSubstr("lidar is silent"));
}

TEST_F(DriveProgramProcess, InterruptBrakesAndParks) {
  start("path_follow", {"--path", path()});
  ASSERT_TRUE(until([&] { return rig.moving(); })) << messages();
  ::kill(child, SIGINT);
  EXPECT_EQ(end(), 0) << messages();
  EXPECT_TRUE(until([&] { return rig.parked(); }));
}

// What waits to be read when the program is run again is no device's silence.
TEST_F(DriveProgramProcess, AProgramThatWasHeldUpBlamesNoDevice) {
  rig.wait_for_client(false);
  start("path_follow", {"--path", path(), "--speed", "1"});
  ASSERT_TRUE(until([&] { return rig.moving(); })) << messages();
  ::kill(child, SIGSTOP);
  (void)until([] { return false; }, 1500ms);
  ::kill(child, SIGCONT);
  (void)until([] { return false; }, 500ms);
  ::kill(child, SIGINT);
  EXPECT_EQ(end(), 0) << messages();
  EXPECT_THAT(messages(), testing::Not(HasSubstr("silent")));
}

class DriveProgramSilence : public DriveProgramProcess,
                            public testing::WithParamInterface<std::string> {};

TEST_P(DriveProgramSilence, StopsWithStatus4AndNamesTheDevice) {
  start("path_follow", {"--path", path(), "--speed", "1", "--gnss-sigma", "0.1"}, kSoonSilent);
  ASSERT_TRUE(until([&] { return rig.moving(); })) << messages();
  const std::string& device = GetParam();
  rig.mute.gnss = device == "gnss";
  rig.mute.imu = device == "imu";
  rig.mute.gateway = device == "vehicle gateway";
  EXPECT_EQ(end(), 4) << messages();
  EXPECT_THAT(messages(), HasSubstr(device + " is silent"));
  EXPECT_TRUE(until([&] { return rig.parked(); }));
}

INSTANTIATE_TEST_SUITE_P(Devices, DriveProgramSilence,
                         testing::Values("gnss", "imu", "vehicle gateway"), [](const auto& test) {
                           std::string name = test.param;
                           std::ranges::replace(name, ' ', '_');
                           return name;
                         });

TEST_F(DriveProgramProcess, SaysWhatIsWrongWithTheCommandLine) {
  start("path_follow", {"--path", "/nowhere.csv"});
  EXPECT_EQ(end(), 2);
  EXPECT_THAT(messages(), HasSubstr("/nowhere.csv: cannot be read"));
  start("path_follow", {});
  EXPECT_EQ(end(), 2);
  EXPECT_THAT(messages(), HasSubstr("--path: missing"));
  start("path_follow", {"--path", path(), "--gnss-fix", "rtk"});
  EXPECT_EQ(end(), 2);
  EXPECT_THAT(messages(), HasSubstr("--gnss-fix: found 'rtk', allowed autonomous, differential"));
  start("path_follow", {"--path", path()}, "0.5");
  EXPECT_EQ(end(), 2);
  EXPECT_THAT(messages(), HasSubstr("--silence: found '0.5', allowed 1..1000"));
  start("roll_lane", {"--side", "up"});
  EXPECT_EQ(end(), 2);
  EXPECT_THAT(messages(), HasSubstr("--side: found 'up', allowed left or right"));
}

class RollLaneProcess : public DriveProgramProcess {
 protected:
  RollLaneProcess() : DriveProgramProcess(VehicleRig::Kind::roller) {}
};

TEST_F(RollLaneProcess, RollsTwoLanesAndParks) {
  start("roll_lane", {"--lanes", "2", "--length", "14", "--transition", "8", "--offset", "0.3",
                      "--speed", "2", "--gnss-sigma", "0.1", "--vibration", "on"});
  bool vibrated = false;
  ASSERT_TRUE(until([&] {
    vibrated = vibrated || rig.gateway().command().vibration[0];
    return rig.plant.position.east_m > 13.5;
  })) << messages();
  EXPECT_NEAR(rig.plant.position.north_m, 0.0, 0.2);
  EXPECT_NEAR(rig.plant.heading_rad, -std::asin(0.3 / 3.4), 0.04);
  EXPECT_EQ(end(), 0) << messages();
  EXPECT_TRUE(vibrated);
  EXPECT_NEAR(rig.plant.position.east_m, 0.0, 0.6);
  EXPECT_NEAR(rig.plant.position.north_m, 1.68 + 0.3 - 0.15, 0.25);
  EXPECT_FALSE(rig.gateway().command().vibration[0]);
  EXPECT_TRUE(until([&] { return rig.parked(); }));
}

}  // namespace
}  // namespace rigwire::field
