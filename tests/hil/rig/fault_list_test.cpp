// The list of faults of a whole rig: what it has acts as if the device's own list had it, and what
// it cannot have is told with its place.
#include "hil/rig/fault_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "hil/rig/rig.h"
#include "hil/rig/rig_configuration.h"

namespace rigwire::hil {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::SizeIs;

class FaultList : public testing::Test {
 protected:
  FaultList()
      : folder_(fs::path(testing::TempDir()) /
                testing::UnitTest::GetInstance()->current_test_info()->name()) {
    fs::create_directories(folder_);
  }
  ~FaultList() override { fs::remove_all(folder_); }

  /// The rig of satellite receivers without faults of its own, with that text behind it.
  LoadedRig load(const std::string& text) {
    const fs::path file = folder_ / "rig.yaml";
    std::ofstream(file) << "include: " RIGWIRE_SOURCE_DIR "/tests/hil/streams/gnss.yaml\n"
                        << "devices:\n  gnss: {faults: []}\n  starfire: {faults: []}\n"
                        << text;
    return load_rig(file.string(), {});
  }
  std::string complaint(const std::string& text) {
    try {
      static_cast<void>(load(text));
      return {};
    } catch (const ConfigurationError& error) {
      return error.what();
    }
  }

 private:
  fs::path folder_;
};

TEST_F(FaultList, OfTheRigAndOfTheDeviceAreTheSame) {
  const LoadedRig of_rig =
      load("faults:\n  - {on: gnss, type: jamming, at: 2 s, for: 3 s, loss: 30 dB}\n");
  const LoadedRig of_device =
      load_rig(RIGWIRE_SOURCE_DIR "/tests/hil/streams/gnss.yaml",
               {"devices.gnss.faults=[{type: jamming, at: 2 s, for: 3 s, loss: 30 dB}]",
                "devices.starfire.faults=[]"});
  EXPECT_EQ(config_hash(of_rig.configuration), config_hash(of_device.configuration));
}

TEST_F(FaultList, TheSkyIsThatOfEveryAntenna) {
  const auto windows =
      fault_windows(load("faults: [{on: sky, type: outage, at: 2 s, until: 4 s}]\n").configuration);
  ASSERT_THAT(windows, SizeIs(2));
  EXPECT_THAT(windows, Contains(FaultWindow{"gnss",
                                            "outage",
                                            kStart + std::chrono::seconds{2},
                                            kStart + std::chrono::seconds{4},
                                            {}}));
  EXPECT_THAT(windows, Contains(FaultWindow{"starfire",
                                            "outage",
                                            kStart + std::chrono::seconds{2},
                                            kStart + std::chrono::seconds{4},
                                            {}}));
}

TEST_F(FaultList, ABusIsATargetAndKnowsItsNodes) {
  EXPECT_EQ(complaint("faults: [{on: bus can, type: unplugged, device: starfire}]\n"), "");
  EXPECT_THAT(complaint("faults: [{on: bus can, type: unplugged, device: nobody}]\n"),
              HasSubstr("nobody"));
}

TEST_F(FaultList, WhatHasNoFaultsIsToldWithItsPlaceAndWhatThereIs) {
  EXPECT_THAT(complaint("faults:\n  - {type: jamming, on: gns}\n"),
              AllOf(HasSubstr("rig.yaml:6:25"), HasSubstr("faults.0.on"),
                    HasSubstr("gnss, starfire, bus can"), HasSubstr("did you mean gnss?")));
  EXPECT_THAT(complaint("faults:\n  - {type: jamming}\n"), HasSubstr("faults.0.on: missing key"));
  EXPECT_THAT(complaint("faults: jamming\n"), HasSubstr("wrong kind of value"));
  EXPECT_THAT(complaint("faults: [jamming]\n"), HasSubstr("wrong kind of value"));
}

/// The fourth of the list is the second of its bus and the first of its device.
TEST_F(FaultList, AnErrorNamesTheNumberInTheListThatWasWritten) {
  const std::string three =
      "faults:\n"
      "  - {on: bus can, type: short, at: 1 s, for: 1 s}\n"
      "  - {on: starfire, type: outage, at: 1 s, for: 1 s}\n"
      "  - {on: starfire, type: outage, at: 3 s, for: 1 s}\n";
  EXPECT_EQ(complaint(three), "");
  EXPECT_THAT(complaint(three + "  - {on: bus can, type: unplugged, device: nobody}\n"),
              AllOf(HasSubstr("rig.yaml:9:"), HasSubstr(": faults.3"),
                    testing::Not(HasSubstr("buses.can"))));
  EXPECT_THAT(complaint(three + "  - {on: gnss, type: jamming, loss: 3 m}\n"),
              AllOf(HasSubstr("rig.yaml:9:"), HasSubstr(": faults.3.loss"),
                    testing::Not(HasSubstr("devices"))));
  // One that is of two devices is complained of once.
  const std::string twice = complaint("faults: [{on: sky, type: jamming, loss: 3 m}]\n");
  EXPECT_EQ(twice.find("faults.0.loss"), twice.rfind("faults.0.loss")) << twice;
}

TEST_F(FaultList, AnImpossiblePairIsToldWithWhatTheTargetCanHave) {
  EXPECT_THAT(complaint("faults:\n  - {on: starfire, type: frozen}\n"),
              AllOf(HasSubstr("rig.yaml:6:26"), HasSubstr("unknown type"), HasSubstr("frozen"),
                    HasSubstr("jamming")));
}

TEST_F(FaultList, AQuantityThatTheMachineDoesNotHaveIsToldBeforeTheRun) {
  const LoadedRig rig =
      load("faults:\n  - {on: gnss, type: outage, when: {quantity: warp, value: 3}}\n");
  try {
    check_start(rig);
    FAIL() << "accepted";
  } catch (const ConfigurationError& error) {
    EXPECT_THAT(std::string(error.what()),
                AllOf(HasSubstr("rig.yaml:6:47"), HasSubstr(": faults.0.when.quantity"),
                      HasSubstr("allowed")));
  }
}

struct Contradiction {
  const char* name;
  const char* keys;
  const char* key;   ///< Key that the message names.
  const char* said;  ///< Some of what is said.
};
void PrintTo(const Contradiction& one, std::ostream* out) {
  *out << one.keys;
}

class FaultListContradiction : public FaultList,
                               public testing::WithParamInterface<Contradiction> {};

TEST_P(FaultListContradiction, IsRefusedAtItsLine) {
  const Contradiction& one = GetParam();
  EXPECT_THAT(complaint("faults:\n  - {on: gnss, type: outage, " + std::string(one.keys) + "}\n"),
              AllOf(HasSubstr("rig.yaml:6:"), HasSubstr(std::string(": faults.0.") + one.key + ":"),
                    HasSubstr(one.said)));
}

INSTANTIATE_TEST_SUITE_P(
    , FaultListContradiction,
    testing::Values(
        Contradiction{"two_ends", "at: 1 s, for: 2 s, until: 3 s", "until", "two ends"},
        Contradiction{"over_before", "at: 4 s, until: 3 s", "until", "over before it begins"},
        Contradiction{"duty_of_one", "at: 1 s, duty: 20 %", "duty", "nothing is repeated"},
        Contradiction{"endless_repetition", "at: 1 s, every: 2 s", "for", "no length"},
        Contradiction{"overlapping", "at: 1 s, every: 2 s, for: 3 s", "for", "no length"},
        Contradiction{"two_ends_of_all", "every: 2 s, duty: 10 %, for: 9 s, until: 20 s", "until",
                      "two ends"},
        Contradiction{"too_often", "every: 1 us, duty: 10 %", "every", "1 ms"},
        Contradiction{"never", "probability: 0 %", "probability", "out of range"},
        Contradiction{"no_magnitude", "at: 1 s, for: 2 s, ramp: 1 s", "ramp", "unknown key"},
        Contradiction{"no_such_condition", "when: {quantity: boom, over: 3}", "when.over",
                      "unknown key"}),
    [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace rigwire::hil
