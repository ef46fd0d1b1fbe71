// The excavator on tracks as its rig has it, driven by the registers of its valve driver.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>

#include "emulators/valve_driver/valve_driver.h"
#include "hil/configuration/problems.h"
#include "hil/rig/rig_configuration.h"
#include "hil/world/machine_types.h"
#include "hil/world/ports.h"
#include "sim/excavator/excavator.h"

namespace rigwire::hil {
namespace {

namespace registers = emulators::valve_registers;
using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kTrackRigRigFile = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_tracks.yaml";
constexpr const char* kPitFile = RIGWIRE_SOURCE_DIR "/configs/rigs/excavator_pit.yaml";
const std::vector<std::string> kSections{"swing",      "boom",        "stick", "bucket",
                                         "left_track", "right_track", "blade"};

std::string refusal(const char* file, const std::vector<std::string>& sets) {
  try {
    (void)load_rig(file, sets);
    return "";
  } catch (const ConfigurationError& error) {
    return error.what();
  }
}

TEST(TrackRig, ItsDriversRegistersDriveItAndTellOfIt) {
  const LoadedRig rig = load_rig(kTrackRigRigFile, {});
  const auto* model = dynamic_cast<const ExcavatorMachine*>(&*rig.configuration.machine.model);
  ASSERT_NE(model, nullptr);
  const sim::Ground ground;
  sim::Excavator machine(model->excavator, Eigen::Isometry3d::Identity(), &ground);
  emulators::ValveDriverSettings settings;
  settings.amplifier.sections = kSections;
  emulators::ValveDriver driver(settings);
  const ValveSections sections(kSections, machine.actuators());
  const auto write = [&](std::uint16_t address, std::initializer_list<std::uint16_t> values) {
    return driver.unit().write_registers(machine.time(), address,
                                         std::vector<std::uint16_t>(values));
  };
  const auto read = [&](std::uint16_t address) {
    std::array<std::uint16_t, 1> value{};
    EXPECT_FALSE(
        driver.unit().read_registers(protocols::modbus::RegisterTable::input, address, value));
    return static_cast<std::int16_t>(value[0]);
  };
  // Watchdog off, enabled.
  ASSERT_FALSE(write(registers::kWatchdog, {0}));
  ASSERT_FALSE(write(registers::kControl, {1}));
  const auto live = [&](Duration span) {
    for (Duration done{}; done < span; done += 5ms) {
      driver.unit().advance(machine.time());
      ValveCommand block = machine.commanded();
      sections.lay_over(driver.command(), block);
      machine.command(block);
      machine.step(5ms);
      driver.update(sections.of_device(machine.valve_sample(machine.time())));
    }
  };
  const auto x_m = [&] { return machine.link(sim::Link::undercarriage).X_WL.translation().x(); };
  // Both tracks 40 % forward.
  ASSERT_FALSE(write(registers::kSpoolCommand + 4, {400, 400}));
  live(3s);
  EXPECT_GT(x_m(), 1.2);
  EXPECT_NEAR(read(registers::kSpoolPosition + 4), 400, 1);
  EXPECT_NEAR(read(registers::kSpoolPosition + 5), 400, 1);
  // Against each other: it turns left where it stands.
  ASSERT_FALSE(write(registers::kSpoolCommand + 4, {static_cast<std::uint16_t>(-300), 300}));
  live(3s);
  const Eigen::Matrix3d R = machine.link(sim::Link::undercarriage).X_WL.linear();
  EXPECT_GT(std::atan2(R(1, 0), R(0, 0)), 0.3);
  // Stopped, then its blade lifts the front.
  ASSERT_FALSE(write(registers::kSpoolCommand + 4, {0, 0, 600}));
  live(20s);
  EXPECT_GT(machine.link(sim::Link::undercarriage).X_WL.linear()(2, 0), 0.05);
  EXPECT_TRUE(machine.carrier_drives()[0].braked());
  EXPECT_GT(machine.valve_sample(machine.time()).port_a_pressure_pa[6], 3e6);
}

TEST(TrackRig, SectionsOfAMachineThatStandsStillAreRefusedWithThoseThatItHas) {
  EXPECT_THAT(refusal(kPitFile, {"devices.valves.sections=[boom, left_track]"}),
              AllOf(HasSubstr("devices.valves.sections.1"), HasSubstr("left_track"),
                    HasSubstr("allowed swing, boom, stick, bucket")));
  EXPECT_THAT(refusal(kTrackRigRigFile, {"machine.excavator.carrier=fixed"}),
              HasSubstr("left_track"));
  EXPECT_EQ(refusal(kTrackRigRigFile, {"devices.valves.sections=[left_track, right_track]"}), "");
}

TEST(TrackRig, KeysOfTracksThatAreNotThereAreRefused) {
  EXPECT_THAT(refusal(kPitFile, {"machine.excavator.running_gear=tracks"}),
              HasSubstr("it needs carrier: moving"));
  EXPECT_THAT(refusal(kPitFile,
                      {"machine.excavator.carrier=moving", "machine.excavator.tracks.gauge=2.2 m"}),
              HasSubstr("it needs running_gear: tracks"));
}

}  // namespace
}  // namespace rigwire::hil
