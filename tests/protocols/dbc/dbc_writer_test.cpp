#include "protocols/dbc/dbc_writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "protocols/vehicle/engine.h"
#include "protocols/vehicle/message.h"
#include "protocols/vehicle/steering.h"

namespace rigwire::protocols::dbc {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string written(const std::vector<can::OwnedMessage>& messages) {
  return write({"field", 250'000, messages});
}

TEST(DbcWriter, EngineMessageByHand) {
  const auto text =
      written({vehicle::layout<vehicle::Eec2>({"gateway", 0x27, j1939::kGlobalAddress})});
  // 0x0CF00327 with bit 31 set.
  EXPECT_THAT(text, HasSubstr("BU_: gateway\n"));
  EXPECT_THAT(text, HasSubstr("BO_ 2364539687 eec2: 8 gateway\n"
                              " SG_ accelerator_pedal_position : 8|8@1+ (0.004,0) [0|1] \"\" "
                              "Vector__XXX\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"VFrameFormat\" BO_ 2364539687 3;\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"GenMsgCycleTime\" BO_ 2364539687 50;\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"SPN\" SG_ 2364539687 accelerator_pedal_position 91;\n"));
  EXPECT_THAT(text, HasSubstr("VAL_ 2364539687 accelerator_pedal_position 254 \"error\" 255 \"not "
                              "available\" ;\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"NmStationAddress\" BU_ gateway 39;\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"ProtocolType\" \"J1939\";\n"));
}

TEST(DbcWriter, OppositeSignOnTheWireIsANegativeScale) {
  const auto text = written({vehicle::layout<vehicle::GuidanceCommand>({})});
  EXPECT_THAT(text, HasSubstr(" SG_ curvature_command : 0|16@1+ (-0.00025,8.032) ["));
  EXPECT_THAT(text, HasSubstr("curvature_command_status"));
  EXPECT_THAT(text, HasSubstr(": 8 Vector__XXX\n"));
}

TEST(DbcWriter, DocumentsUnitsAndSignsWhereTheyAreAskedFor) {
  const std::vector<can::OwnedMessage> messages{vehicle::layout<vehicle::Eec1>({}),
                                                vehicle::layout<vehicle::GuidanceCommand>({})};
  const auto text = write({"field", 250'000, messages}, Units::document);
  EXPECT_THAT(text, HasSubstr(" SG_ engine_speed : 24|16@1+ (0.125,0) [0|8031.875] \"rpm\" "));
  EXPECT_THAT(text, HasSubstr(" SG_ actual_torque : 16|8@1+ (1,-125) [-125|125] \"%\" "));
  EXPECT_THAT(text,
              HasSubstr(" SG_ curvature_command : 0|16@1+ (0.25,-8032) [-8032|8031.75] \"1/km\" "));
}

can::OwnedMessage message(std::string name, std::uint32_t id, std::string sender = "imu") {
  can::OwnedMessage layout;
  layout.name = std::move(name);
  layout.id = id;
  layout.sender = std::move(sender);
  return layout;
}

TEST(DbcWriter, BigEndianSignalsBeginWithTheirMostSignificantBit) {
  can::OwnedMessage layout = message("rate", 0x32);
  can::OwnedSignal signal;
  signal.name = "x";
  signal.bit = 7;  // of the first byte
  signal.width = 16;
  signal.order = can::ByteOrder::big_endian;
  signal.is_signed = true;
  layout.signals = {signal};
  signal.name = "y";
  signal.bit = 23;  // upper half of the third byte, four bits
  signal.width = 4;
  layout.signals.push_back(signal);
  const auto text = written({layout});
  EXPECT_THAT(text, HasSubstr(" SG_ x : 7|16@0- "));
  EXPECT_THAT(text, HasSubstr(" SG_ y : 23|4@0- "));
  EXPECT_THAT(text, HasSubstr("BO_ 50 rate: 8 imu\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"VFrameFormat\" BO_ 50 0;\n"));
}

can::OwnedSignal signal(std::string name, std::uint16_t bit) {
  can::OwnedSignal row;
  row.name = std::move(name);
  row.bit = bit;
  return row;
}

TEST(DbcWriter, OneMultiplexorIsSaidByMarks) {
  can::OwnedMessage layout = message("pages", 5);
  layout.signals = {signal("page", 0), signal("a", 8), signal("b", 8)};
  layout.signals[1].multiplexor = layout.signals[2].multiplexor = 0;
  layout.signals[1].present_at = {{3, 3}};
  layout.signals[2].present_at = {{4, 4}};
  const auto text = written({layout});
  EXPECT_THAT(text, HasSubstr(" SG_ page M : 0|8@1+ "));
  EXPECT_THAT(text, HasSubstr(" SG_ a m3 : 8|8@1+ "));
  EXPECT_THAT(text, HasSubstr(" SG_ b m4 : 8|8@1+ "));
  EXPECT_THAT(text, Not(HasSubstr("SG_MUL_VAL_")));
}

TEST(DbcWriter, RangesAndInnerMultiplexorsAreSaidAtTheEnd) {
  can::OwnedMessage layout = message("pages", 5);
  layout.signals = {signal("page", 0), signal("inner", 8), signal("deep", 16)};
  layout.signals[1].multiplexor = 0;
  layout.signals[1].present_at = {{3, 4}, {9, 9}};
  layout.signals[2].multiplexor = 1;
  layout.signals[2].present_at = {{1, 1}};
  const auto text = written({layout});
  EXPECT_THAT(text, HasSubstr(" SG_ inner m3M : "));
  EXPECT_THAT(text, HasSubstr("SG_MUL_VAL_ 5 inner page 3-4, 9-9;\n"));
  EXPECT_THAT(text, HasSubstr("SG_MUL_VAL_ 5 deep inner 1-1;\n"));
}

TEST(DbcWriter, FloatingPointSignalsHaveTheirType) {
  can::OwnedMessage layout = message("m", 1);
  layout.signals = {signal("single", 0), signal("plain", 32)};
  layout.signals[0].width = 32;
  layout.signals[0].is_float = layout.signals[0].is_signed = true;
  const auto text = written({layout});
  EXPECT_THAT(text, HasSubstr("SIG_VALTYPE_ 1 single : 1;\n"));
  EXPECT_THAT(text, Not(HasSubstr("SIG_VALTYPE_ 1 plain")));
}

TEST(DbcWriter, NamesAreLegalShortAndUnique) {
  can::OwnedMessage wide = message("3rd axle, pressure", 1, "front imu");
  can::OwnedSignal signal;
  signal.name = "a_name_that_is_much_longer_than_thirty_two_characters";
  wide.signals = {signal, signal};
  const auto text = written({wide, message("ari", 2, "imu-1"), message("ari", 3, "imu_1")});
  EXPECT_THAT(text, HasSubstr("BU_: front_imu imu_1 imu_1_2\n"));
  EXPECT_THAT(text, HasSubstr("BO_ 1 _3rd_axle__pressure: 8 front_imu\n"));
  EXPECT_THAT(text, HasSubstr(" SG_ a_name_that_is_much_longer_than_ : "));
  EXPECT_THAT(text, HasSubstr(" SG_ a_name_that_is_much_longer_tha_2 : "));
  EXPECT_THAT(text, HasSubstr("BO_ 2 ari_imu_1: 8 imu_1\n"));
  EXPECT_THAT(text, HasSubstr("BO_ 3 ari_imu_1_2: 8 imu_1_2\n"));
}

TEST(DbcWriter, OneIdentifierIsWrittenOnce) {
  const auto text = written({message("first", 7), message("second", 7)});
  EXPECT_THAT(text, HasSubstr("first"));
  EXPECT_THAT(text, Not(HasSubstr("second")));
}

TEST(DbcWriter, TextsCannotLeaveTheirQuotationMarks) {
  can::OwnedMessage layout = message("m", 1);
  layout.text = "say \"hello\"\n\\ 20 \xC2\xB0";
  EXPECT_THAT(written({layout}), HasSubstr("CM_ BO_ 1 \"say 'hello''' 20 ''\";\n"));
}

TEST(DbcWriter, EmptyBusIsAFile) {
  const auto text = written({});
  EXPECT_THAT(text, testing::StartsWith("VERSION \"\"\n"));
  EXPECT_THAT(text, HasSubstr("BA_ \"ProtocolType\" \"\";\n"));
}

}  // namespace
}  // namespace rigwire::protocols::dbc
