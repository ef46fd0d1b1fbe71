// The whole excavator rig in one process, free-running on private wires.
#include "hil/rig/rig.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;

constexpr const char* kRigFile = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml";

struct RigRunRan {
  std::map<std::string, DeviceReport> devices;
  RunOutcome outcome;
};

RigRunRan run(Duration duration, std::vector<std::string> sets = {}) {
  const rigwire::test::PrivateWires wires;
  for (auto& set : wires.sets()) {
    sets.push_back(set);
  }
  const LoadedRig loaded = load_rig(kRigFile, sets);
  boost::asio::io_context io;
  Rig rig(loaded.configuration, io, {});
  RigRunRan ran;
  ran.outcome = rig.executive().run_free(kStart + duration);
  for (auto& report : rig.device_reports()) {
    ran.devices.emplace(report.name, report);
  }
  return ran;
}

TEST(RigRun, SameSeedGivesTheSameBytesOnEveryDevice) {
  const RigRunRan first = run(3s);
  const RigRunRan second = run(3s);
  ASSERT_EQ(first.devices.size(), 9U);
  for (const auto& [name, device] : first.devices) {
    EXPECT_EQ(device.statistics.hash.value(), second.devices.at(name).statistics.hash.value())
        << name;
  }
}

TEST(RigRun, AnotherSeedGivesOtherNoise) {
  const RigRunRan first = run(2s);
  const RigRunRan second = run(2s, {"seed=2"});
  for (const char* name : {"gnss", "lidar", "imu_boom", "imu_bucket", "imu_chassis", "imu_stick"}) {
    EXPECT_NE(first.devices.at(name).statistics.hash.value(),
              second.devices.at(name).statistics.hash.value())
        << name;
  }
}

TEST(RigRun, ThreadsDoNotChangeAByte) {
  const RigRunRan one = run(1s);
  const RigRunRan three = run(1s, {"devices.lidar.sensor.threads=3"});
  EXPECT_EQ(one.devices.at("lidar").statistics.hash.value(),
            three.devices.at("lidar").statistics.hash.value());
}

TEST(RigRun, OneDevicesSettingsDoNotShiftAnothersNoise) {
  const RigRunRan as_is = run(2s);
  const RigRunRan changed = run(2s, {"devices.imu_boom.rate=50"});
  for (const char* untouched : {"lidar", "gnss"}) {
    EXPECT_EQ(as_is.devices.at(untouched).statistics.hash.value(),
              changed.devices.at(untouched).statistics.hash.value())
        << untouched;
  }
  EXPECT_NE(as_is.devices.at("imu_boom").statistics.hash.value(),
            changed.devices.at("imu_boom").statistics.hash.value());
}

TEST(RigRun, EveryDeviceKeepsItsNominalRate) {
  const RigRunRan ran = run(10s);
  EXPECT_FALSE(ran.outcome.fault.has_value());
  // 12 firings of 46.08 us a packet, one position packet per 14 of them.
  const double packets = 10.0 / (12 * 46.08e-6);
  EXPECT_NEAR(static_cast<double>(ran.devices.at("lidar").frames), packets * (1.0 + 1.0 / 14.0),
              2.0);
  for (const char* imu : {"imu_boom", "imu_bucket", "imu_chassis", "imu_stick"}) {
    EXPECT_NEAR(static_cast<double>(ran.devices.at(imu).frames), 3000.0, 12.0) << imu;
  }
  EXPECT_GE(ran.devices.at("gnss").frames, 9U * 7U);
  for (const auto& [name, device] : ran.devices) {
    EXPECT_EQ(device.statistics.dropped, 0U) << name;
  }
}

TEST(RigRun, TruthTapWritesOneLinePerPeriod) {
  const rigwire::test::PrivateWires wires;
  const LoadedRig loaded = load_rig(kRigFile, wires.sets());
  const auto path = wires.folder / "truth.jsonl";
  {
    boost::asio::io_context io;
    Rig rig(loaded.configuration, io, {path, {}});
    rig.executive().run_free(kStart + 1s);
  }
  std::ifstream file(path);
  std::string line;
  std::size_t lines = 0;
  std::string last;
  while (std::getline(file, line)) {
    ++lines;
    last = line;
  }
  EXPECT_EQ(lines, 100U);
  EXPECT_NE(last.find("\"sim_s\":1.000000000"), std::string::npos) << last;
  EXPECT_NE(last.find("\"utc\":\"2026-06-01T08:00:01Z\""), std::string::npos) << last;
}

TEST(RigRun, ATakenPortLeavesNothingHalfOpen) {
  const rigwire::test::PrivateWires wires;
  auto sets = wires.sets();
  const LoadedRig loaded = load_rig(kRigFile, sets);
  boost::asio::io_context io;
  const Rig first(loaded.configuration, io, {});
  sets.push_back("devices.gnss.path=" + wires.gnss() + "2");
  sets.push_back("buses.can.path=" + wires.can() + "2");
  const LoadedRig second = load_rig(kRigFile, sets);
  boost::asio::io_context other;
  EXPECT_THROW(Rig(second.configuration, other, {}), drivers::EndpointError);
  EXPECT_FALSE(std::filesystem::exists(wires.gnss() + "2"));
  EXPECT_FALSE(std::filesystem::exists(wires.can() + "2"));
  EXPECT_TRUE(std::filesystem::exists(wires.gnss()));
}

}  // namespace
}  // namespace rigwire::hil
