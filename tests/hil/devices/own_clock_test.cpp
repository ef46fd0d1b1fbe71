// Devices of a rig's bus live by clocks of their own: their keys, their rates on the wire, and what
// comes from outside at the run's instants.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "hil/configuration/problems.h"
#include "hil/rig/rig.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

/// Frames that the device of that name sent, its boot-up message included.
std::uint64_t frames_of(const Rig& rig, const std::string& name) {
  for (const DeviceReport& report : rig.device_reports()) {
    if (report.name == name) {
      return report.frames;
    }
  }
  return 0;
}

class OwnClockRig : public testing::Test {
 protected:
  /// Two inclinometers that send every 10 ms, with these keys.
  LoadedRig load(const std::string& first, const std::string& second) const {
    const std::string file = (wires_.folder / "rig.yaml").string();
    const auto node = [](int id, const std::string& keys) {
      return "{type: cia410-inclinometer, mount: {link: body}, node_id: " + std::to_string(id) +
             ", starts_itself: true, transmission_type: 255, event_timer: 10 ms, " + keys + "}\n";
    };
    std::ofstream(file) << "scene:\n  terrain: {type: level, size: 60 m, cell: 1 m}\n"
                        << "machine: {include: " << RIGWIRE_SOURCE_DIR
                        << "/configs/machines/gator_855d.yaml}\n"
                        << "buses:\n  can: {wire: slcan, path: " << wires_.can() << "}\n"
                        << "devices:\n  first: " << node(10, first)
                        << "  second: " << node(11, second);
    return load_rig(file, {});
  }

  rigwire::test::PrivateWires wires_;
};

TEST_F(OwnClockRig, RatesOnTheWireAreThoseOfEachNodesClock) {
  const LoadedRig loaded = load("clock: {tolerance: 0 ppm, error: 1000 ppm}",
                                "clock: {tolerance: 0 ppm, error: -1000 ppm}");
  boost::asio::io_context io;
  Rig rig(loaded.configuration, io, {});
  const RunOutcome outcome = rig.executive().run_free(kStart + 10'205ms);
  ASSERT_FALSE(outcome.fault.has_value()) << *outcome.fault;
  // 10 s after the boot-up at 200 ms: 1000 periods of 10 ms, one more and one less, and both their
  // ends.
  EXPECT_EQ(frames_of(rig, "first"), 1003U);
  EXPECT_EQ(frames_of(rig, "second"), 1001U);
}

TEST_F(OwnClockRig, SupplyFailsAtTheRunsInstant) {
  const LoadedRig loaded = load(
      "clock: {tolerance: 0 ppm, error: 1000 ppm}, faults: [{type: off, at: 5.009 s, for: 0.5 s}]",
      "clock: {tolerance: 0 ppm, jitter: 0 s}, faults: [{type: off, at: 5.009 s, for: 0.5 s}]");
  boost::asio::io_context io;
  Rig rig(loaded.configuration, io, {});
  const RunOutcome outcome = rig.executive().run_free(kStart + 5'400ms);
  ASSERT_FALSE(outcome.fault.has_value()) << *outcome.fault;
  // From the boot-up at 200 ms each 10 ms; the fast clock shows 5.014 s when the supply fails.
  EXPECT_EQ(frames_of(rig, "second"), 482U);
  EXPECT_EQ(frames_of(rig, "first"), 483U);
}

TEST_F(OwnClockRig, KeysOfAClockAreChecked) {
  const auto complaint = [&](const std::string& clock) -> std::string {
    try {
      (void)load("clock: " + clock, "serial: 1");
      return "";
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(complaint("{tolerance: 20 ppm, error: -3 ppm, jitter: 1 ms}"), "");
  EXPECT_THAT(complaint("{tolerance: 1100 ppm}"), HasSubstr("devices.first.clock.tolerance"));
  EXPECT_THAT(complaint("{error: -1100 ppm}"), HasSubstr("devices.first.clock.error"));
  EXPECT_THAT(complaint("{jitter: 11 ms}"), HasSubstr("devices.first.clock.jitter"));
  EXPECT_THAT(complaint("{ppm: 1}"), HasSubstr("ppm"));
}

}  // namespace
}  // namespace rigwire::hil
