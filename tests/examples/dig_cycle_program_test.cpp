// The program as a process, against a rig on real wires: it works, and it stops safely.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "child_process.h"
#include "fake_rig.h"

namespace rigwire::dig_cycle {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using ::testing::HasSubstr;

class DigCycleProgram : public ::testing::Test {
 protected:
  DigCycleProgram()
      : directory(fs::temp_directory_path() / ("rigwire-dig-" + std::to_string(::getpid()))),
        rig(directory) {}
  ~DigCycleProgram() override {
    if (child > 0) {
      ::kill(child, SIGKILL);
      ::waitpid(child, nullptr, 0);
    }
    std::error_code ignored;
    fs::remove_all(directory, ignored);
  }

  void start(std::vector<std::string> extra) {
    std::vector<std::string> arguments{std::string(RIGWIRE_BINARY_DIR) + "/dig_cycle"};
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
  /// Lets the rig live until `done`, or for that time.
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
  bool working() const { return rig.valves().enabled() && !rig.neutral(); }

  fs::path directory;
  FakeRig rig;
  pid_t child = -1;
};

TEST_F(DigCycleProgram, DoesACycleAndBelievesTheTruth) {
  const std::string log = (directory / "believed.jsonl").string();
  start({"--cycles", "1", "--log", log});
  ASSERT_EQ(end(), 0) << messages();
  EXPECT_THAT(messages(), HasSubstr("1 cycles done"));
  EXPECT_FALSE(rig.valves().enabled());

  std::ifstream lines(log);
  std::string line;
  std::size_t compared = 0;
  double square_sum = 0.0;
  std::vector<std::string> phases;
  while (std::getline(lines, line)) {
    const auto entry = nlohmann::json::parse(line);
    if (entry["state"] != "working") {
      continue;
    }
    if (phases.empty() || phases.back() != entry["phase"]) {
      phases.push_back(entry["phase"]);
    }
    EXPECT_NEAR(entry["gnss"]["latitude_deg"].get<double>(), FakeRig::latitude_deg(), 1e-6);
    if (!entry["ground_z_m"].is_null()) {
      EXPECT_NEAR(entry["ground_z_m"].get<double>(), 0.0, 0.05);
    }
    const auto hour_us = entry["time_of_hour_us"].get<std::uint32_t>();
    const auto truth = std::find_if(rig.truth().begin(), rig.truth().end(), [&](const auto& item) {
      return item.time_of_hour_us == hour_us;
    });
    ASSERT_NE(truth, rig.truth().end());
    for (std::size_t joint = 0; joint < kJoints; ++joint) {
      const double error_deg =
          std::abs(entry["joints_deg"][joint].get<double>() - truth->angles_rad[joint] / kDegree);
      square_sum += error_deg * error_deg;
    }
    ++compared;
  }
  EXPECT_GT(compared, 100U);
  // Swing at 57 deg/s and a control period of age make up to 2 degrees, the arm far less. A machine
  // that is busy elsewhere makes a belief older now and then: the mean tells.
  EXPECT_LT(std::sqrt(square_sum / static_cast<double>(compared * kJoints)), 2.0);
  EXPECT_THAT(phases, ::testing::ElementsAre("approach", "dig", "lift", "swing", "dump", "return"));
}

TEST_F(DigCycleProgram, InterruptLeavesNeutralDisabledValves) {
  start({});
  ASSERT_TRUE(until([&] { return working(); })) << messages();
  ::kill(child, SIGINT);
  EXPECT_EQ(end(), 0) << messages();
  EXPECT_TRUE(rig.neutral());
  EXPECT_FALSE(rig.valves().enabled());
  EXPECT_EQ(rig.valves().fault(), emulators::valve_registers::FaultCode::none)
      << "the watchdog tripped: the program did not say goodbye";
}

// What waits to be read when the program is run again is no sensor's silence.
TEST_F(DigCycleProgram, AProgramThatWasHeldUpBlamesNoSensor) {
  rig.wait_for_client(false);
  start({});
  ASSERT_TRUE(until([&] { return working(); })) << messages();
  ::kill(child, SIGSTOP);
  (void)until([] { return false; }, 1500ms);
  ::kill(child, SIGCONT);
  const std::size_t before = rig.truth().size();
  EXPECT_TRUE(until([&] { return rig.truth().size() > before + 100 && working(); })) << messages();
  EXPECT_THAT(messages(), ::testing::Not(HasSubstr("silent")));
  ::kill(child, SIGINT);
  EXPECT_EQ(end(), 0) << messages();
}

struct Silence {
  const char* name;
  std::chrono::milliseconds limit;
  std::function<void(FakeRig::Mute&, bool)> set;
};

class DigCycleSilence : public DigCycleProgram, public ::testing::WithParamInterface<int> {
 public:
  static Silence silence(int which) {
    switch (which) {
      case 0:
        return {"gnss", 3000ms, [](auto& mute, bool on) { mute.gnss = on; }};
      case 1:
        return {"lidar", 500ms, [](auto& mute, bool on) { mute.lidar = on; }};
      case 2:
        return {"imu_chassis", 500ms, [](auto& mute, bool on) { mute.imu[0] = on; }};
      case 3:
        return {"imu_bucket", 500ms, [](auto& mute, bool on) { mute.imu[3] = on; }};
      default:
        return {"valves", 500ms, [](auto& mute, bool on) { mute.transducers = on; }};
    }
  }
};

TEST_P(DigCycleSilence, StopsWithStatus4AndNamesTheSensor) {
  const Silence which = silence(GetParam());
  start({});
  ASSERT_TRUE(until([&] { return working(); })) << messages();
  which.set(rig.mute, true);
  const auto muted = std::chrono::steady_clock::now();
  EXPECT_EQ(end(), 4) << messages();
  EXPECT_GT(std::chrono::steady_clock::now() - muted, which.limit - 250ms) << "impatient";
  EXPECT_THAT(messages(), HasSubstr(std::string(which.name) + " is silent"));
  EXPECT_TRUE(rig.neutral());
  EXPECT_FALSE(rig.valves().enabled());
}

TEST_P(DigCycleSilence, WithWaitHoldsNeutralAndResumes) {
  const Silence which = silence(GetParam());
  start({"--wait"});
  ASSERT_TRUE(until([&] { return working(); })) << messages();
  which.set(rig.mute, true);
  const std::string silent = std::string(which.name) + " is silent";
  ASSERT_TRUE(until([&] {
    return messages().find(silent) != std::string::npos && rig.neutral() && !rig.valves().enabled();
  })) << messages();
  (void)until([] { return false; }, 300ms);  // what was commanded before is still carried out
  const PerJoint held = rig.angles_rad();
  (void)until([] { return false; }, 300ms);
  EXPECT_EQ(rig.angles_rad(), held);
  which.set(rig.mute, false);
  EXPECT_TRUE(until([&] { return working(); })) << messages();
}

INSTANTIATE_TEST_SUITE_P(Sensors, DigCycleSilence, ::testing::Range(0, 5), [](const auto& test) {
  return std::string(DigCycleSilence::silence(test.param).name);
});

TEST_F(DigCycleProgram, WaitsForSensorsThatAreNotThereYet) {
  rig.mute.imu[2] = true;
  start({});
  ASSERT_TRUE(until([&] { return messages().find("waiting for imu_stick") != std::string::npos; }));
  EXPECT_TRUE(rig.neutral());
  EXPECT_FALSE(rig.valves().enabled());
  rig.mute.imu[2] = false;
  EXPECT_TRUE(until([&] { return working(); })) << messages();
}

TEST_F(DigCycleProgram, KilledProgramTripsTheWatchdogAndTheNextOneRecovers) {
  start({});
  ASSERT_TRUE(until([&] { return working(); })) << messages();
  ::kill(child, SIGKILL);
  EXPECT_EQ(end(), 128 + SIGKILL);
  EXPECT_TRUE(until([&] { return rig.neutral(); }));
  EXPECT_EQ(rig.valves().fault(), emulators::valve_registers::FaultCode::watchdog);
  start({});
  EXPECT_TRUE(until([&] { return working(); })) << messages();
}

TEST_F(DigCycleProgram, DurationEndsIt) {
  start({"--duration", "1s"});
  EXPECT_EQ(end(), 0) << messages();
}

}  // namespace
}  // namespace rigwire::dig_cycle
