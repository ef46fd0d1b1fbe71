// The driving field programs against their rigs as processes, in real time: everything between them
// is wires. What they believe is held against the truth tap.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
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

double distance_m(const Json& a, const Json& b) {
  return std::hypot(a["position_m"][0].get<double>() - b["position_m"][0].get<double>(),
                    a["position_m"][1].get<double>() - b["position_m"][1].get<double>());
}

class FieldPrograms : public testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path file(const std::string& name) const {
    return wires_.folder / name;
  }

  [[nodiscard]] std::vector<std::string> rig(const std::string& name) const {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/rigwire",
                                   "run",
                                   name,
                                   "--status",
                                   "none",
                                   "--truth",
                                   file("truth.jsonl").string(),
                                   "--report",
                                   file("report.json").string()};
    for (const auto& set : wires_.driving_sets(name)) {
      words.push_back("--set");
      words.push_back(set);
    }
    return words;
  }

  [[nodiscard]] std::vector<std::string> program(const std::string& name,
                                                 const std::vector<std::string>& more) const {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/" + name,
                                   "--gnss",
                                   wires_.gnss(),
                                   "--can",
                                   wires_.can(),
                                   "--gnss-sigma",
                                   "0.5",
                                   "--silence",  // a busy machine may hold the rig up
                                   "60"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  [[nodiscard]] bool wires_are_up() const {
    std::error_code ignored;
    return std::filesystem::exists(wires_.gnss(), ignored) &&
           std::filesystem::exists(wires_.can(), ignored);
  }

  [[nodiscard]] std::vector<Json> truth() const {
    std::ifstream stream(file("truth.jsonl"));
    std::vector<Json> records;
    for (std::string line; std::getline(stream, line);) {
      const Json record = Json::parse(line, nullptr, false);
      if (!record.is_discarded()) {  // The last line may be half written.
        records.push_back(record);
      }
    }
    return records;
  }

  /// How far the machine has come.
  [[nodiscard]] double way_m() const {
    std::this_thread::sleep_for(200ms);
    const std::vector<Json> records = truth();
    return records.empty() ? 0.0 : distance_m(records.front(), records.back());
  }

  test::PrivateWires wires_;
};

TEST_F(FieldPrograms, PathFollowDrivesTheUnimogAlongTheTrackAndStops) {
  ChildProcess rig_process(rig("unimog_forest"), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig_process.output();
  ChildProcess driver(
      program("path_follow", {"--path", RIGWIRE_SOURCE_DIR "/configs/paths/forest_track.csv",
                              "--antenna", "3.2,0"}),
      file("driver.log"));
  EXPECT_TRUE(eventually([&] { return way_m() > 9.0; })) << driver.output();
  driver.signal(SIGINT);
  EXPECT_EQ(driver.wait(), 0) << driver.output();
  rig_process.signal(SIGINT);
  EXPECT_EQ(rig_process.wait(), 130) << rig_process.output();

  const std::vector<Json> records = truth();
  ASSERT_FALSE(records.empty());
  EXPECT_GT(distance_m(records.front(), records.back()), 8.0) << driver.output();
  // The track runs along the x axis there, between y = 0 and y = -2.4 m.
  for (const Json& record : records) {
    EXPECT_LT(std::abs(record["position_m"][1].get<double>() + 1.2), 3.5) << record["sim_s"];
  }
  EXPECT_LT(std::hypot(records.back()["velocity_mps"][0].get<double>(),
                       records.back()["velocity_mps"][1].get<double>()),
            0.05)
      << "it does not stand at the end";
}

TEST_F(FieldPrograms, RollLaneRollsInCrabOffset) {
  ChildProcess rig_process(rig("roller_road"), file("rig.log"));
  ASSERT_TRUE(eventually([&] { return wires_are_up(); })) << rig_process.output();
  ChildProcess driver(program("roll_lane", {"--lanes", "1", "--length", "18", "--transition", "8"}),
                      file("driver.log"));
  EXPECT_EQ(driver.wait(), 0) << driver.output();
  rig_process.signal(SIGINT);
  EXPECT_EQ(rig_process.wait(), 130) << rig_process.output();

  const std::vector<Json> records = truth();
  ASSERT_FALSE(records.empty());
  EXPECT_NEAR(distance_m(records.front(), records.back()), 18.0, 2.0);
  double crab_rad = 0.0;
  for (const Json& record : records) {
    EXPECT_LT(std::abs(record["position_m"][1].get<double>() + 3.0), 1.5) << record["sim_s"];
    crab_rad = std::max(crab_rad, std::min(record["steer_rad"][0].get<double>(),
                                           record["steer_rad"][1].get<double>()));
  }
  EXPECT_GT(crab_rad, 0.12) << "the drums were never turned alike";
}

}  // namespace
}  // namespace rigwire
