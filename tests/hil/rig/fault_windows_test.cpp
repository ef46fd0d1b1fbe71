// Periods of all faults of a rig, whatever they act on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::Contains;

std::vector<FaultWindow> windows_of(const std::string& rig) {
  return fault_windows(
      load_rig(RIGWIRE_SOURCE_DIR "/tests/hil/streams/" + rig + ".yaml", {}).configuration);
}

TEST(FaultWindows, faults_of_a_bus_name_bus_and_device) {
  const auto windows = windows_of("can");
  EXPECT_THAT(windows, Contains(FaultWindow{"bus can", "short", kStart + 2500ms, kStart + 3s}));
  EXPECT_THAT(windows,
              Contains(FaultWindow{"bus can", "wrong_rate imu", kStart + 3500ms, kStart + 4s}));
}

TEST(FaultWindows, every_rig_of_faults_tells_some) {
  for (const char* rig : {"can", "gnss", "lidar", "modbus", "usb"}) {
    const auto windows = windows_of(rig);
    EXPECT_FALSE(windows.empty()) << rig;
    for (const FaultWindow& window : windows) {
      EXPECT_LT(window.begin, window.end) << rig << ": " << window.where << " " << window.type;
    }
  }
}

TEST(FaultWindows, faults_of_valves_name_the_section_and_may_last_to_the_end) {
  const auto windows =
      fault_windows(load_rig(RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml",
                             {"devices.valves.faults=[{type: stuck_spool, at: 2 s, section: 2},"
                              " {type: supply, at: 3 s, for: 1 s, value: 9 V}]"})
                        .configuration);
  EXPECT_THAT(windows, Contains(FaultWindow{"valves", "stuck_spool boom", kStart + 2s, kNever}));
  EXPECT_THAT(windows, Contains(FaultWindow{"valves", "supply", kStart + 3s, kStart + 4s}));
}

TEST(FaultWindows, a_supply_that_fails_is_told_as_a_fault) {
  const auto windows = windows_of("can");
  EXPECT_THAT(windows, Contains(FaultWindow{"imu", "off", kStart + 1500ms, kStart + 12s}));
  EXPECT_THAT(windows, Contains(FaultWindow{"imu_300", "off", kStart + 4500ms, kStart + 5s}));
  EXPECT_THAT(windows, Contains(FaultWindow{"mti", "off", kStart + 2s, kStart + 2300ms}));
  EXPECT_THAT(windows, Contains(FaultWindow{"wheel", "off", kStart + 2500ms, kStart + 2700ms}));
}

TEST(FaultWindows, a_fault_acts_from_its_beginning_until_before_its_end) {
  const FaultWindow window{"gnss", "outage", kStart + 1s, kStart + 2s};
  EXPECT_FALSE(window.acts_at(kStart + 1s - 1ns));
  EXPECT_TRUE(window.acts_at(kStart + 1s));
  EXPECT_TRUE(window.acts_at(kStart + 2s - 1ns));
  EXPECT_FALSE(window.acts_at(kStart + 2s));
}

}  // namespace
}  // namespace rigwire::hil
