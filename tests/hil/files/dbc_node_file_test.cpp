// A user's own CAN device: what its two files say together, and what is said of their slips.
#include "hil/files/dbc_node_file.h"
#include "hil/files/dbc_node_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "hil/configuration/problems.h"
#include "private_wires.h"

namespace rigwire::hil {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kDbc = R"dbc(BU_: SENSOR ECU
BO_ 100 Angles: 8 SENSOR
 SG_ Angle : 0|16@1- (0.01,0) [-300|300] "deg" ECU
 SG_ Mode : 16|4@1+ (1,0) [0|15] "" ECU
 SG_ Check : 56|8@1+ (1,0) [0|255] "" ECU
 SG_ Over : 8|16@1+ (1,0) [0|65535] "furlong" ECU
BO_ 101 Silent: 8 SENSOR
 SG_ A : 0|8@1+ (1,0) [0|255] "" ECU
BO_ 200 Set: 8 ECU
 SG_ Opening : 0|16@1- (0.1,0) [-100|100] "%" SENSOR
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 1000;
BA_DEF_DEF_ "GenMsgCycleTime" 0;
BA_ "GenMsgCycleTime" BO_ 100 20;
VAL_ 100 Mode 3 "Measuring" ;
)dbc";

class DbcNodeFile : public testing::Test {
 protected:
  DbcNodeFile() { write("node.dbc", kDbc); }
  void write(const std::string& name, const std::string& text) {
    std::ofstream(wires_.folder / name) << text;
  }
  DbcNodeDescription load(const std::string& binding) {
    write("node.yaml", "dbc: node.dbc\n" + binding);
    return load_dbc_node((wires_.folder / "node.yaml").string());
  }
  std::string complaints(const std::string& binding) {
    try {
      (void)load(binding);
    } catch (const ConfigurationError& error) {
      return error.what();
    }
    return "";
  }
  rigwire::test::PrivateWires wires_;
};

TEST_F(DbcNodeFile, TheDbcFileAloneMakesANodeOfStartValues) {
  const DbcNodeDescription device = load("node: SENSOR\n");
  ASSERT_EQ(device.settings.sent.size(), 2U);
  EXPECT_EQ(device.settings.sent[0].period, 20ms);
  EXPECT_TRUE(device.settings.sent[1].on_request) << "it does not say when";
  EXPECT_EQ(device.attachment, "nothing");
}

TEST_F(DbcNodeFile, SignalsAreBoundInTheirOwnUnits) {
  const DbcNodeDescription device = load(
      "node: SENSOR\n"
      "sends:\n"
      "  - message: Angles\n"
      "    signals: [{signal: Angle, quantity: joint.angle, factor: -1},\n"
      "              {signal: Mode, value: Measuring}]\n");
  EXPECT_EQ(device.attachment, "joint");
  const auto& shows = device.settings.sent.at(0).shows;
  const auto* angle = std::get_if<emulators::DbcMeasured>(&shows.at(0).source);
  ASSERT_NE(angle, nullptr);
  EXPECT_NEAR(angle->factor, -57.29577951308232, 1e-12);
  EXPECT_EQ(shows.at(1).start_raw, 3U);
}

TEST_F(DbcNodeFile, ALayoutThatTheFileLacksIsSaidInTheBinding) {
  const DbcNodeDescription device = load(
      "sends:\n"
      "  - message: Silent\n"
      "    period: 100 ms\n"
      "    signals: [{signal: A, quantity: joint.rate, layout: {scale: 0.5, offset: -64, unit: "
      "deg/s}}]\n");
  ASSERT_EQ(device.settings.sent.size(), 1U) << "without a node only what is listed";
  const auto& row = device.settings.sent[0].layout.signals.at(0);
  EXPECT_EQ(row.lower, -64.0);
  EXPECT_EQ(row.upper, 63.5);
  EXPECT_EQ(row.unit, "deg/s");
}

TEST_F(DbcNodeFile, SetPointsHaveSafeValuesInTheirOwnUnit) {
  const DbcNodeDescription device = load(
      "takes: [{message: Set, signals: [{signal: Opening, moves: valves.opening_3, safe: -5 "
      "%}]}]\n");
  EXPECT_EQ(device.attachment, "valves");
  const auto* move = std::get_if<emulators::DbcMove>(&device.settings.taken.at(0).uses.at(0));
  ASSERT_NE(move, nullptr);
  EXPECT_NEAR(move->factor, 0.01, 1e-15);
  EXPECT_NEAR(move->safe, -0.05, 1e-15);
}

TEST_F(DbcNodeFile, SlipsAreNamedWithTheirPlaceAndTheNearestWord) {
  const auto one = [this](const std::string& signal) {
    return complaints("node: SENSOR\nsends: [{message: Angles, signals: [{" + signal + "}]}]\n");
  };
  EXPECT_THAT(one("signal: Angel, quantity: joint.angle"),
              AllOf(HasSubstr("sends.0.signals.0.signal"), HasSubstr("did you mean Angle")));
  EXPECT_THAT(
      one("signal: Angle, quantity: joint.angel"),
      AllOf(HasSubstr("sends.0.signals.0.quantity"), HasSubstr("did you mean joint.angle")));
  EXPECT_THAT(one("signal: Over, quantity: joint.angle"), HasSubstr("rad, mrad, deg"));
  EXPECT_THAT(one("signal: Mode, value: Measurin"), HasSubstr("did you mean Measuring"));
  EXPECT_THAT(one("signal: Mode, value: 16"), HasSubstr("0 .. 15"));
  EXPECT_THAT(one("signal: Mode, checksum: xor8"), HasSubstr("a byte of its own"));
  EXPECT_THAT(one("signal: Mode, counter: true, value: 3"), HasSubstr("one source"));
  EXPECT_THAT(one("signal: Mode, factor: 2"), HasSubstr("it shows no quantity"));
  EXPECT_THAT(one("signal: Mode, echo: Set.Opening"), HasSubstr("sends.0.signals.0.echo"));
  EXPECT_THAT(complaints("node: SENSR\n"),
              AllOf(HasSubstr("no such node"), HasSubstr("did you mean SENSOR")));
  EXPECT_THAT(complaints("node: SENSOR\nsends: [{message: Angle}]\n"),
              HasSubstr("did you mean Angles"));
  EXPECT_THAT(complaints("sends: [{message: Silent}]\n"), HasSubstr("when it is sent"));
  EXPECT_THAT(complaints("sends: [{message: Silent, send: cyclic}]\n"), HasSubstr("how often"));
  EXPECT_THAT(complaints("sends: [{message: Silent, send: on_request, period: 1 s}]\n"),
              HasSubstr("not sent by time"));
  EXPECT_THAT(complaints("sends: [{message: Angles, priority: 3}]\n"), HasSubstr("none of J1939"));
  EXPECT_THAT(complaints("text: nothing at all\n"), HasSubstr("sends and takes nothing"));
  EXPECT_THAT(complaints("node: SENSOR\nserial: 3\n"), HasSubstr("claims no address"));
  EXPECT_THAT(
      complaints(
          "takes: [{message: Set, signals: [{signal: Opening, moves: valves.opening_3, safe: "
          "5 bar}]}]\n"),
      HasSubstr("takes.0.signals.0.safe"));
}

TEST_F(DbcNodeFile, ADeviceIsAttachedToOneThing) {
  EXPECT_THAT(complaints("node: SENSOR\n"
                         "sends: [{message: Angles, signals: [{signal: Angle, quantity: "
                         "joint.angle}, {signal: Mode, quantity: vehicle.gear}]}]\n"),
              HasSubstr("this one to joint"));
}

TEST_F(DbcNodeFile, SignalsThatAreUsedMayNotLieOnEachOther) {
  EXPECT_THAT(complaints("node: SENSOR\n"
                         "sends: [{message: Angles, signals: [{signal: Angle, quantity: "
                         "joint.angle}, {signal: Over, value: 3}]}]\n"),
              AllOf(HasSubstr("node.dbc:6"), HasSubstr("Over lies on Angle")));
}

TEST_F(DbcNodeFile, ALongMessageWantsAnAddress) {
  write("node.dbc",
        "BU_: A\nBO_ 2566842112 Long: 20 A\n SG_ S : 0|8@1+ (1,0) [0|0] \"\" A\n"
        "BA_DEF_ BO_ \"VFrameFormat\" ENUM \"J1939PG\";\nBA_ \"VFrameFormat\" BO_ 2566842112 0;\n");
  EXPECT_THAT(complaints("node: A\n"), HasSubstr("claims no address"));
  EXPECT_EQ(complaints("node: A\nclaims_address: true\n"), "");
}

TEST_F(DbcNodeFile, WhatIsNoDbcIsNamedWithItsLine) {
  write("node.dbc", "BU_: A\nBO_ 1 M: 8 A\n SG_ S : 0|8@1+ (1;0) [0|0] \"\" A\n");
  EXPECT_THAT(complaints("node: A\n"), AllOf(HasSubstr("node.dbc:3:"), HasSubstr("expected here")));
}

TEST_F(DbcNodeFile, TheShippedOnesAreGood) {
  for (const char* name : {"slope_sensor", "valve_block"}) {
    const DbcNodeDescription device =
        load_dbc_node(std::string(RIGWIRE_SOURCE_DIR "/configs/can/") + name + ".yaml");
    EXPECT_FALSE(device.settings.sent.empty()) << name;
    EXPECT_THAT(markdown_table(device), HasSubstr("` | 0x")) << name << ": its identifiers";
    EXPECT_THAT(markdown_table(device), HasSubstr("| `")) << name;
  }
}

}  // namespace
}  // namespace rigwire::hil
