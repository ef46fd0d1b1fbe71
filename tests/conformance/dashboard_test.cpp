// A run's page in a real browser: dashboard_page.py has the cases.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "child_process.h"
#include "private_wires.h"

namespace rigwire {
namespace {

using namespace std::chrono_literals;

/// What the script says when it has ended well.
std::string told(const std::string& script, const std::string& of) {
  const test::PrivateWires wires;
  test::ChildProcess page({"/usr/bin/python3", RIGWIRE_SOURCE_DIR "/tests/conformance/" + script,
                           RIGWIRE_BINARY_DIR, (wires.folder / "page").string(), of},
                          wires.folder / "page.log");
  EXPECT_EQ(page.wait(290s), 0) << page.output();
  EXPECT_THAT(page.output(), testing::HasSubstr("all seen"));
  return page.output();
}

class DashboardPage : public testing::TestWithParam<const char*> {};

TEST_P(DashboardPage, ShowsInChromiumWhatTheWiresAndTheReportSay) {
  const std::string output = told("dashboard_page.py", GetParam());
  if (const auto why = output.find("skipped: "); why != std::string::npos) {
    GTEST_SKIP() << "but for this, all was seen; "
                 << output.substr(why, output.find('\n', why) - why);
  }
}

constexpr auto kName = [](const auto& of) { return std::string(of.param); };
INSTANTIATE_TEST_SUITE_P(Groups, DashboardPage,
                         testing::Values("page", "wires", "looks", "recorded", "lasting"), kName);

class DashboardOf : public testing::TestWithParam<const char*> {};

TEST_P(DashboardOf, DrawsAndComplainsOfNothing) {
  (void)told("dashboard_rigs.py", GetParam());
}

INSTANTIATE_TEST_SUITE_P(Rigs, DashboardOf,
                         testing::Values("unimog_forest", "lidar_park", "gator_campus",
                                         "excavator_vision"),
                         kName);

TEST(Dashboard, ChangesNoByteOfAnyWire) {
  const test::PrivateWires wires;
  const auto devices = [&](const std::string& report, const std::vector<std::string>& more) {
    std::vector<std::string> words{RIGWIRE_BINARY_DIR "/rigwire",
                                   "run",
                                   "excavator_pit",
                                   "--status",
                                   "none",
                                   "--clock",
                                   "free",
                                   "--duration",
                                   "1s",
                                   "--report",
                                   (wires.folder / report).string()};
    for (const auto& set : wires.sets()) {
      words.insert(words.end(), {"--set", set});
    }
    words.insert(words.end(), more.begin(), more.end());
    test::ChildProcess run(words, wires.folder / (report + ".log"));
    EXPECT_EQ(run.wait(), 0) << run.output();
    std::ifstream file(wires.folder / report);
    auto told = nlohmann::json::parse(file)["devices"];
    for (auto& device : told) {
      device = device["stream_hash"];
    }
    return told;
  };
  const auto without = devices("without", {});
  EXPECT_GT(without.size(), 5U);
  EXPECT_EQ(devices("with", {"--dashboard"}), without);
}

}  // namespace
}  // namespace rigwire
