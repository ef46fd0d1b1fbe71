// DBC files of others: what is read of them, and what is said of those that are none.
#include "protocols/dbc/dbc_reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "protocols/dbc/dbc_writer.h"

namespace rigwire::protocols::dbc {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr std::string_view kFile = R"dbc(VERSION "1"
NS_ :
	CM_
	BA_DEF_
BS_:
BU_: SENSOR ECU
VAL_TABLE_ OnOff 1 "On" 0 "Off" ;

BO_ 100 Angles: 8 SENSOR
 SG_ Angle : 7|16@0- (0.01,-5) [-180|180] "deg" ECU,SENSOR
 SG_ Mode : 16|4@1+ (1,0) [0|0] "" ECU
BO_ 2364540158 EEC1: 8 Vector__XXX
 SG_ Speed : 24|16@1+ (0.125,0) [0|8031.875] "rpm"  Vector__XXX
BO_ 200 Pages: 8 SENSOR
 SG_ Page M : 0|4@1+ (1,0) [0|15] "" ECU
 SG_ First m0 : 8|32@1- (1,0) [0|0] "" ECU
 SG_ Second m1 : 8|16@1+ (1,0) [0|0] "" ECU
 SG_ Third m2 : 8|16@1+ (1,0) [0|0] "" ECU

BO_TX_BU_ 200 : SENSOR,ECU;
CM_ SG_ 100 Angle "Of the
arm";
CM_ BO_ 100 "Two angles";
BA_DEF_ BO_  "GenMsgCycleTime" INT 0 65535;
BA_DEF_ BO_  "GenMsgSendType" ENUM  "Cyclic","OnChange";
BA_DEF_ BO_  "VFrameFormat" ENUM  "StandardCAN","ExtendedCAN","reserved","J1939PG";
BA_DEF_ SG_  "GenSigStartValue" FLOAT -1000 1000;
BA_DEF_DEF_  "GenMsgCycleTime" 50;
BA_DEF_DEF_  "GenMsgSendType" "Cyclic";
BA_DEF_DEF_  "VFrameFormat" "StandardCAN";
BA_ "GenMsgCycleTime" BO_ 100 20;
BA_ "GenMsgSendType" BO_ 100 1;
BA_ "VFrameFormat" BO_ 2364540158 3;
BA_ "GenSigStartValue" SG_ 100 Mode 3;
BA_ "SystemSignalLongSymbol" SG_ 200 Third "ANameOfMoreThanThirtyTwoCharacters";
VAL_ 100 Mode 3 "Measuring" 15 "Defective" ;
SIG_VALTYPE_ 200 First : 1;
SG_MUL_VAL_ 200 Third Page 2-2, 5-7;
)dbc";

TEST(DbcReader, TakesMessagesSignalsAndWhatIsSaidOfThem) {
  const Reading reading = read(kFile);
  ASSERT_TRUE(reading.findings.empty()) << reading.findings[0].line << reading.findings[0].what;
  EXPECT_THAT(reading.content.nodes, ElementsAre("SENSOR", "ECU"));
  const FileMessage* const angles = reading.content.find("Angles");
  ASSERT_NE(angles, nullptr);
  EXPECT_EQ(angles->layout.id, 100U);
  EXPECT_FALSE(angles->layout.extended);
  EXPECT_EQ(angles->period_ms, 20.0);
  EXPECT_EQ(angles->send_type, "OnChange");
  EXPECT_EQ(angles->layout.text, "Two angles");
  const can::OwnedSignal& angle = angles->layout.signals.at(0);
  EXPECT_EQ(angle.order, can::ByteOrder::big_endian);
  EXPECT_TRUE(angle.is_signed);
  EXPECT_EQ(angle.text, "Of the\narm");
  // 0x1234 from bit 7 on: bytes 12 34.
  const std::array<std::uint8_t, 8> bytes{0x12, 0x34};
  EXPECT_NEAR(can::get(angle, bytes).value, 0x1234 * 0.01 - 5.0, 1e-9);
  const can::OwnedSignal& mode = angles->layout.signals.at(1);
  EXPECT_EQ(mode.upper, 15.0) << "no limits: what the bits carry";
  EXPECT_EQ(angles->signals.at(1).start_value, 3.0);
  ASSERT_EQ(mode.values.size(), 2U);
  EXPECT_EQ(mode.values[1].text, "Defective");
}

TEST(DbcReader, J1939MessagesReserveTheirPatterns) {
  const Reading reading = read(kFile);
  const FileMessage* const engine = reading.content.find("EEC1");
  ASSERT_NE(engine, nullptr);
  EXPECT_TRUE(engine->layout.j1939);
  EXPECT_TRUE(engine->senders.empty());
  EXPECT_EQ(engine->layout.fill, 0xFF);
  EXPECT_EQ(engine->period_ms, 50.0) << "the default of the file";
  const std::array<std::uint8_t, 8> bytes{0, 0, 0, 0xFF, 0xFF};
  EXPECT_FALSE(can::get(engine->layout.signals.at(0), bytes).valid());
}

TEST(DbcReader, PagesFloatsFurtherSendersAndLongNames) {
  const Reading reading = read(kFile);
  const FileMessage* const pages = reading.content.find("Pages");
  ASSERT_NE(pages, nullptr);
  EXPECT_THAT(pages->senders, ElementsAre("SENSOR", "ECU"));
  EXPECT_TRUE(pages->layout.signals.at(1).is_float);
  EXPECT_EQ(pages->layout.signals.at(3).name, "ANameOfMoreThanThirtyTwoCharacters");
  const std::array<std::uint8_t, 8> sixth{6};
  EXPECT_TRUE(can::is_present(pages->layout, 3, sixth));
  EXPECT_FALSE(can::is_present(pages->layout, 2, sixth));
  EXPECT_FALSE(can::is_present(pages->layout, 1, sixth));
}

TEST(DbcReader, ReadsWhatTheWriterWrites) {
  const FileContent content = read(kFile).content;
  std::vector<can::OwnedMessage> messages;
  for (const FileMessage& message : content.messages) {
    messages.push_back(message.layout);
  }
  const Reading again = read(write({"can", 250'000, messages}));
  ASSERT_TRUE(again.findings.empty()) << again.findings[0].what;
  ASSERT_EQ(again.content.messages.size(), messages.size());
  for (const can::OwnedMessage& message : messages) {
    const FileMessage* const found = again.content.find(message.name);
    ASSERT_NE(found, nullptr) << message.name;
    EXPECT_EQ(found->layout.id, message.id);
    EXPECT_EQ(found->layout.j1939, message.j1939);
    ASSERT_EQ(found->layout.signals.size(), message.signals.size());
    for (std::size_t i = 0; i < message.signals.size(); ++i) {
      const can::OwnedSignal& a = message.signals[i];
      const can::OwnedSignal& b = found->layout.signals[i];
      EXPECT_EQ(std::tie(a.bit, a.width, a.order, a.is_signed, a.is_float, a.scale, a.offset),
                std::tie(b.bit, b.width, b.order, b.is_signed, b.is_float, b.scale, b.offset))
          << a.name;
      EXPECT_EQ(a.multiplexor, b.multiplexor) << a.name;
    }
  }
}

TEST(DbcReader, UnitsOfAnOldTextEncodingAreTakenAsLatin1) {
  const Reading reading = read(
      "BU_:\nBO_ 1 A: 1 Vector__XXX\n SG_ T : 0|8@1+ (1,0) [0|0] \"\xB0"
      "C\" Vector__XXX\n");
  ASSERT_EQ(reading.content.messages.size(), 1U);
  EXPECT_EQ(reading.content.messages[0].layout.signals.at(0).unit, "\u00b0C");
}

struct Wrong {
  const char* text;
  int line;
  const char* what;
};

TEST(DbcReader, AMissingSemicolonLosesNoMessage) {
  const Reading reading = read(R"dbc(BU_: RADAR
CM_ "Front target"
BO_ 1664 Front: 8 RADAR
 SG_ Distance : 7|13@1+ (0.03,0) [0|255] "m" ECU
CM_ BU_ RADAR "In the middle"
BO_ 1665 Left: 8 RADAR
BA_ "GenMsgCycleTime" BO_ 1665 20
BO_ 1666 Right: 8 RADAR
)dbc");
  EXPECT_TRUE(reading.findings.empty());
  ASSERT_EQ(reading.content.messages.size(), 3U);
  EXPECT_EQ(reading.content.messages[0].signals.size(), 1U);
  EXPECT_EQ(reading.content.messages[1].period_ms, 20);
}

TEST(DbcReader, CommentsOfProgramsAreSpaceAndNoStatementNeedsItsSemicolon) {
  const Reading reading = read(R"(// Pump, second edition.
VERSION "" // none
BS_:
BU_: PUMP ECU // two nodes
/* several
   lines */
BO_ 257 Alarms: 8 PUMP
 SG_ Alarm : 0|8@1+ (1,0) [0|255] "//" ECU /* of the pump */
 SG_ Mode : 8|8@1+ (1,0) [0|3] "" ECU
BO_TX_BU_ 257 : PUMP,ECU
EV_ Lamp: 0 [0|1] "" 0 1 DUMMY_NODE_VECTOR0 ECU
VAL_TABLE_ States 0 "Off" 1 "On"
SIG_VALTYPE_ 257 Mode : 0
BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535
BA_DEF_DEF_ "GenMsgCycleTime" 50
BA_ "BusType" "CAN"
BA_ "NodeLayer" BU_ PUMP 1
BA_ "GenMsgCycleTime" BO_ 257 100
VAL_ Lamp 0 "Off"
VAL_ 257 Mode 0 "Off" 1 "On"
VAL_ 257 Alarm 0 "None")");
  EXPECT_THAT(reading.findings, testing::IsEmpty())
      << reading.findings.front().line << ": " << reading.findings.front().what;
  ASSERT_EQ(reading.content.messages.size(), 1U);
  const FileMessage& message = reading.content.messages.front();
  EXPECT_EQ(message.period_ms, 100.0);
  EXPECT_EQ(message.senders, (std::vector<std::string>{"PUMP", "ECU"}));
  ASSERT_EQ(message.layout.signals.size(), 2U);
  EXPECT_EQ(message.layout.signals[0].unit, "//");
  EXPECT_EQ(message.layout.signals[0].values.size(), 1U);
  EXPECT_EQ(message.layout.signals[1].values.size(), 2U);
}

TEST(DbcReader, SendTypesOfAllMakersAreUnderstood) {
  const auto flags = [](std::string_view word) {
    const SendType type = send_type(word);
    return std::string(type.by_time ? "t" : "") + (type.on_change ? "c" : "") +
           (type.on_request ? "r" : "");
  };
  for (const auto& [word, meaning] :
       std::vector<std::pair<std::string_view, std::string>>{{"Cyclic", "t"},
                                                             {"cyclicX", "t"},
                                                             {"cyclicIfActive", "t"},
                                                             {"CyclicAndSpontanX", "tc"},
                                                             {"spontanX", "c"},
                                                             {"OnChange", "c"},
                                                             {"OnWrite", "c"},
                                                             {"FixedPeriodic", "t"},
                                                             {"EnabledPeriodic", "t"},
                                                             {"EventPeriodic", "tc"},
                                                             {"Event", "c"},
                                                             {"Periodic", "t"},
                                                             {"Acyclic", "c"},
                                                             {"on request", "r"},
                                                             {"NoMsgSendType", ""},
                                                             {"NotUsed", ""},
                                                             {"", ""}}) {
    EXPECT_EQ(flags(word), meaning) << word;
  }
}

TEST(DbcReader, WhatIsWrongIsSaidWithItsPlace) {
  const std::array cases{
      Wrong{"", 1, "no DBC file"},
      Wrong{"hello", 1, "no statement"},
      Wrong{"BU_:\nBO_ 2048 A: 8 X\n", 2, "no CAN identifier"},
      Wrong{"BU_:\nBO_ 1 A: 8 X\nBO_ 1 B: 8 X\n", 3, "second message"},
      Wrong{"BU_:\n SG_ A : 0|8@1+ (1,0) [0|0] \"\" X\n", 2, "without a message"},
      Wrong{"BU_:\nBO_ 1 A: 8 X\n SG_ A : 0|0@1+ (1,0) [0|0] \"\" X\n", 3, "without bits"},
      Wrong{"BU_:\nBO_ 1 A: 8 X\n SG_ A : 0|8@2+ (1,0) [0|0] \"\" X\n", 3, "whole number"},
      Wrong{"BU_:\nBO_ 1 A: 8 X\n SG_ A : 0|8@1+ (0,0) [0|0] \"\" X\n", 3, "factor of 0"},
      Wrong{"BU_:\nBO_ 1 A: 8 X\n SG_ A : 0|8@1+ (x,0) [0|0] \"\" X\n", 3, "no number"},
      Wrong{"BU_:\nBO_ 1 A: 8 X\n SG_ A n1 : 0|8@1+ (1,0) [0|0] \"\" X\n", 3, "multiplexing"},
      Wrong{"BU_:\nCM_ BO_ 1 \"never closed\n", 2, "something else"},
      Wrong{"BU_:\nBO_ 1 A: 99999 X\n", 2, "whole number"}};
  for (const Wrong& wrong : cases) {
    const Reading reading = read(wrong.text);
    ASSERT_FALSE(reading.findings.empty()) << wrong.text;
    EXPECT_EQ(reading.findings[0].line, wrong.line) << wrong.text;
    EXPECT_THAT(reading.findings[0].what, HasSubstr(wrong.what)) << wrong.text;
  }
}

TEST(DbcReader, WhatCannotBeCodedIsAFaultOfItsUserAlone) {
  const Reading reading = read(
      "BU_:\nBO_ 1 A: 2 X\n SG_ In : 0|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ Over : 4|8@1+ (1,0) [0|0] \"\" X\n SG_ Out : 10|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ Page m1 : 0|4@1+ (1,0) [0|0] \"\" X\nBO_ 2 B: 64 X\n");
  ASSERT_TRUE(reading.findings.empty());
  const FileMessage& message = reading.content.messages.at(0);
  const auto faults = [&](std::vector<std::string_view> used) {
    std::string all;
    for (const Finding& finding : faults_of(message, used)) {
      all += std::to_string(finding.line) + ": " + finding.what + "\n";
    }
    return all;
  };
  EXPECT_EQ(faults({"In"}), "");
  EXPECT_EQ(faults({"In", "Over"}), "4: Over lies on In\n");
  EXPECT_THAT(faults({"Out"}), HasSubstr("5: Out: the signal does not lie within"));
  EXPECT_EQ(faults({"Page"}), "6: Page has no multiplexor\n");
  EXPECT_THAT(faults_of(reading.content.messages.at(1), {}).at(0).what, HasSubstr("longer"));
}

}  // namespace
}  // namespace rigwire::protocols::dbc
