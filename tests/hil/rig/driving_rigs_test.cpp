// The rigs of the machines that drive, each in one process, free-running on private wires.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

struct Ran {
  RunOutcome outcome;
  std::map<std::string, DeviceReport> devices;
  std::vector<nlohmann::json> truth;
};

Ran run(const std::string& rig_name, Duration duration) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded =
      load_rig(std::string(RIGWIRE_SOURCE_DIR) + "/configs/rigs/" + rig_name + ".yaml",
               wires.driving_sets(rig_name));
  const auto path = wires.folder / "truth.jsonl";
  Ran ran;
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {path, {}});
    ran.outcome = rig.executive().run_free(kStart + duration);
    for (auto& report : rig.device_reports()) {
      ran.devices.emplace(report.name, report);
    }
  }
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    ran.truth.push_back(nlohmann::json::parse(line));
  }
  return ran;
}

class DrivingRig : public testing::TestWithParam<const char*> {};

TEST_P(DrivingRig, KeepsEveryNominalRateAndStandsStillUncommanded) {
  const Ran ran = run(GetParam(), 5s);
  ASSERT_FALSE(ran.outcome.fault.has_value()) << *ran.outcome.fault;
  EXPECT_NEAR(static_cast<double>(ran.devices.at("imu").frames), 1500.0, 12.0);
  EXPECT_GT(ran.devices.at("vehicle").frames, 1500U);
  EXPECT_GE(ran.devices.at("gnss").frames, 4U * 24U);
  for (const auto& [name, device] : ran.devices) {
    EXPECT_EQ(device.statistics.dropped, 0U) << name;
  }
  ASSERT_EQ(ran.truth.size(), 500U);
  double way_m = 0.0;
  for (int i = 0; i < 3; ++i) {
    way_m = std::max(way_m, std::abs(ran.truth.back()["position_m"][i].get<double>() -
                                     ran.truth[100]["position_m"][i].get<double>()));
  }
  EXPECT_LT(way_m, 2e-5);  // What is left of settling on rough ground.
}

TEST_P(DrivingRig, SameSeedGivesTheSameBytesOnEveryDevice) {
  const Ran first = run(GetParam(), 2s);
  const Ran second = run(GetParam(), 2s);
  ASSERT_GE(first.devices.size(), 4U);
  ASSERT_EQ(first.devices.size(), second.devices.size());
  for (const auto& [name, device] : first.devices) {
    EXPECT_EQ(device.statistics.hash.value(), second.devices.at(name).statistics.hash.value())
        << name;
  }
}

INSTANTIATE_TEST_SUITE_P(Rigs, DrivingRig,
                         testing::Values("unimog_forest", "roller_road", "gator_campus"),
                         [](const auto& rig) { return std::string(rig.param); });

}  // namespace
}  // namespace rigwire::hil
