#include "protocols/openimu/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace rigwire::protocols::openimu {
namespace {

using testing::ElementsAre;

TEST(Settings, BytesOfEachMessage) {
  const auto bytes = [](Setting setting) { return make_setting(setting, 0x00); };
  EXPECT_THAT(bytes({SettingKind::packet_rate, 0x80, 2, 0, 0}).payload(), ElementsAre(0x80, 2));
  EXPECT_THAT(bytes({SettingKind::packet_mask, 0x80, 0, 0, 0x0107}).payload(),
              ElementsAre(0x80, 0x07, 0x01));
  EXPECT_THAT(bytes({SettingKind::filters, 0x80, 5, 10, 0}).payload(), ElementsAre(0x80, 5, 10));
  EXPECT_THAT(bytes({SettingKind::orientation, 0x80, 0, 0, 0x016C}).payload(),
              ElementsAre(0x80, 0x01, 0x6C));
  EXPECT_THAT(bytes({SettingKind::behaviour, 0x80, 0, 0, 0xC248}).payload(),
              ElementsAre(0x80, 0x48, 0xC2));
  EXPECT_THAT(bytes({SettingKind::save_configuration, 0x80, 0, 0, 0}).payload(),
              ElementsAre(0, 0x80, 0));
  EXPECT_EQ(bytes({SettingKind::packet_rate, 0x80, 2, 0, 0}).id, 0x18FF5500U);
}

TEST(Settings, EveryKindSurvivesTheRoundTrip) {
  const Setting all[] = {{SettingKind::reset_algorithm, 0x80, 0, 0, 0},
                         {SettingKind::save_configuration, 0x81, 0, 0, 0},
                         {SettingKind::packet_rate, 0x82, 50, 0, 0},
                         {SettingKind::packet_mask, 0x83, 0, 0, 0x1234},
                         {SettingKind::filters, 0x84, 2, 50, 0},
                         {SettingKind::orientation, 0x85, 0, 0, 0x016C},
                         {SettingKind::behaviour, 0x86, 0, 0, 0x4321}};
  for (const Setting& setting : all) {
    const can::Frame frame = make_setting(setting, 0x10);
    ASSERT_TRUE(decode_setting(frame).ok());
    EXPECT_EQ(*decode_setting(frame), setting);
    EXPECT_EQ(setting_kind(setting_pgn(setting.kind)), setting.kind);
  }
}

TEST(Settings, FiltersAreAnsweredInReverseOrderByThe300Ri) {
  const can::Frame answer = make_setting_answer_300({SettingKind::filters, 0, 5, 10, 0}, 0x80);
  EXPECT_THAT(answer.payload(), ElementsAre(0x80, 10, 5));
}

TEST(Settings, SaveWithTwoBytesAsMtltPySendsIt) {
  can::Frame frame = make_setting({SettingKind::save_configuration, 0x80, 0, 0, 0}, 0);
  frame.length = 2;
  EXPECT_EQ(decode_setting(frame)->address, 0x80);
}

TEST(Settings, ShortForeignAndAnsweredMessagesAreMalformed) {
  can::Frame rate = make_setting({SettingKind::packet_rate, 0x80, 2, 0, 0}, 0);
  rate.length = 1;
  EXPECT_TRUE(decode_setting(rate).malformed());
  rate.length = 0;
  EXPECT_TRUE(decode_setting(rate).malformed());
  rate.length = 99;
  EXPECT_TRUE(decode_setting(rate).malformed());
  EXPECT_TRUE(
      decode_setting(make_outcome(SettingKind::save_configuration, 0x80, 0x10, true)).malformed());
}

TEST(Settings, OutcomeNamesTheRequester) {
  EXPECT_THAT(make_outcome(SettingKind::save_configuration, 0x80, 0x10, true).payload(),
              ElementsAre(1, 0x10, 1));
  EXPECT_THAT(make_outcome(SettingKind::reset_algorithm, 0x80, 0x10, false).payload(),
              ElementsAre(1, 0x10, 0));
}

}  // namespace
}  // namespace rigwire::protocols::openimu
